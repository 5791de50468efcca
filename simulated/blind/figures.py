"""Shares, medians and means with 95 % limits and their number of cases; differences between two methods on one set."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import nan, sqrt
from statistics import median
from typing import Any

import numpy as np

Z95 = 1.959963984540054


@dataclass(frozen=True)
class Figure:
    """A share or a median with 95 % limits; ``n`` cases, ``k`` of them successes where it is a share."""

    value: float
    low: float
    high: float
    n: int
    k: int | None = None

    def to_json(self) -> dict[str, Any]:
        """None where there is nothing to count."""
        return {k: (None if isinstance(v, float) and np.isnan(v) else v) for k, v in vars(self).items()}


NOTHING = Figure(nan, nan, nan, 0)


def share(outcomes: Iterable[bool]) -> Figure:
    """A share with Wilson limits.

    >>> f = share([True] * 9 + [False])
    >>> round(f.low, 3), f.value, round(f.high, 3)
    (0.596, 0.9, 0.982)
    """
    values = [bool(x) for x in outcomes]
    n, k, z = len(values), sum(values), Z95
    if n == 0:
        return Figure(nan, nan, nan, 0, 0)
    p = k / n
    middle, half = p + z * z / (2 * n), z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    low, high = ((middle + sign * half) / (1 + z * z / n) for sign in (-1, 1))
    return Figure(p, max(low, 0.0), min(high, 1.0), n, k)


def middle(values: Iterable[float | None]) -> Figure:
    """Median with limits from the order statistics (normal approximation to the binomial)."""
    x = sorted(v for v in values if v is not None and np.isfinite(v))
    n = len(x)
    if n == 0:
        return NOTHING
    half = 0.98 * sqrt(n)
    low, high = max(int(np.floor(n / 2 - half)), 0), min(int(np.ceil(n / 2 + half)), n - 1)
    return Figure(median(x), x[low], x[high], n)


def mean(values: Iterable[float]) -> Figure:
    """Mean with normal limits."""
    x = np.array(list(values), dtype=float)
    if len(x) == 0:
        return NOTHING
    half = 1.96 * x.std(ddof=1) / sqrt(len(x)) if len(x) > 1 else nan
    return Figure(float(x.mean()), float(x.mean() - half), float(x.mean() + half), len(x))


def quantile(values: Iterable[float | None], level: float) -> Figure:
    """A quantile with limits from the order statistics; the largest value (level 1) has none."""
    x = np.sort([v for v in values if v is not None and np.isfinite(v)])
    n = len(x)
    if n == 0:
        return NOTHING
    if level >= 1.0:
        return Figure(float(x[-1]), nan, nan, n)
    half = Z95 * sqrt(level * (1 - level) * n)
    low, high = max(int(np.floor(level * n - half)), 0), min(int(np.ceil(level * n + half)), n - 1)
    return Figure(float(np.quantile(x, level)), float(x[low]), float(x[high]), n)


def paired_share(one: Sequence[bool], other: Sequence[bool]) -> Figure:
    """Share of ``one`` less that of ``other``, case by case, with Agresti and Min's (2005) adjusted Wald limits.

    >>> f = paired_share([True] * 10, [True] * 6 + [False] * 4)
    >>> round(f.low, 2), f.value, round(f.high, 2)
    (0.02, 0.4, 0.65)
    """
    n = len(one)
    if n == 0:
        return NOTHING
    gained = sum(a and not b for a, b in zip(one, other, strict=True))
    lost = sum(b and not a for a, b in zip(one, other, strict=True))
    b, c, m = gained + 0.5, lost + 0.5, n + 2.0
    centre, half = (b - c) / m, Z95 * sqrt(max(b + c - (b - c) ** 2 / m, 0.0)) / m
    return Figure((gained - lost) / n, max(centre - half, -1.0), min(centre + half, 1.0), n)
