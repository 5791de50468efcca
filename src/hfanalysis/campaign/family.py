"""Which test does not fit the rest, and which lies beyond the limits of all tests in order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp, hypot, log, sqrt
from statistics import median

from scipy.special import chdtrc, ndtr, stdtr

from hfanalysis.campaign.pooling import DISAGREE
from hfanalysis.products.calibration import FuelLaw
from hfanalysis.products.campaign import Odd
from hfanalysis.quantity import Quantity

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


def odd_one(found: Mapping[str, Quantity]) -> Odd | None:
    """The test whose number differs from that of the rest by more than chance allows, where there is just one.

    Each is compared with the mean of the others, with its own deviation and that of the mean; where the others
    disagree among themselves, by their scatter (Student). The probability counts that any of them could have been it.
    Of four that all differ by far more than they state one set in four has three that happen to agree, and names the
    fourth; of seven hardly any does.

    >>> level = {f"T{i}": Quantity(1.0 + 0.01 * i, "", 0.02) for i in range(5)}
    >>> odd_one(level) is None, odd_one({**level, "X": Quantity(1.2, "", 0.02)}).test
    (True, 'X')
    """
    usable = {test: (float(q.value), float(q.std)) for test, q in found.items() if q.value is not None and q.std}
    if len(usable) < FEWEST:
        return None
    apart = {test: _against(test, usable) for test in usable}
    first, second, *_ = sorted(apart, key=lambda test: apart[test].probability)
    if apart[first].probability >= CHANCE:
        return None
    rest = {test: both for test, both in usable.items() if test != first}
    if len(rest) >= FEWEST and _against(second, rest).probability < CHANCE:
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


def rates(laws: Mapping[str, FuelLaw]) -> tuple[float, dict[str, Quantity]]:
    """The regression rate [m/s] of each test at one flux [kg/(m^2 s)], the mean of those at which each is known best: a
    and n of one test trade against each other, and the rate there does not."""
    known = {
        test: law
        for test, law in laws.items()
        if law.regression.reference_flux is not None
        and law.regression.reference_flux.value
        and law.regression_rate_reference.value
        and law.regression_rate_reference.std
        and law.n.value is not None
    }
    if not known:
        return 0.0, {}
    references = {test: float(law.regression.reference_flux.value) for test, law in known.items()}  # type: ignore[union-attr,arg-type]
    flux = exp(sum(map(log, references.values())) / len(references))
    out = {}
    for test, law in known.items():
        rate, std = float(law.regression_rate_reference.value or 0.0), float(law.regression_rate_reference.std or 0.0)
        away = log(flux / references[test])
        there = rate * exp(float(law.n.value or 0.0) * away)
        out[test] = Quantity(there, "m/s", there * hypot(std / rate, away * (law.n.std or 0.0)))
    return flux, out


def left_the_family(in_order: Sequence[float]) -> list[int]:
    """Which of the numbers of tests, in the order of their dates, lie beyond the natural limits of all of them; none
    where they are too few to have such limits, or where most of them are equal: then a step of the converter is no
    limit.

    >>> left_the_family([1.0, 1.1, 0.9, 1.0, 1.1, 1.0, 0.9, 2.0])
    [7]
    """
    if len(in_order) < FAMILY:
        return []
    half = NATURAL * median(abs(b - a) for a, b in pairwise(in_order))
    middle = median(in_order)
    return [i for i, value in enumerate(in_order) if abs(value - middle) > half > 0.0]
