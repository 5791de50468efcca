"""Other valleys of one candidate: other constants with which its names explain the data as well.

The regression law's a and n trade against one another, and against what effects do to the chamber: the probability of
the constants may have two tops. Which of them a search comes to is decided by last digits, so both are looked for; what
is told is one of them, with intervals that reach over the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.base_model import in_one_valley
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate, held, price
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed

ELSEWHERE = (-1.0, 1.0)
"""How far from a candidate's n it is looked for besides, in standard deviations of its prior. Evidence: an effect of
the nozzle was none while a and n were bent to it."""

AS_PROBABLE = 1.0
"""Log evidence [natural log] behind the deepest valley within which another may be the one that is told. Source: odds
of less than three are barely worth a mention (Kass and Raftery 1995)."""

FAR_APART = 2.0
"""Standard deviations, by one valley's own, from which on another valley's constant is told beside it."""

LEAST_WEIGHT = 0.05
"""Probability of another valley from which on its constants are told."""


def among_valleys(found: Candidate, bench: Bench) -> Candidate:
    """A candidate in the valley that is told of those that it has, with the covariance of all.

    Of valleys that are as probable it is the one that asks for the larger model-form error, and of those of one form
    the one nearest to what is known: last digits do not decide.
    """
    valleys = _valleys(found, bench)
    evidence = np.array([_without_slack(c) for c in valleys])
    deepest = float(evidence.max())
    near = [c for c, e in zip(valleys, evidence, strict=True) if e > deepest - AS_PROBABLE]
    told = max(near, key=lambda c: (c.form.total, -float(c.fit.x @ c.fit.x)))
    weights = np.exp(evidence - deepest)
    weights /= weights.sum()
    fit = replace(told.fit, covariance=_covariance(told.fit.x, [c.fit for c in valleys], weights))
    gained = _without_slack(told) - _without_slack(found)
    others = tuple((c.fit, float(w)) for c, w in zip(valleys, weights, strict=True) if c is not told)
    return replace(found, fit=fit, form=told.form, log_evidence=found.log_evidence + gained, others=others)


def told_otherwise(found: Candidate) -> tuple[float, dict[str, tuple[float, float]]]:
    """The probability [-] of the likeliest other valley of a candidate, and the parameters that are elsewhere there.

    By name their values here and there [SI]; none where no other valley is likely.
    """
    other, weight = max(found.others, key=lambda one: one[1], default=(found.fit, 0.0))
    if weight < LEAST_WEIGHT:
        return weight, {}
    here, there, stds = found.fit.values, other.values, other.stds
    far = [n for n in here if abs(there[n] - here[n]) > FAR_APART * stds[n]]
    return weight, {n: (here[n], there[n]) for n in far}


def with_exponent(found: Candidate, away: float, observed: Observed) -> Fit | None:
    """A candidate with n held ``away`` from its own, in standard deviations of the prior, as a fit in which it is free.

    None where it cannot be there.
    """
    hypothesis = found.fit.hypothesis
    place = [f.name for f in hypothesis.free].index("n")
    start = found.fit.x.copy()
    start[place] += away
    free = hypothesis.free[place]
    if not free.least < start[place] < free.most:
        return None
    fitted = attempted(held(hypothesis, slice(place, place + 1), start), observed, start, SHORT)
    return None if fitted is None else replace(fitted, hypothesis=hypothesis)


def _valleys(found: Candidate, bench: Bench) -> list[Candidate]:
    """The candidate, and what it comes to from either side, each valley once, at the form that suits it."""

    def other(away: float) -> Candidate | None:
        observed = bench.at(found.form)
        held_there = with_exponent(found, away, observed)
        free = None if held_there is None else attempted(found.fit.hypothesis, observed, held_there.x, SHORT)
        if free is None:
            return None
        return bench.told(bench.judged(bench.converged(candidate(found.names, free, found.form, found.source))))

    valleys = [found]
    for one in each(other, ELSEWHERE):
        if one is not None and not any(in_one_valley(one.fit.x, c.fit.x) for c in valleys):
            valleys.append(one)
    return valleys


def _without_slack(found: Candidate) -> float:
    """Log evidence of a candidate with the price of its form, and no more: valleys of one candidate are compared."""
    return found.fit.log_evidence - price(found.form)


def _covariance(x: Array, fits: Sequence[Fit], weights: Array) -> Array:
    """Mean square distance from ``x`` (parameters,) over valleys of these ``weights`` (valleys,)."""
    parts = [w * (f.covariance + np.outer(f.x - x, f.x - x)) for f, w in zip(fits, weights, strict=True)]
    return np.asarray(sum(parts[1:], parts[0]))
