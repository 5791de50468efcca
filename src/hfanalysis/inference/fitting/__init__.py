"""The engine with constants and effects free, its readings with their slopes, and its fit to a test."""
