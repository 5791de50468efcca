"""A whole campaign as one file: what its tests have, stacked, to be read a piece at a time, and each test to be given
back."""
