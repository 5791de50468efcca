"""Student's t distribution: how far a mean of few values may be off."""

from __future__ import annotations

from functools import cache
from math import atan, cos, exp, lgamma, pi, sqrt, tan

import numpy as np

from hfanalysis.quantity import NORMAL_95

NODES = 32
"""Of Gauss and Legendre, over a curve without corners. Evidence: SciPy's values to twelve digits (test_student.py)."""

LEAST_STEP = 1e-13
"""At which Newton's method ends, relative [-]: what is rounded off."""


@cache
def t_95(freedom: float) -> float:
    """The 97.5 % quantile of Student's t [-] with ``freedom`` >= 1 degrees of freedom [-]: half a 95 % interval.

    With t = sqrt(freedom) tan(angle), the density is a power of the cosine. Newton's method from the normal
    distribution's quantile comes from below throughout.

    >>> round(t_95(1.0), 4), round(t_95(10.0), 4)
    (12.7062, 2.2281)
    """
    at, weight = np.polynomial.legendre.leggauss(NODES)
    norm = exp(lgamma(0.5 * (freedom + 1.0)) - lgamma(0.5 * freedom)) / sqrt(pi)
    angle, step = atan(NORMAL_95 / sqrt(freedom)), 1.0
    while step > LEAST_STEP * angle:
        half = 0.5 * angle
        below = norm * half * float(weight @ np.cos(half * (at + 1.0)) ** (freedom - 1.0))
        step = (0.475 - below) / (norm * cos(angle) ** (freedom - 1.0))
        angle += max(step, 0.0)
    return sqrt(freedom) * tan(angle)
