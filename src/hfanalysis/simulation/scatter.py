"""How far tests of one stand differ: what its own tests show, and what stands have at large."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np

from hfanalysis.products.prediction import Scatter

RATE = "regression rate"
"""What scatters beside C_i."""

PRIOR_SCATTER = {"C_i": 0.02, RATE: 0.024}
"""Relative standard deviation, from one test of a stand to the next, that stands have, as far as their own tests do not
tell it [-]. Evidence: `python -m benchmarks.prediction --set development --bare`, on simulated stands that predictions
are not scored on; no test or replica of this package was used for it."""

PRIOR_FREEDOM = 3
"""Degrees of freedom of that: how many tests it is worth [-]. Evidence: the same."""


def scatter_among(prior: float, values: Sequence[float]) -> Scatter:
    """Of the logarithms of a constant (``values``), relative [-]; ``prior``: what stands have at large, which counts as
    PRIOR_FREEDOM tests beside them.

    >>> round(scatter_among(0.02, [0.0, 0.01, -0.01]).std, 4)
    0.0167
    """
    k = len(values)
    freedom = PRIOR_FREEDOM + k - 1
    std = sqrt((PRIOR_FREEDOM * prior**2 + float(np.square(np.subtract(values, np.mean(values))).sum())) / freedom)
    own = f"the {k} tests and " if k > 1 else ""
    source = f"{own}{100.0 * prior:.1f} % of simulated stands, as if of {PRIOR_FREEDOM} tests"
    return Scatter(std=std, drawn=std * sqrt(1.0 + 1.0 / k), freedom=freedom, source=source)
