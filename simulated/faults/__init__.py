"""Logs of healthy stands of all sorts, and the same with one fault: what the channels' health is measured by.

``healthy.draw`` makes a log whose truth is known, as a logger of some make would write it; ``kinds.FAULTS`` puts one
kind of fault into it, over its range of sizes; benchmarks/health_rates.py counts what is found.
"""
