"""Student's distribution: how much wider an interval is whose scatter is known from few values."""

from __future__ import annotations

from math import atan, cos, exp, lgamma, pi, sqrt, tan

import numpy as np

from hfanalysis.quantity import NORMAL_95

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
"""Of Gauss's rule over -1 to 1. Evidence: test_student.py: ten digits from one degree of freedom to a thousand."""

MOST = 60
"""Steps at most; from below they come nearer with each. Evidence: one degree of freedom takes nine."""


def limit(freedom: float) -> float:
    """How many standard deviations hold 95 % [-], where the deviation has ``freedom`` degrees of freedom, 1 or more.

    With t = sqrt(f) tan(x) the probability of |T| < t is 2 c times the integral of cos(x)^(f-1) from 0, c = Gamma((f +
    1)/2) / (sqrt(pi) Gamma(f/2)) (Abramowitz and Stegun, 26.7); Newton's steps on x from that of the normal
    distribution.

    >>> round(limit(4.0), 4), round(limit(1.0), 4)
    (2.7764, 12.7062)
    """
    scale = 2.0 * exp(lgamma(0.5 * (freedom + 1.0)) - lgamma(0.5 * freedom)) / sqrt(pi)
    x = atan(NORMAL_95 / sqrt(freedom))
    for _ in range(MOST):
        within = scale * 0.5 * x * float(WEIGHTS @ np.cos(0.5 * x * (NODES + 1.0)) ** (freedom - 1.0))
        step = (0.95 - within) / (scale * cos(x) ** (freedom - 1.0))
        x += step
        if abs(step) < 1e-13 * x:
            break
    return sqrt(freedom) * tan(x)
