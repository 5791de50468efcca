"""Histories with their uncertainty, carried through any chain of formulas to first order.

A history is a value per instant and its slopes with independent N(0, 1) numbers, so that the covariance of whatever is
made of it is slopes times their transpose. Where a formula acts at each instant by itself its derivatives are central
differences of the formula, all instants at once; integrals over the past are sums of slopes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array

DIFFERENCE_STEP = 1e-5
"""Relative to the largest value of a history: by how much it is moved to either side to find a derivative. Source:
about the cube root of a double's relative precision, at which a central difference errs least (Press et al., Numerical
Recipes, section 5.7)."""


@dataclass(frozen=True)
class LinearHistory:
    """``value`` (n,) [any unit] and its ``slopes`` (n, k) with k independent N(0, 1) numbers."""

    value: Array
    slopes: Array

    def __add__(self, other: LinearHistory) -> LinearHistory:
        return LinearHistory(self.value + other.value, self.slopes + other.slopes)

    def __sub__(self, other: LinearHistory) -> LinearHistory:
        return LinearHistory(self.value - other.value, self.slopes - other.slopes)

    def __mul__(self, other: LinearHistory) -> LinearHistory:
        slopes = self.slopes * other.value[:, None] + other.slopes * self.value[:, None]
        return LinearHistory(self.value * other.value, slopes)

    def times(self, factor: float) -> LinearHistory:
        """The same in another unit: ``factor`` of it."""
        return LinearHistory(factor * self.value, factor * self.slopes)

    def __getitem__(self, part: slice) -> LinearHistory:
        return LinearHistory(self.value[part], self.slopes[part])

    def spread(self, count: int) -> LinearHistory:
        """A single value, held over ``count`` instants: (count,) [its unit]."""
        return LinearHistory(np.repeat(self.value, count), np.repeat(self.slopes, count, axis=0))

    def weighted(self, weights: Array) -> LinearHistory:
        """Weighted sums (sums,) over the instants [the value's unit times that of the weights]; ``weights`` (sums,
        n)."""
        return LinearHistory(weights @ self.value, weights @ self.slopes)

    @property
    def covariance(self) -> Array:
        """Of the values, (n, n) [the value's unit squared]."""
        return np.asarray(self.slopes @ self.slopes.T)


def joined(parts: Sequence[LinearHistory]) -> LinearHistory:
    """One history after the other, all in one unit [any]."""
    return LinearHistory(np.concatenate([p.value for p in parts]), np.concatenate([p.slopes for p in parts]))


def integral(rate: LinearHistory, width: Array) -> LinearHistory:
    """Integral (n,) [unit of the rate times s] up to the middle of each cell of a history of cell means; ``width`` (n,)
    [s] of the cells.

    >>> integral(LinearHistory(np.array([2.0, 4.0]), np.zeros((2, 0))), np.array([0.5, 0.5])).value.tolist()
    [0.5, 2.0]
    """
    value, slopes = rate.value * width, rate.slopes * width[:, None]
    return LinearHistory(np.cumsum(value) - 0.5 * value, np.cumsum(slopes, axis=0) - 0.5 * slopes)


def total(rate: LinearHistory, width: Array) -> LinearHistory:
    """Integral over all cells, as a single value [unit of the rate times s]; ``width`` (n,) [s] of the cells.

    >>> total(LinearHistory(np.array([2.0, 4.0]), np.zeros((2, 0))), np.array([0.5, 0.5])).value.tolist()
    [3.0]
    """
    return rate.weighted(width[None, :])


def through_all(formula: Callable[..., tuple[Array, ...]], *inputs: LinearHistory) -> tuple[LinearHistory, ...]:
    """What a formula that acts at each instant by itself makes of histories (n,) [any units]; it gives several, all
    (n,).

    Slopes are by central differences, to first order.
    """
    values = [h.value for h in inputs]
    results = formula(*values)
    slopes = [np.zeros((results[0].size, inputs[0].slopes.shape[1])) for _ in results]
    for i, given in enumerate(inputs):
        if not given.slopes.any():
            continue
        step = DIFFERENCE_STEP * max(float(np.abs(given.value).max()), 1e-300)
        up, down = (formula(*values[:i], values[i] + s, *values[i + 1 :]) for s in (step, -step))
        for slope, high, low in zip(slopes, up, down, strict=True):
            slope += ((high - low) / (2.0 * step))[:, None] * given.slopes
    return tuple(LinearHistory(value, slope) for value, slope in zip(results, slopes, strict=True))


def through(formula: Callable[..., Array], *inputs: LinearHistory) -> LinearHistory:
    """What a formula that acts at each instant by itself makes of histories (n,), of any units; slopes to first order.

    >>> two, three = LinearHistory(np.array([2.0]), np.eye(1)), LinearHistory(np.array([3.0]), np.zeros((1, 1)))
    >>> out = through(lambda p, t: p * t, two, three)
    >>> float(out.value[0]), round(float(out.slopes[0, 0]), 6)
    (6.0, 3.0)
    """
    return through_all(lambda *values: (formula(*values),), *inputs)[0]
