"""Naming: which effects of the library, alone or together, explain what the base model leaves open.

Every effect is fitted with all calibrated constants free, from the start at which a score test with the constants
projected out sees most of it, first coarse, then fine. A parent is fitted again from its children's constants, for an
unconverged base poses as evidence for a wrong effect.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.candidate import CALM, PRICE, SHORT, Bench, Candidate, attempted
from hfanalysis.diagnose.catalogue import Catalogue
from hfanalysis.diagnose.fit import Fit
from hfanalysis.diagnose.freeform import unknown_sources
from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.observed import Observed
from hfanalysis.diagnose.predict import predict
from hfanalysis.diagnose.score import score_tests
from hfanalysis.diagnose.several import sets_of
from hfanalysis.diagnose.slack import slacked
from hfanalysis.diagnose.variants import Settings
from hfanalysis.stages.base import Progress, silent

Array = NDArray[np.float64]

HOPELESS = 30.0
"""Log evidence behind the best, at the coarsest form, from which on an effect is not fitted any finer."""

FAR = 3.0
"""Units of log evidence that a base gains from a child's constants before all are fitted again."""

JUDGED = 4
"""Single effects that are fitted at the model-form error they ask for."""

ROUGH = 1.5
"""Chi-square per observation, at the coarsest form, from which on a fit also starts from where nothing is known."""

SEEN = 0.7
"""Gain in log probability below which a score test has seen nothing."""


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
    sets = _loosened(sets_of(base, singles, bench, catalogue, progress, settings), bench)
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
    made, tests = score_tests(coarse, catalogue, name, observed, settings)
    starts = [x for _, x in tests]
    if coarse.residual @ coarse.residual > ROUGH * coarse.residual.size:
        plain = np.zeros(made.size)
        size = coarse.x.size
        plain[size : size + catalogue.effects[name].strengths] = 0.3
        starts = [*starts[:1], plain]
    found = [f for x in starts[:2] if (f := attempted(made, observed, x, SHORT)) is not None]
    return max(found, key=lambda f: f.log_evidence) if found else None


def _fine_child(
    base: Fit, rough: Fit | None, catalogue: Catalogue, name: str, bench: Bench, settings: Settings
) -> Fit | None:
    """The fine fit from the coarse one and from the fine score, whichever is nearer.

    Where nothing was fitted coarsely and the score sees nothing, there is no need for a fit.
    """
    made, tests = score_tests(base, catalogue, name, bench.fine, settings)
    if rough is None and (not tests or tests[0][0] < SEEN):
        return None
    best: tuple[float, Array] | None = None
    for x in [*([rough.x] if rough is not None else []), *(start for _, start in tests[:2])]:
        try:
            there = predict(made, bench.fine, x, tangents=False)
        except (ValueError, ArithmeticError):
            continue
        value = float(there.residual @ there.residual + x @ x)
        if np.isfinite(value) and (best is None or value < best[0]):
            best = (value, x)
    return None if best is None else attempted(made, bench.fine, best[1])


def _polished(parent: Fit, children: list[Candidate], bench: Bench) -> Fit:
    """The parent, fitted again from the constants of its best children."""
    best = parent
    for child in sorted(children, key=lambda c: -c.log_evidence)[:3]:
        found = attempted(parent.hypothesis, bench.fine, child.fit.x[: parent.x.size])
        if found is not None and found.log_evidence > best.log_evidence:
            best = found
    return best
