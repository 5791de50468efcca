"""Where a function of one number is zero. (SciPy has this, too, and takes a fifth of a second to load.)"""

from __future__ import annotations

from collections.abc import Callable
from math import isnan

MOST_TURNS = 100
"""Evaluations after which a search is given up. Evidence: halving alone takes 53 to the last digit."""

SOON = 6
"""Steps by secants after which a root is looked for otherwise. Evidence: near one, three do (test_roots.py)."""

LAST_DIGITS = 4.0 * 2.0**-52
"""To what a root is found at best, relative to it [-]. Source: of a double's spacing, four."""


def root(function: Callable[[float], float], low: float, high: float, within: float) -> float:
    """Where ``function`` is zero between ``low`` and ``high``, to ``within`` (in their unit).

    Inverse quadratic interpolation, secants and halving (R. P. Brent, Algorithms for Minimization without Derivatives,
    1973, chapter 4). Raises ValueError where the function has the same sign at both ends, is no number, or the search
    does not end.

    >>> round(root(lambda x: x**3 - 2.0, 0.0, 2.0, 1e-12), 9)
    1.25992105
    """
    old, new, f_old, f_new = low, high, _number(function, low), _number(function, high)
    if f_old == 0.0 or f_new == 0.0:
        return old if f_old == 0.0 else new
    if (f_old < 0.0) == (f_new < 0.0):
        raise ValueError(f"no change of sign between {low:g} and {high:g}")
    other, f_other, before, step = old, f_old, 0.0, 0.0
    for _ in range(MOST_TURNS):
        if f_old != 0.0 and (f_old < 0.0) != (f_new < 0.0):
            other, f_other, before, step = old, f_old, new - old, new - old
        if abs(f_other) < abs(f_new):
            old, new, other = new, other, new
            f_old, f_new, f_other = f_new, f_other, f_new
        least, half = 0.5 * (within + LAST_DIGITS * abs(new)), 0.5 * (other - new)
        if f_new == 0.0 or abs(half) < least:
            return new
        last, previous = before, step
        before = step = half
        if abs(last) > least and abs(f_new) < abs(f_old):
            tried = _interpolated((old, f_old), (new, f_new), (other, f_other))
            if 2.0 * abs(tried) < min(abs(last), 3.0 * abs(half) - least):
                before, step = previous, tried
        old, f_old = new, f_new
        new += step if abs(step) > least else (least if half > 0.0 else -least)
        f_new = _number(function, new)
    raise ValueError(f"no root found between {low:g} and {high:g}")


def secant(function: Callable[[float], float], near: float, slope: float, within: float) -> float | None:
    """Where a function is zero whose slope ``near`` there is about known, to ``within``; None where that is not found
    soon: then :func:`root` finds it.

    Steps by ``slope`` at first, then by the last two values (the secant method).
    """
    old, f_old = near, _number(function, near)
    new = old - f_old / slope
    for _ in range(SOON):
        if abs(new - old) < within:
            return new
        f_new = _number(function, new)
        if f_new == f_old:
            return new if f_new == 0.0 else None
        old, f_old, new = new, f_new, new - f_new * (new - old) / (f_new - f_old)
    return None


def _interpolated(old: tuple[float, float], new: tuple[float, float], other: tuple[float, float]) -> float:
    """The step from the newest point to the root of the curve through the points."""
    (x, f), (x_old, f_old), (x_other, f_other) = new, old, other
    if x_old == x_other:
        return -f * (x - x_old) / (f - f_old)
    slope_old, slope_other = (f_old - f) / (x_old - x), (f_other - f) / (x_other - x)
    return -f * (f_other * slope_other - f_old * slope_old) / (slope_other * slope_old * (f_other - f_old))


def _number(function: Callable[[float], float], at: float) -> float:
    value = float(function(at))
    if isnan(value):
        raise ValueError(f"the function is no number at {at:g}")
    return value
