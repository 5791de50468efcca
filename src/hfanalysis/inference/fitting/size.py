"""How large an effect is, nobody knows beforehand: its typical size, four times that, or a tenth or a hundredth.

A fit takes the strength of an effect for one of typical size, give or take. Where an effect turns out to be far
smaller, that would cost it odds that it does not deserve, and the more so the finer the sensors see it; an unknown
source, whose size is chosen, would win. So strengths have a mixture of priors, from four times the typical size down;
where an effect has several strengths (one per transducer) most of its prior is that all but one of them are nothing. A
fit's slopes tell what that changes in its evidence: the strengths' likelihood is Gaussian, with everything else
integrated over.

So it is with the laws of the base model: how far an engine's are from these, a test itself shows. Where nothing else
departs, one law hardly departs by as much as laws may.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations, product

import numpy as np

from hfanalysis.arrays import Array

SIZES = (2.0, 1.0, 0.3, 0.1, 0.03, 0.01)
"""Deviations of a strength (as x), each as probable as the others: 1 is about the typical size, 2 some four times as
much, for a strength is the hyperbolic sine of its x. Evidence: while strengths above the typical size paid more than
smaller ones, a wall led heat and nitrogen by 2 to 4 in log evidence in four calibration cases (docs/blind.md,
C060108)."""

OF_LAWS = (1.0, 0.3, 0.1)
"""Deviations of all laws of an engine together (as x), each as probable as the others: as large as stated with each, a
third or a tenth of it. Source: as with the sizes of effects; a tenth of what laws may depart by is less than sensors
show of one."""

HOW_MANY = (0.75, 0.15, 0.10)
"""Probability that one, two or three of an effect's strengths are not nothing."""


def of_any_size(precision: Array, x: Array, groups: Sequence[int], laws: int = 0) -> float:
    """What log evidence changes [natural log] by where the strengths of effects, and the departures of laws, have the
    mixture for a prior, and not N(0, 1).

    Args:
        precision: of both (strengths and departures twice), the priors N(0, 1) counted, all other parameters integrated
            over.
        x: the most probable ones (strengths and departures,) in prior standard deviations.
        groups: how many strengths each effect has, in their order.
        laws: how many departures follow.

    What the data do not show costs nothing, whatever its prior:

    >>> abs(round(of_any_size(np.eye(2), np.zeros(2), [1], laws=1), 9))
    0.0
    """
    if not groups and not laws:
        return 0.0
    spread, odds = _mixture(tuple(groups), laws)
    likelihood = precision - np.eye(x.size)
    pull = precision @ x
    here = _log_evidence(likelihood, pull, spread)
    as_it_is = _log_evidence(likelihood, pull, np.ones((1, x.size)))[0]
    return float(np.logaddexp.reduce(here + odds) - as_it_is)


def _log_evidence(likelihood: Array, pull: Array, variance: Array) -> Array:
    """Of a Gaussian likelihood exp(pull x - x likelihood x / 2) under priors N(0, variance), each row a prior."""
    inner = np.eye(pull.size) + variance[:, :, None] * likelihood
    mean = np.linalg.solve(inner, (variance * pull)[:, :, None])[:, :, 0]
    return np.asarray(0.5 * mean @ pull - 0.5 * np.linalg.slogdet(inner)[1])


@lru_cache(maxsize=64)
def _mixture(groups: tuple[int, ...], laws: int) -> tuple[Array, Array]:
    """Variances (priors, strengths and departures of laws) and the log of the odds of each prior."""
    choices = [_of_one(count) for count in groups]
    if laws:
        choices.append([(np.full(laws, size), -float(np.log(len(OF_LAWS)))) for size in OF_LAWS])
    spreads, odds = [], []
    for chosen in product(*choices):
        spreads.append(np.concatenate([sizes for sizes, _ in chosen]) ** 2)
        odds.append(sum(log for _, log in chosen))
    return np.array(spreads), np.array(odds)


def _of_one(count: int) -> list[tuple[Array, float]]:
    """Sizes of an effect's strengths, and the log of their odds."""
    out = []
    numbers = np.array(HOW_MANY[:count]) / sum(HOW_MANY[:count])
    for number, probability in enumerate(numbers, 1):
        among = list(combinations(range(count), number))
        for which in among:
            for size in SIZES:
                sizes = np.zeros(count)
                sizes[list(which)] = size
                out.append((sizes, float(np.log(probability / (len(among) * len(SIZES))))))
    return out
