"""Upper limits: how large an effect can be that is not in the model, and still be overlooked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.score import FIRST_STEP
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.fit import Fit, usable
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed

Z95 = 1.645
"""One-sided 95 % of a normal distribution, in standard deviations. Source: its quantile."""


def limits(
    chosen: Candidate, added: Sequence[str], bench: Bench, catalogue: Catalogue
) -> dict[str, tuple[float | None, str]]:
    """For every effect but those that were ``added``: the size [SI] that it stays below with 95 % probability, linear.

    None where that is as large as it can be at all. With its SI unit; one-sided, by the curvature of the objective.
    """
    observed = bench.at(chosen.form)
    visible = {
        name: effect
        for name, effect in catalogue.effects.items()
        if name not in added and (not effect.of_sensor or set(effect.sites) & set(observed.names))
    }
    found = each(lambda name: _limit(chosen.fit, catalogue.add(chosen.fit.hypothesis, name), observed), list(visible))
    return {
        name: (limit if limit < largest else None, effect.strength.unit.replace("-", ""))
        for (name, effect), (limit, largest) in zip(visible.items(), found, strict=True)
        if np.isfinite(limit)
    }


def _limit(parent: Fit, made: Hypothesis, observed: Observed) -> tuple[float, float]:
    """The limit of the last effect of a hypothesis, NaN where it cannot be run, and the largest it can be [SI]."""
    start = inserted(parent, made)
    own = len(parent.hypothesis.free)
    least, most = made.bounds
    start[own] = FIRST_STEP
    try:
        there = predict(made, observed, np.clip(start, least, most), tangents=True, only=slice(own, len(made.free)))
    except (ValueError, ArithmeticError):
        return np.nan, np.nan
    if there.slopes is None or not usable(there):
        return np.nan, np.nan
    slopes = np.column_stack([parent.slopes[:, :own], there.slopes, parent.slopes[:, own:]])
    curvature = slopes.T @ slopes + np.eye(start.size)
    step = -np.linalg.solve(curvature, slopes.T @ there.residual + start)
    std = float(np.sqrt(np.linalg.inv(curvature)[own, own]))
    at = min(max(start[own] + step[own], least[own], 0.0) + Z95 * std, most[own])
    return made.free[own].value(float(at)), made.free[own].value(float(most[own]))


def inserted(parent: Fit, made: Hypothesis) -> Array:
    """The parent's parameters in a hypothesis with more effects (parameters,), in prior standard deviations: those come
    after its own and before its sources."""
    own = len(parent.hypothesis.free)
    new = np.zeros(len(made.free) - own)
    return np.concatenate([parent.x[:own], new, parent.x[own:]])
