"""Where a function of one number is zero: for Python, and as a :func:`hfanalysis.compiled.law` for compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

MOST = 200
"""Evaluations at most: halving alone comes to the last digit in 60. Source: doubles have 53 bits."""

Function = Callable[[float, Any], float]
"""Of a number and of whatever else it is ``given``."""


def root_between(function: Function) -> Callable[[Any, float, float, float], float]:
    """Makes ``root(given, low, high, within)``: where ``function(x, given)`` is zero between ``low`` and ``high``, to
    ``within``, all in the unit of x; NaN where it has the same sign at both ends.

    Inverse quadratic interpolation where it is sure to help, else halving. Source: Chandrupatla, Advances in
    Engineering Software 28, 1997, 145-149; begun with a secant.

    >>> power = root_between(lambda x, to: x**to - 2.0)
    >>> round(power(2, 0.0, 2.0, 1e-12), 9), power(2, 2.0, 3.0, 1e-12)
    (1.414213562, nan)
    """

    def root(given: Any, low: float, high: float, within: float) -> float:
        a, b = low, high
        at_a, at_b = function(a, given), function(b, given)
        if not at_a * at_b <= 0.0:
            return np.nan
        c, at_c = a, at_a
        part = at_a / (at_a - at_b) if at_a != at_b else 0.0
        for _ in range(MOST):
            least = within / max(abs(b - a), 1e-300)
            if least > 0.5 or at_a == 0.0 or at_b == 0.0:
                break
            x = a + min(max(part, least), 1.0 - least) * (b - a)
            at_x = function(x, given)
            if (at_x > 0.0) == (at_a > 0.0):
                c, at_c = a, at_a
            else:
                c, at_c = b, at_b
                b, at_b = a, at_a
            a, at_a = x, at_x
            along, up = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
            part = 0.5
            if up * up < along and (1.0 - up) * (1.0 - up) < 1.0 - along:
                part = at_a / (at_b - at_a) * at_c / (at_b - at_c)
                part += (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
        return a if abs(at_a) < abs(at_b) else b

    return root


def root_near(root: Callable[[Any, float, float, float], float]) -> Callable[..., float]:
    """Makes ``found(given, low, high, within, guess, apart)`` of a :func:`root_between`: looked for first within
    ``apart`` of a ``guess`` (NaN: there is none), then in the whole range.

    >>> cubic = root_near(root_between(lambda x, cube: x**3 - cube))
    >>> [round(cubic(8.0, 0.0, 9.0, 1e-12, guess, 0.2), 9) for guess in (2.1, 7.0, float("nan"))]
    [2.0, 2.0, 2.0]
    """

    def found(given: Any, low: float, high: float, within: float, guess: float, apart: float) -> float:
        near = np.nan
        if guess == guess:
            near = root(given, max(guess - apart, low), min(guess + apart, high), within)
        return near if near == near else root(given, low, high, within)

    return found
