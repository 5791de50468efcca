"""Naming: which effects of the library, alone or together, explain what the base model leaves open.

Every effect is fitted with all calibrated constants free, from the start at which a score test with the constants
projected out sees most of it. A parent is fitted again from every child, for an unconverged base poses as evidence.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fit import Fit, fit
from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.observed import Observed
from hfanalysis.diagnose.predict import predict
from hfanalysis.engine.effect import Effect
from hfanalysis.stages.base import Progress, silent

Array = NDArray[np.float64]

COARSE = 1e-2
"""Model-form error at which a fit begins, so that it does not stick in what is small."""

STARTS = (-1.2, 0.0, 1.2)
"""Standard deviations from its prior's center at which a parameter of an effect's shape may start."""

FIRST_STEP = 0.05
"""Strength, in units of the typical one (as x), at which slopes of an effect are taken."""

FAR = 3.0
"""Units of log evidence that a parent gains from a child's constants before all are fitted again."""


@dataclass(frozen=True)
class Candidate:
    """A set of effects, its fit and log evidence."""

    names: tuple[str, ...]
    fit: Fit

    @property
    def log_evidence(self) -> float:
        """Of the data under this set of effects."""
        return self.fit.log_evidence

    @property
    def chi2(self) -> float:
        """What is left, in squared standard deviations."""
        return float(self.fit.residual @ self.fit.residual)


def fitted(hypothesis: Hypothesis, observed: Observed, starts: Iterable[Array]) -> Fit | None:
    """The best fit from several starts, first coarse, then fine; None where none can be run."""
    coarse, best = observed.at_form(max(COARSE, observed.form)), None
    for start in starts:
        try:
            rough = fit(hypothesis, coarse, start)
            found = fit(hypothesis, observed, rough.x)
        except (ValueError, ArithmeticError):
            continue
        if best is None or found.log_evidence > best.log_evidence:
            best = found
    return best


@dataclass(frozen=True)
class Score:
    """What a score test says of an effect: gain in log probability, and the start at which it is largest."""

    gain: float
    start: Array


def score(parent: Fit, effect: Effect, observed: Observed, stated: Mapping[str, float]) -> tuple[Hypothesis, list[Score]]:
    """The parent with an effect more, and its score tests from several shapes, the best first.

    The slopes of the strengths have the parent's parameters projected out.
    """
    made = parent.hypothesis.with_effect(effect, **stated)
    least, most = made.bounds
    size = parent.x.size
    shapes = [
        i
        for i in range(size + effect.strengths, made.size)
        if made.free[i - 0].shape == "positive"
    ]
    found = []
    for choice in product(STARTS, repeat=len(shapes)):
        start = np.concatenate([parent.x, np.zeros(made.size - size)])
        start[shapes] = choice
        strengths = np.arange(size, size + effect.strengths)
        start[strengths] = np.clip(FIRST_STEP, least[strengths], most[strengths])
        start = np.clip(start, least, most)
        try:
            there = predict(made, observed, start, tangents=True)
        except (ValueError, ArithmeticError):
            continue
        if there.slopes is None or not np.isfinite(there.slopes).all() or not np.isfinite(there.residual).all():
            continue
        found.append(_score(there.slopes, there.residual, start, size, effect.strengths, least, most))
    return made, sorted(found, key=lambda s: -s.gain)


def _score(slopes: Array, residual: Array, start: Array, size: int, strengths: int, least: Array, most: Array) -> Score:
    """One linear step in the parent's parameters and the strengths."""
    columns = slopes[:, : size + strengths]
    x = start[: size + strengths]
    curvature = columns.T @ columns + np.eye(x.size)
    step = -np.linalg.solve(curvature, columns.T @ residual + x)
    own = slice(size, size + strengths)
    wanted = np.clip(x[own] + step[own], least[own], most[own])
    # the strengths held where their bounds leave them, the rest follows
    a, b = columns[:, :size], columns[:, own]
    moved = residual + b @ (wanted - x[own])
    inner = np.linalg.solve(curvature[:size, :size], a.T @ moved + x[:size])
    left = moved - a @ inner
    after = 0.5 * float(left @ left + np.sum((x[:size] - inner) ** 2) + wanted @ wanted)
    still = residual - b @ x[own]
    rest = np.linalg.solve(curvature[:size, :size], a.T @ still + x[:size])
    none = still - a @ rest
    before = 0.5 * float(none @ none + np.sum((x[:size] - rest) ** 2))
    out = start.copy()
    out[own] = np.clip(wanted, -MOST_FIRST, MOST_FIRST)
    return Score(before - after, out)


MOST_FIRST = 1.5
"""The largest strength (as x) at which a fit starts."""


def added(parent: Fit, effect: Effect, observed: Observed, stated: Mapping[str, float], starts: int = 1) -> Fit | None:
    """The parent with an effect more, fitted from the best of its scores."""
    made, scores = score(parent, effect, observed, stated)
    return fitted(made, observed, [s.start for s in scores[:starts]])


@dataclass(frozen=True)
class Naming:
    """The base model's fit, every single effect's, and sets of effects that were tried, the best first."""

    base: Candidate
    singles: tuple[Candidate, ...]
    sets: tuple[Candidate, ...]

    @property
    def best(self) -> Candidate:
        """The most probable set that was tried."""
        return max((self.base, *self.singles, *self.sets), key=lambda c: c.log_evidence)


def name_effects(
    hypothesis: Hypothesis,
    observed: Observed,
    library: Mapping[str, Effect],
    stated: Mapping[str, Mapping[str, float]],
    progress: Progress = silent,
) -> Naming:
    """Fit the base model and every effect of the library."""
    base = fitted(hypothesis, observed, [np.zeros(hypothesis.size)])
    if base is None:
        raise ArithmeticError("the base model cannot be fitted to this test")
    for _ in range(3):
        singles = []
        for i, (name, effect) in enumerate(library.items()):
            progress(f"trying {name}", i / len(library))
            found = added(base, effect, observed, stated.get(name, {}))
            if found is not None:
                singles.append(Candidate((name,), found))
        again = _polished(base, singles, observed)
        if again.log_evidence < base.log_evidence + FAR:
            break
        base = again
    singles.sort(key=lambda c: -c.log_evidence)
    return Naming(Candidate((), base), tuple(singles), ())


def _polished(parent: Fit, children: list[Candidate], observed: Observed) -> Fit:
    """The parent, fitted again from the constants of its best children."""
    best = parent
    for child in sorted(children, key=lambda c: -c.log_evidence)[:3]:
        try:
            found = fit(parent.hypothesis, observed, child.fit.x[: parent.x.size])
        except (ValueError, ArithmeticError):
            continue
        if found.log_evidence > best.log_evidence:
            best = found
    return best


_ = replace
