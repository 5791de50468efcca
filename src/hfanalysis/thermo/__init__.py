"""Thermophysical properties: saturated nitrous oxide from two sources, and the atmosphere."""
