"""Tests on other engines, by other loggers, and by laws that the diagnosis does not assume (docs/worlds.md).

Several laws for every equation, of which each test has one at random, and small: a test that hides nothing hides
nothing that would have a name. What may be hidden is that of :mod:`simulated.blind`, by its closures or by others.
"""
