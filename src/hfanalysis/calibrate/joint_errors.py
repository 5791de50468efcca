"""What constants may be off by that were fitted together with adopted effects.

The engine that they are for has one table of nitrous oxide, one law per equation, the characteristic velocity and the
nozzle of equilibrium, and the effects as they were adopted. None of these is known so well. With all of them free (the
effects' parameters by their priors, their courses, the table and the laws as a diagnosis takes them, the levels of c*
and thrust, and what is stated as a range) the constants may move elsewhere, and by more. Their error about what is told
is that of this fit, and the way to where it ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.courses import with_courses
from hfanalysis.inference.fitting.departures import with_departures
from hfanalysis.inference.fitting.fit import Fit, fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis, free_parameters
from hfanalysis.inference.half_known import with_ranges
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.record.definition import TestDefinition

LEVELS = {"combustion_efficiency": ("deficit", 0.05), "nozzle_divergence": ("loss", 0.02)}
"""Effects whose strength is the level of c* and of thrust, and its standard deviation [-]. Source: hybrids have 0.90 to
0.98 of the c* of equilibrium, and nozzles lose up to 0.04 (Sutton and Biblarz, Rocket Propulsion Elements, chapters 3
and 16). Evidence: in HF5 n follows the level of c* more than all else (docs/calibration.md)."""

FARTHEST = 3.0
"""Of those standard deviations, by which a level may be off."""

AWAY = 0.2
"""By how much n starts elsewhere [-]: a and n trade against each other, and with the level of c*. Source: the standard
deviation of n among fuels."""

STEPS, WITHIN = 10, 0.02
"""Steps of that fit at most, and the change of its objective [natural log] below which it is done."""


def errors_about(found: Candidate, observed: Observed, effects: Sequence[Active], definition: TestDefinition) -> Array:
    """Second moments (parameters, parameters) about the fitted constants, in standard deviations of their priors.

    ``effects``: those of the fit that are adopted; ``definition``: what is stated. Where the engine cannot be run with
    all of that free it is the covariance of the fit itself. Where several sets of constants explain the test, each
    counts by the density of its probability: their covariances hardly differ.
    """
    told, fits = found.fit, freed(found, observed, effects, definition)
    if not fits:
        return told.covariance
    size, best = told.x.size, min(one.objective for one in fits)
    weights = np.exp([best - one.objective for one in fits])
    moments = [one.covariance[:size, :size] + np.outer(one.x[:size] - told.x, one.x[:size] - told.x) for one in fits]
    return np.asarray(np.tensordot(weights / weights.sum(), np.array(moments), 1))


def freed(found: Candidate, observed: Observed, effects: Sequence[Active], definition: TestDefinition) -> list[Fit]:
    """Fits that go on with all of that free, from the fitted constants and from n AWAY to either side; those that can
    be run, and of such that end at the same objective one."""
    told = found.fit
    hypothesis, x = _with_parameters(*_with_levels(told.hypothesis, told.x), effects)
    hypothesis = with_ranges(hypothesis, definition)
    x = np.pad(x, (0, hypothesis.size - x.size))
    hypothesis = with_departures(hypothesis, observed, x)
    x = np.pad(x, (0, hypothesis.size - x.size))
    hypothesis, observed = with_courses(hypothesis, observed, x)
    x = np.pad(x, (0, hypothesis.size - x.size))
    tempered, place, fits = Bench(observed).at(found.form), hypothesis.names.index("n"), list[Fit]()
    n = hypothesis.free[place]
    for away in (0.0, -AWAY, AWAY):
        start = x.copy()
        start[place] = np.clip(n.place(n.value(float(x[place])) + away), n.least, n.most)
        with suppress(ValueError, ArithmeticError, np.linalg.LinAlgError):
            one = fit(hypothesis, tempered, start, STEPS, WITHIN)
            if all(abs(one.objective - other.objective) > WITHIN for other in fits):
                fits.append(one)
    return fits


def _with_levels(hypothesis: Hypothesis, x: Array) -> tuple[Hypothesis, Array]:
    """With the levels of c* and thrust free, unless an effect of that name acts."""
    acting = {active.effect.name for active in hypothesis.engine.effects}
    for name, (strength, std) in LEVELS.items():
        if name not in acting:
            level = Free(f"{name}.{strength}", 0.0, std, least=-FARTHEST, most=FARTHEST)
            hypothesis = hypothesis.with_active(effect(name).at(), (level,))
            x = np.append(x, 0.0)
    return hypothesis, x


def _with_parameters(hypothesis: Hypothesis, x: Array, effects: Sequence[Active]) -> tuple[Hypothesis, Array]:
    """With the parameters of ``effects`` free, where they are."""
    free, start = list(hypothesis.free), list(x)
    for active in effects:
        for one in free_parameters(active.effect):
            value = active.named[one.name.partition(".")[2]]
            place = one.least if one.shape == "positive" and value <= 0.0 else one.place(value)
            free.append(one)
            start.append(float(np.clip(place, one.least, one.most)))
    return replace(hypothesis, free=tuple(free)), np.array(start)
