"""Upper limits: how large an effect can be that is not in the model, and still be overlooked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.candidate import Bench, Candidate
from hfanalysis.diagnose.catalogue import Catalogue
from hfanalysis.diagnose.fit import Fit, usable
from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.predict import predict
from hfanalysis.diagnose.score import FIRST_STEP

Array = NDArray[np.float64]

Z95 = 1.645
"""One-sided 95 % of a normal distribution, in standard deviations."""


def limits(chosen: Candidate, bench: Bench, catalogue: Catalogue) -> dict[str, tuple[float, str]]:
    """For every effect that is not in the model: the size [SI] that it stays below with 95 % probability, linear."""
    out = {}
    observed = bench.at(chosen.steps)
    for name, effect in catalogue.effects.items():
        if name in chosen.names or (effect.distort is not None and not set(effect.sites) & set(observed.names)):
            continue
        made = catalogue.add(chosen.fit.hypothesis, name)
        start = inserted(chosen.fit, made)
        own = len(chosen.fit.hypothesis.free)
        new = slice(own, len(made.free))
        least, most = made.bounds
        start[own] = FIRST_STEP
        try:
            there = predict(made, observed, np.clip(start, least, most), tangents=True, only=new)
        except (ValueError, ArithmeticError):
            continue
        if there.slopes is None or not usable(there):
            continue
        slopes = np.column_stack([chosen.fit.slopes[:, :own], there.slopes, chosen.fit.slopes[:, own:]])
        curvature = slopes.T @ slopes + np.eye(start.size)
        step = -np.linalg.solve(curvature, slopes.T @ there.residual + start)
        std = float(np.sqrt(np.linalg.inv(curvature)[own, own]))
        at = min(max(start[own] + step[own], least[own], 0.0) + Z95 * std, most[own])
        out[name] = (made.free[own].value(float(at)), effect.strength.unit.replace("-", ""))
    return out


def inserted(parent: Fit, made: Hypothesis) -> Array:
    """The parent's parameters in a hypothesis with more effects: those come after its own and before its sources."""
    own = len(parent.hypothesis.free)
    new = np.zeros(len(made.free) - own)
    return np.concatenate([parent.x[:own], new, parent.x[own:]])
