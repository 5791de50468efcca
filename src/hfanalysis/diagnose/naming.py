"""Naming: which effects of the library, alone or together, explain what the base model leaves open.

Every effect is fitted with all calibrated constants free, from the start at which a score test with the constants
projected out sees most of it, first coarse, then fine. A parent is fitted again from its children's constants, for an
unconverged base poses as evidence for a wrong effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.candidate import CALM, PRICE, SHORT, Bench, Candidate, attempted
from hfanalysis.diagnose.fit import Fit, usable
from hfanalysis.diagnose.freeform import unknown_sources
from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.observed import Observed
from hfanalysis.diagnose.predict import predict
from hfanalysis.diagnose.slack import slacked
from hfanalysis.engine.effect import Effect
from hfanalysis.stages.base import Progress, silent

Array = NDArray[np.float64]

STARTS = (-1.2, 0.0, 1.2)
"""Standard deviations from its prior's center at which a parameter of an effect's shape may start."""

FIRST_STEP = 0.05
"""Strength, in units of the typical one (as x), at which slopes of an effect are taken."""

MOST_FIRST = 1.5
"""The largest strength (as x) at which a fit starts."""

HOPELESS = 30.0
"""Log evidence behind the best, at the coarsest form, from which on an effect is not fitted any finer."""

WORTH = 5.0
"""Log evidence that a further effect must bring."""

PARTNERS = 4
"""Effects that are tried as a further one, by their score."""

MOST_EFFECTS = 4


@dataclass(frozen=True)
class Settings:
    """What the method does; all on but in studies of what each is good for."""

    tempering: bool = True
    polishing: bool = True
    projection: bool = True
    coloured: bool = True


@dataclass(frozen=True)
class Catalogue:
    """The effects that may be named, and what a test states of them [SI]."""

    effects: Mapping[str, Effect]
    stated: Mapping[str, Mapping[str, float]]

    def add(self, hypothesis: Hypothesis, name: str) -> Hypothesis:
        """The hypothesis with an effect more."""
        return hypothesis.with_effect(self.effects[name], **self.stated.get(name, {}))


@dataclass(frozen=True)
class Naming:
    """The base model, every single effect, sets of effects, and unknown sources; each the best first.

    ``names``: all effects that were thought of; those that a score test saw nothing of have no candidate.
    """

    base: Candidate
    singles: tuple[Candidate, ...]
    sets: tuple[Candidate, ...]
    unknown: tuple[Candidate, ...]
    bench: Bench
    names: tuple[str, ...] = ()

    @property
    def named(self) -> Candidate:
        """The most probable of what has names, none among them."""
        return max((self.base, *self.singles, *self.sets), key=lambda c: c.log_evidence)

    @property
    def all(self) -> tuple[Candidate, ...]:
        """Everything that was tried."""
        return (self.base, *self.singles, *self.sets, *self.unknown)


def name_effects(
    hypothesis: Hypothesis,
    observed: Observed,
    catalogue: Catalogue,
    progress: Progress = silent,
    settings: Settings | None = None,
) -> Naming:
    """Try the base model, every effect of the catalogue, sets of them, and unknown sources."""
    settings = settings or Settings()
    bench = Bench(observed if settings.coloured else observed.with_white_noise(), settings.tempering)
    base, singles = _singles(hypothesis, bench, catalogue, progress, settings)
    singles = _loosened(singles, bench)
    sets = _loosened(_sets(base, singles, bench, catalogue, progress, settings), bench)
    named = max((base, *singles, *sets), key=lambda c: c.log_evidence)
    progress("trying unknown sources", 0.85)
    unknown = unknown_sources(base, named, bench)
    if settings.polishing:
        base = _base_again(base, [*sets, *unknown], bench)
    return Naming(base, tuple(singles), tuple(sets), tuple(unknown), bench, tuple(catalogue.effects))


def _singles(
    hypothesis: Hypothesis, bench: Bench, catalogue: Catalogue, progress: Progress, settings: Settings
) -> tuple[Candidate, list[Candidate]]:
    coarse, base = _descended(hypothesis, bench, progress)
    rough: dict[str, Fit] = {}
    if not _calm(base):
        rough = _rough(coarse, catalogue, bench, progress, settings)
        bench.settle(max((coarse, *rough.values()), key=lambda f: f.log_evidence))
        base = attempted(hypothesis, bench.fine, coarse.x) or base
    singles: list[Candidate] = []
    for turn in range(2 if settings.polishing else 1):
        calm = _calm(base)
        if turn and not calm:
            rough = _rough(coarse, catalogue, bench, progress, settings)
        singles = []
        names = list(catalogue.effects) if calm else list(rough)
        for i, name in enumerate(names):
            progress(f"fitting {name}", 0.3 + 0.3 * i / len(names))
            fine = _fine_child(base, rough.get(name), catalogue, name, bench, settings)
            if fine is not None:
                singles.append(Candidate((name,), fine, fine.log_evidence - PRICE * bench.floor, bench.floor))
        polished = _polished(base, singles, bench) if settings.polishing else base
        if polished.log_evidence < base.log_evidence + FAR:
            break
        base = polished
        coarse = attempted(hypothesis, bench.at(bench.coarsest), base.x, SHORT) or coarse
    singles.sort(key=lambda c: -c.log_evidence)
    judged = [bench.judged(c.names, c.fit) if i < JUDGED else c for i, c in enumerate(singles)]
    judged.sort(key=lambda c: -c.log_evidence)
    return bench.judged((), base), judged


def _base_again(base: Candidate, children: list[Candidate], bench: Bench) -> Candidate:
    """The base model from the constants of sets and sources as well: what they moved may be all that was wrong."""
    polished = _polished(base.fit, children, bench)
    return bench.judged((), polished) if polished.log_evidence > base.fit.log_evidence else base


def _loosened(candidates: list[Candidate], bench: Bench) -> list[Candidate]:
    """Candidates of one kind, all as much more probable as slack makes the best of them.

    Among themselves they are compared without slack, which would make neighbours alike.
    """
    if not candidates:
        return candidates
    gain = slacked(candidates[0], bench).log_evidence - candidates[0].log_evidence
    return [replace(c, log_evidence=c.log_evidence + gain) for c in candidates]


def _rough(coarse: Fit, catalogue: Catalogue, bench: Bench, progress: Progress, settings: Settings) -> dict[str, Fit]:
    """Every effect at the coarsest form; hopeless ones are left out."""
    rough = {}
    for i, name in enumerate(catalogue.effects):
        progress(f"trying {name}", 0.3 * i / len(catalogue.effects))
        found = _coarse_child(coarse, catalogue, name, bench, settings)
        if found is not None:
            rough[name] = found
    top = max((f.log_evidence for f in rough.values()), default=-np.inf)
    return {n: f for n, f in rough.items() if f.log_evidence > top - HOPELESS}


FAR = 3.0
"""Units of log evidence that a base gains from a child's constants before all are fitted again."""

JUDGED = 4
"""Single effects that are fitted at the model-form error they ask for."""


def _calm(base: Fit) -> bool:
    """Whether the base model leaves hardly anything open."""
    return bool(base.residual @ base.residual < CALM * base.residual.size)


def _descended(hypothesis: Hypothesis, bench: Bench, progress: Progress) -> tuple[Fit, Fit]:
    """The base model's coarse fit, and the fine one from there. Raises ArithmeticError where it cannot be run."""
    progress("fitting the base model", 0.0)
    coarse = attempted(hypothesis, bench.at(bench.coarsest), np.zeros(hypothesis.size), SHORT)
    fine = None if coarse is None else attempted(hypothesis, bench.fine, coarse.x)
    if coarse is None or fine is None:
        raise ArithmeticError("the base model cannot be fitted to this test")
    return coarse, fine


def _coarse_child(coarse: Fit, catalogue: Catalogue, name: str, bench: Bench, settings: Settings) -> Fit | None:
    """An effect more, at the coarsest form: from the best of its scores, and from where nothing is known yet."""
    observed = bench.at(bench.coarsest)
    made, starts = scored(coarse, catalogue, name, observed, settings)
    if coarse.residual @ coarse.residual > ROUGH * coarse.residual.size:
        plain = np.zeros(made.size)
        size = coarse.x.size
        plain[size : size + catalogue.effects[name].strengths] = 0.3
        starts = [*starts[:1], plain]
    found = [f for x in starts[:2] if (f := attempted(made, observed, x, SHORT)) is not None]
    return max(found, key=lambda f: f.log_evidence) if found else None


ROUGH = 1.5
"""Chi-square per observation, at the coarsest form, from which on a fit also starts from where nothing is known."""


def _fine_child(
    base: Fit, rough: Fit | None, catalogue: Catalogue, name: str, bench: Bench, settings: Settings
) -> Fit | None:
    """The fine fit from the coarse one and from the fine score, whichever is nearer.

    Where nothing was fitted coarsely and the score sees nothing, there is no need for a fit.
    """
    made = catalogue.add(base.hypothesis, name)
    scores = sorted(_scores(base, made, catalogue.effects[name].strengths, bench.fine, settings), key=lambda s: -s[0])
    if rough is None and (not scores or scores[0][0] < SEEN):
        return None
    best: tuple[float, Array] | None = None
    for x in [*([rough.x] if rough is not None else []), *(start for _, start in scores[:2])]:
        try:
            there = predict(made, bench.fine, x, tangents=False)
        except (ValueError, ArithmeticError):
            continue
        value = float(there.residual @ there.residual + x @ x)
        if np.isfinite(value) and (best is None or value < best[0]):
            best = (value, x)
    return None if best is None else attempted(made, bench.fine, best[1])


SEEN = 0.7
"""Gain in log probability below which a score test has seen nothing."""


def scored(
    parent: Fit, catalogue: Catalogue, name: str, observed: Observed, settings: Settings
) -> tuple[Hypothesis, list[Array]]:
    """The parent with an effect more, and starts for its fit: those of the best score tests first."""
    made = catalogue.add(parent.hypothesis, name)
    ranked = sorted(_scores(parent, made, catalogue.effects[name].strengths, observed, settings), key=lambda s: -s[0])
    return made, [start for _, start in ranked]


def _scores(
    parent: Fit, made: Hypothesis, strengths: int, observed: Observed, settings: Settings
) -> list[tuple[float, Array]]:
    least, most = made.bounds
    size = parent.x.size
    own = slice(size, size + strengths)
    shapes = [i for i in range(size + strengths, made.size) if made.free[i].shape == "positive" and made.free[i].unsure]
    found = []
    for choice in product(STARTS, repeat=len(shapes)):
        start = np.concatenate([parent.x, np.zeros(made.size - size)])
        start[shapes] = choice
        start[own] = FIRST_STEP
        start = np.clip(start, least, most)
        try:
            there = predict(made, observed, start, tangents=True)
        except (ValueError, ArithmeticError):
            continue
        if there.slopes is not None and usable(there) and np.isfinite(there.residual).all():
            gain, strength = score(there.slopes, there.residual, start, own, (least, most), settings.projection)
            start[own] = np.clip(strength, -MOST_FIRST, MOST_FIRST)
            found.append((gain, start))
    return found


def score(
    slopes: Array, residual: Array, x: Array, own: slice, bounds: tuple[Array, Array], projection: bool = True
) -> tuple[float, Array]:
    """Gain in log probability by strengths ``own``, with the parameters before them projected out, and the strengths.

    ``slopes`` (observations, parameters) of the residual at ``x``, whose prior is N(0, 1).
    """
    a, b = slopes[:, : own.start], slopes[:, own]
    still = residual - b @ x[own]
    still_x = x[: own.start]
    if projection:
        curvature = a.T @ a + np.eye(a.shape[1])
        through = np.linalg.solve(curvature, a.T)
        start = still - a @ still_x  # the parameters at their prior's center
        clear = b - a @ (through @ b)
        information, pull = b.T @ clear, -(clear.T @ start)
    else:
        information, pull = b.T @ b, -(b.T @ still)
    strength = np.linalg.solve(information + np.eye(pull.size), pull)
    strength = np.clip(strength, bounds[0][own], bounds[1][own])
    gain = float(pull @ strength - 0.5 * strength @ (information + np.eye(pull.size)) @ strength)
    return gain, strength


def _polished(parent: Fit, children: list[Candidate], bench: Bench) -> Fit:
    """The parent, fitted again from the constants of its best children."""
    best = parent
    for child in sorted(children, key=lambda c: -c.log_evidence)[:3]:
        found = attempted(parent.hypothesis, bench.fine, child.fit.x[: parent.x.size])
        if found is not None and found.log_evidence > best.log_evidence:
            best = found
    return best


def _sets(
    base: Candidate,
    singles: list[Candidate],
    bench: Bench,
    catalogue: Catalogue,
    progress: Progress,
    settings: Settings,
) -> list[Candidate]:
    """Sets of several effects: forward from the best few, dropping what is no longer needed."""
    found: dict[frozenset[str], Candidate] = {}
    tried: set[frozenset[str]] = set()
    front = [c for c in singles[:2] if c.log_evidence > base.log_evidence + WORTH]
    for size in range(2, MOST_EFFECTS + 1):
        progress(f"trying {size} effects together", 0.6 + 0.06 * size)
        grown = []
        for parent in front:
            grown += _partners(parent, bench, catalogue, tried, settings)
        better = [c for c in grown if c.log_evidence > _parent_evidence(c, singles, found) + WORTH]
        if not better:
            break
        better = [_dropped(c, bench, catalogue) for c in sorted(better, key=lambda c: -c.log_evidence)[:2]]
        found |= {frozenset(c.names): c for c in better if len(c.names) > 1}
        front = better[:1]
    return sorted(found.values(), key=lambda c: -c.log_evidence)


def _parent_evidence(child: Candidate, singles: list[Candidate], found: Mapping[frozenset[str], Candidate]) -> float:
    """The best evidence among subsets of a set."""
    names = set(child.names)
    known = [c.log_evidence for c in (*singles, *found.values()) if set(c.names) < names]
    return max(known, default=-np.inf)


def _partners(
    parent: Candidate, bench: Bench, catalogue: Catalogue, tried: set[frozenset[str]], settings: Settings
) -> list[Candidate]:
    """The parent with each of the few effects that a score test asks for."""
    scores = []
    observed = bench.at(parent.steps)
    for name, effect in catalogue.effects.items():
        if name in parent.names or frozenset((*parent.names, name)) in tried:
            continue
        made = catalogue.add(parent.fit.hypothesis, name)
        ranked = _scores(parent.fit, made, effect.strengths, observed, settings)
        if ranked:
            gain, start = max(ranked, key=lambda s: s[0])
            scores.append((gain, name, made, start))
    out: list[tuple[tuple[str, ...], Fit]] = []
    for gain, name, made, start in sorted(scores, key=lambda s: -s[0])[:PARTNERS]:
        if gain < 0.5 * WORTH:
            continue
        names = (*parent.names, name)
        tried.add(frozenset(names))
        found = attempted(made, observed, start)
        if found is not None and parent.steps > bench.floor:
            found = attempted(made, bench.fine, found.x) or found
        if found is not None:
            out.append((names, found))
    out.sort(key=lambda c: -c[1].log_evidence)
    return [bench.judged(names, found) for names, found in out[:JUDGED_PARTNERS]]


JUDGED_PARTNERS = 4
"""Of those, how many are fitted at the model-form error they ask for."""


def _dropped(candidate: Candidate, bench: Bench, catalogue: Catalogue) -> Candidate:
    """The set without the effects whose loss makes the data no less probable."""
    for name in candidate.names[:-1]:
        if len(candidate.names) < 2:
            break
        hypothesis = candidate.fit.hypothesis.without(name)
        kept = [i for i, f in enumerate(candidate.fit.hypothesis.free) if f.name.partition(".")[0] != name]
        found = attempted(hypothesis, bench.fine, candidate.fit.x[kept])
        if found is None:
            continue
        names = tuple(n for n in candidate.names if n != name)
        less = bench.judged(names, found)
        if less.log_evidence > candidate.log_evidence - WORTH:
            candidate = replace(less)
    return candidate


def limits(chosen: Candidate, bench: Bench, catalogue: Catalogue, settings: Settings) -> dict[str, tuple[float, str]]:
    """For every effect that is not in the model: the size [SI] that it stays below with 95 % probability, linear."""
    out = {}
    observed = bench.at(chosen.steps)
    for name, effect in catalogue.effects.items():
        if name in chosen.names or (effect.distort is not None and not set(effect.sites) & set(observed.names)):
            continue
        made = catalogue.add(chosen.fit.hypothesis, name)
        start = inserted(chosen.fit, made)
        own = len(chosen.fit.hypothesis.free)
        least, most = made.bounds
        start[own] = FIRST_STEP
        try:
            there = predict(made, observed, np.clip(start, least, most), tangents=True)
        except (ValueError, ArithmeticError):
            continue
        if there.slopes is None or not usable(there):
            continue
        curvature = there.slopes.T @ there.slopes + np.eye(start.size)
        step = -np.linalg.solve(curvature, there.slopes.T @ there.residual + start)
        std = float(np.sqrt(np.linalg.inv(curvature)[own, own]))
        at = min(max(start[own] + step[own], least[own], 0.0) + Z95 * std, most[own])
        out[name] = (made.free[own].value(float(at)), effect.strength.unit.replace("-", ""))
    return out


Z95 = 1.645
"""One-sided 95 % of a normal distribution, in standard deviations."""


def inserted(parent: Fit, made: Hypothesis) -> Array:
    """The parent's parameters in a hypothesis with more effects: those come after its own and before its sources."""
    own = len(parent.hypothesis.free)
    new = np.zeros(len(made.free) - own)
    return np.concatenate([parent.x[:own], new, parent.x[own:]])
