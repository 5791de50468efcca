"""Oscillations of a channel: what is left beside its smooth course, its spectra, and the lines in them."""
