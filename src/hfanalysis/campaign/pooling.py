"""One number from those of several tests, which may differ by more than their stated deviations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, sqrt

from scipy.special import chdtrc, stdtrit

from hfanalysis.quantity import NORMAL_95, Quantity

DISAGREE = 0.01
"""Probability of so large a scatter by chance below which tests are said to disagree. Evidence: test_pooling.py: tests
of one value rarely disagree, tests that differ by far more than they state do."""


@dataclass(frozen=True)
class Pooled:
    """What tests say together.

    ``mean`` has the deviation of the mean; ``between`` is the standard deviation of the tests about it beyond what each
    states, ``probability`` that of a scatter at least as large by chance alone.
    """

    mean: Quantity
    between: float
    probability: float
    tests: tuple[str, ...]

    @property
    def agree(self) -> bool:
        """Whether the scatter is one that the stated deviations explain."""
        return self.probability >= DISAGREE


def pooled(found: Mapping[str, Quantity], shared: float = 0.0) -> Pooled | None:
    """The mean of the tests' quantities [their SI unit] with random effects; None for fewer than two with a deviation.

    Weights are 1/(std^2 + between^2), ``between`` by the moments of Cochran's Q (DerSimonian & Laird, Controlled
    Clinical Trials 7, 1986, 177-188). The interval is the wider one of the normal and of Student's with the scatter
    that there is (Hartung & Knapp, Statistics in Medicine 20, 2001, 3875-3889), for the first is too narrow for few
    tests. ``shared`` [as the quantities]: the part of their deviations that is the same in all of them, as that of a
    hole's area: no number of tests makes it less.

    >>> both = pooled({"A": Quantity(1.0, "s", 0.1), "B": Quantity(1.2, "s", 0.1)})
    >>> both is not None and (round(both.mean.value, 3), both.agree)
    (1.1, True)
    >>> four = pooled({test: Quantity(1.0, "s", 0.1) for test in "ABCD"}, 0.08)
    >>> four is not None and round(four.mean.std, 3)
    0.085
    """
    usable = {test: q for test, q in found.items() if q.value is not None and q.std}
    if len(usable) < 2:
        return None
    values = [float(q.value or 0.0) for q in usable.values()]
    variances = [float(q.std or 0.0) ** 2 for q in usable.values()]
    shared = min(shared, sqrt(min(variances)))
    freedom = len(values) - 1
    weights = [1.0 / v for v in variances]
    total = sum(weights)
    excess = _scatter(values, weights)
    spread = total - sum(w * w for w in weights) / total
    between = max(0.0, (excess - freedom) / spread)
    weights = [1.0 / (v + between) for v in variances]
    total = sum(weights)
    mean = sum(w * x for w, x in zip(weights, values, strict=True)) / total
    std = sqrt(max(sum(w * w * (1.0 / w - shared**2) for w in weights), 0.0)) / total
    seen = sqrt(_scatter(values, weights) / (freedom * total))
    half = hypot(max(NORMAL_95 * std, float(stdtrit(freedom, 0.975)) * seen), NORMAL_95 * shared)
    unit = next(iter(usable.values())).unit
    together = Quantity(mean, unit, hypot(max(std, seen), shared), (mean - half, mean + half))
    return Pooled(together, sqrt(between), float(chdtrc(freedom, excess)), tuple(usable))


def _scatter(values: list[float], weights: list[float]) -> float:
    """Weighted sum of squares about the weighted mean."""
    mean = sum(w * x for w, x in zip(weights, values, strict=True)) / sum(weights)
    return sum(w * (x - mean) ** 2 for w, x in zip(weights, values, strict=True))
