"""Blind cases: test directories in which an effect is hidden, written by a generator that knows nothing of the model.

Nothing here imports the package under test. What the generator takes as its own: tank states by mass and internal
energy (a flash at constant volume), nitrous oxide from CoolProp by monotone cubics, a combustion table of its own, a
fixed-step integrator with an exponential step for the chamber, and sensors. See docs/blind.md.
"""
