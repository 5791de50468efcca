"""Which test does not fit the rest, and which lies beyond the limits of all tests in order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp, hypot, log, sqrt
from statistics import median

from scipy.special import chdtrc, ndtr, stdtr

from hfanalysis.campaign.pooling import DISAGREE
from hfanalysis.products.campaign import Odd
from hfanalysis.quantity import Quantity
from hfanalysis.simulation.scatter import scatter_among

FEWEST = 4
"""Tests from which on one can be odd. Source: of two it is open which one it is, and of three the other two are no
family."""

CHANCE = 0.04
"""Probability, over all tests together, of so far by chance, below which one is named. Source: a campaign may name one
in one of twenty sets that have none; a little less, for deviations are estimates."""

FAMILY, NATURAL = 8, 4.2
"""Tests in order from which on a family has limits, and how far these are from the middle, in median moving ranges. A
chart of individuals by the median (NIST/SEMATECH e-Handbook of Statistical Methods, 6.3.2.2), for a single leap is in
two ranges of so few; with its usual 3.1 one family of eight in eight has a test outside by chance, with 4.2 one in
twenty, and no more of larger ones (tests/campaign/test_family.py)."""


def odd_one(found: Mapping[str, Quantity], usual: float | None = None) -> Odd | None:
    """The test whose number differs from that of the rest by more than chance allows, where there is just one.

    Each is compared with the mean of the others. Where it is known how far tests of a stand differ at large (``usual``,
    relative [-]), by that and what the others show of it: most of what is not known of a number, as of a hole's area,
    is the same in all tests of a stand, and no reason for one to differ. Else with its own deviation and that of the
    mean; where the others disagree among themselves, by their scatter (Student). The probability counts that any of
    them could have been it. Of four that all differ by far more than they state one set in four has three that happen
    to agree, and names the fourth; of seven hardly any does.

    >>> level = {f"T{i}": Quantity(1.0 + 0.01 * i, "", 0.02) for i in range(5)}
    >>> odd_one(level) is None, odd_one({**level, "X": Quantity(1.2, "", 0.02)}).test
    (True, 'X')
    """
    usable = {test: (float(q.value), float(q.std)) for test, q in found.items() if q.value is not None and q.std}
    if len(usable) < FEWEST:
        return None

    def against(test: str, others: Mapping[str, tuple[float, float]]) -> _Apart:
        by_scatter = usual is not None and all(value > 0.0 for value, _ in others.values())
        return _by_scatter(test, others, usual or 0.0) if by_scatter else _against(test, others)

    apart = {test: against(test, usable) for test in usable}
    first, second, *_ = sorted(apart, key=lambda test: apart[test].probability)
    if apart[first].probability >= CHANCE:
        return None
    rest = {test: both for test, both in usable.items() if test != first}
    if len(rest) >= FEWEST and against(second, rest).probability < CHANCE:
        return None  # more than one: then it is no odd one but tests that differ
    unit = next(iter(found.values())).unit
    one = apart[first]
    return Odd(
        test=first, apart=Quantity(one.by, unit, one.std), of=Quantity(one.mean, unit), probability=one.probability
    )


@dataclass(frozen=True)
class _Apart:
    """A test against the mean of the others [their unit], and the probability [-] that one is so far by chance."""

    by: float
    std: float
    mean: float
    probability: float


def _against(test: str, found: Mapping[str, tuple[float, float]]) -> _Apart:
    value, own = found[test]
    others = [both for name, both in found.items() if name != test]
    total = sum(1.0 / s**2 for _, s in others)
    mean = sum(v / s**2 for v, s in others) / total
    scatter, freedom = sum(((v - mean) / s) ** 2 for v, s in others), len(others) - 1
    std = hypot(own, 1.0 / sqrt(total))
    if chdtrc(freedom, scatter) < DISAGREE:
        std *= sqrt(scatter / freedom)
        beyond = 2.0 * float(stdtr(freedom, -abs(value - mean) / std))
    else:
        beyond = 2.0 * float(ndtr(-abs(value - mean) / std))
    return _Apart(value - mean, std, mean, min(1.0, len(found) * beyond))


def _by_scatter(test: str, found: Mapping[str, tuple[float, float]], usual: float) -> _Apart:
    """By how far the others differ, and tests of a stand at large. A test that is known worse than most has to be off
    by more than that."""
    logs = {name: log(value) for name, (value, _) in found.items()}
    relative = {name: std / value for name, (value, std) in found.items()}
    shown = scatter_among(usual, [x for name, x in logs.items() if name != test])
    rest = (sum(logs.values()) - logs[test]) / (len(found) - 1)
    by, mean = logs[test] - rest, exp(rest)
    beyond = len(found) * 2.0 * float(stdtr(shown.freedom, -abs(by) / shown.drawn))
    worse = sqrt(max(relative[test] ** 2 - median(relative.values()) ** 2, 0.0))
    return _Apart(found[test][0] - mean, shown.drawn * mean, mean, min(1.0, beyond) if abs(by) > worse else 1.0)


def natural_limits(in_order: Sequence[float]) -> tuple[float, float] | None:
    """Between which the numbers of tests, in the order of their dates, lie naturally; None where they are too few to
    have such limits, or where most of them are equal: then a step of the converter is no limit.

    >>> low, high = natural_limits([1.0, 1.1, 0.9, 1.0, 1.1, 1.0, 0.9, 2.0])
    >>> round(low, 2), round(high, 2)
    (0.58, 1.42)
    """
    if len(in_order) < FAMILY:
        return None
    half, middle = NATURAL * median(abs(b - a) for a, b in pairwise(in_order)), median(in_order)
    return (middle - half, middle + half) if half > 0.0 else None


def left_the_family(in_order: Sequence[float]) -> list[int]:
    """Which of the numbers of tests, in the order of their dates, lie beyond the natural limits of all of them.

    >>> left_the_family([1.0, 1.1, 0.9, 1.0, 1.1, 1.0, 0.9, 2.0])
    [7]
    """
    limits = natural_limits(in_order)
    return [i for i, value in enumerate(in_order) if limits and not limits[0] <= value <= limits[1]]
