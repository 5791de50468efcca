"""Mutated logs and test.toml files of all formats: nothing ends in a traceback, hangs, or is wrong without a word."""
