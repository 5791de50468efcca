"""Phases of a test from the physics of its signals: one file per event."""
