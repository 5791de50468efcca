"""What a fit says of data that it was not fitted to, as a log probability.

Interleaved stretches are left out in turn. The noise of a channel is correlated, so what counts is the density of the
stretches that were left out, given the others: that of all less that of the rest, each over all constants that the rest
leaves possible, as its slopes tell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted
from hfanalysis.inference.fitting.fit import Fit, usable
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.gap import FOLDS, stretches
from hfanalysis.inference.observations.observed import Observed

LEAST_LEFT = 0.25
"""Part of what is known of a strength that has to be left without a stretch: an effect that acts in that stretch alone
cannot be foretold from the others, and that says nothing against it."""


@dataclass(frozen=True)
class Foretold:
    """Log of the probability density of what was held out given the rest [natural log of SI]: by what the ``rest``
    leaves possible, and by the fit to ``all`` of it."""

    rest: float
    all: float


def log_predictive(found: Candidate, bench: Bench) -> Foretold | None:
    """What a candidate says of interleaved stretches, given the others.

    None where a fit to the rest cannot be run, or leaves a strength open that all the data tell.
    """
    observed = bench.at(found.form)
    parts = each(lambda fold: _of_fold(found, observed, fold), list(range(FOLDS)))
    kept = [part for part in parts if part is not None]
    if len(kept) < len(parts):
        return None
    return Foretold(sum(part.rest for part in kept), sum(part.all for part in kept))


def _of_fold(found: Candidate, observed: Observed, fold: int) -> Foretold | None:
    rest = observed.without(stretches(observed, observed, fold))
    made, x = found.fit.hypothesis, found.fit.x
    again = attempted(made, rest, x, SHORT)
    if again is None or not _foretold(found.fit, again):
        return None
    try:
        there = predict(made, observed, again.x, tangents=True)
        as_all = predict(made, rest, x, tangents=False)
    except (ValueError, ArithmeticError):
        return None
    if there.slopes is None or not usable(there):
        return None
    return Foretold(
        over_constants(there.residual, there.slopes, again.x, observed)
        - over_constants(again.residual, again.slopes, again.x, rest),
        _log_density(found.fit.residual, observed) - _log_density(as_all.residual, rest),
    )


def over_constants(residual: Array, slopes: Array, x: Array, observed: Observed) -> float:
    """Log of the probability density of data [natural log of SI], over all constants that they leave possible: a
    ``residual`` (observations,) and its ``slopes`` (observations, parameters) at ``x`` (parameters,).

    What the rest leaves open of a constant, of which a stretch that is held out tells most, is no failure to foretell
    that stretch.
    """
    curvature = slopes.T @ slopes + np.eye(x.size)
    step = -np.linalg.solve(curvature, slopes.T @ residual + x)
    left = _log_density(residual + slopes @ step, observed) - 0.5 * float((x + step) @ (x + step))
    return left - 0.5 * float(np.linalg.slogdet(curvature)[1])


def _log_density(residual: Array, observed: Observed) -> float:
    return -0.5 * float(residual @ residual) - observed.log_size


def _foretold(all_of_it: Fit, rest: Fit) -> bool:
    """Whether the rest tells the strengths of effects nearly as well as all of it does."""
    strengths = [i for group in all_of_it.hypothesis.strengths for i in group.tolist()]
    before, after = (np.diag(f.covariance)[strengths] for f in (all_of_it, rest))
    return bool((before >= LEAST_LEFT * after).all())
