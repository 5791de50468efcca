"""Naming: which effects of the library, alone or together, explain what the base model leaves open."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice

from hfanalysis.diagnose.naming.base_model import base_model
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.freeform import unknown_beside, unknown_instead
from hfanalysis.diagnose.naming.own_laws import by_their_laws
from hfanalysis.diagnose.naming.polish import ROUNDS, polished
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.several import MOST_EFFECTS, sets_in_place_of, sets_of
from hfanalysis.diagnose.naming.singles import singles_of
from hfanalysis.diagnose.naming.valleys import among_valleys
from hfanalysis.diagnose.naming.variants import Settings
from hfanalysis.inference.candidate import Bench, Candidate, by_evidence, more_probable
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.progress import Progress, silent

RIVAL = 10.0
"""Log evidence behind the best up to which the numbers of a candidate may be told."""


@dataclass(frozen=True)
class Naming:
    """The base model, every single effect, sets of effects, and unknown sources; each the best first.

    ``equations``: of all effects that were thought of; those that a score test saw nothing of have no candidate.
    ``held_out``: log probability of data that were held out beyond the base model's [natural log], by the key of a
    candidate; None where the rest of the data cannot foretell it.
    ``risen``: log evidence by which the base model was found deeper once all had been looked for from it.
    """

    base: Candidate
    singles: tuple[Candidate, ...]
    sets: tuple[Candidate, ...]
    unknown: tuple[Candidate, ...]
    bench: Bench
    equations: Mapping[str, str] = field(default_factory=dict)
    held_out: Mapping[tuple[str, ...], float | None] = field(default_factory=dict)
    risen: float = 0.0

    @property
    def named(self) -> Candidate:
        """The most probable of what has names, none among them."""
        return max((self.base, *self.singles, *self.sets), key=lambda c: c.log_evidence)

    @property
    def all(self) -> tuple[Candidate, ...]:
        """Everything that was tried."""
        return (self.base, *self.singles, *self.sets, *self.unknown)


def _told(candidates: list[Candidate], best: float, bench: Bench) -> list[Candidate]:
    """Candidates, the best first, with the fits of those whose numbers may be told brought to their end."""
    ended = each(lambda c: bench.told(c) if c.log_evidence > best - RIVAL else c, candidates)
    return by_evidence(ended)


def _in_its_valley(found: Candidate, best: float, bench: Bench) -> Candidate:
    """A set near the ``best``, in the valley that is told of those that it has; one effect was looked for in all."""
    return among_valleys(found, bench) if found.log_evidence > best - RIVAL else found


def name_effects(
    hypothesis: Hypothesis,
    observed: Observed,
    catalogue: Catalogue,
    progress: Progress = silent,
    settings: Settings | None = None,
) -> Naming:
    """Try the base model, every effect of the catalogue, sets of them, and unknown sources."""
    settings = settings or Settings()
    bench = Bench(observed if settings.colored else observed.with_white_noise(), settings.tempering)
    search = Search(bench, catalogue, settings, progress)
    progress("fitting the base model", 0.0)
    base, valleys = base_model(hypothesis, bench)
    base, valleys, singles = _from_the_deepest(base, valleys, search)
    singles, sets = sets_of(base, singles, search)
    named = max((base, *singles, *sets), key=lambda c: c.log_evidence)
    progress("trying unknown sources", 0.85)
    unknown = unknown_instead(base, valleys, named, bench)
    named, further, beside = _every_name_first(base, named, singles, search)
    sets, unknown = by_evidence([*further, *sets]), by_evidence([*beside, *unknown])
    told, base = base, polished(base, (*sets, *unknown), bench)
    best = max(c.log_evidence for c in (named, *unknown))
    singles, sets, unknown = (_told(some, best, bench) for some in (singles, sets, unknown))
    sets = by_evidence(each(lambda c: _in_its_valley(c, best, bench), sets))
    risen = base.log_evidence - told.log_evidence
    base, *rest = by_their_laws([base, *singles, *sets, *unknown], RIVAL, bench)
    left = iter(rest)
    singles, sets, unknown = (by_evidence(islice(left, len(some))) for some in (singles, sets, unknown))
    equations = {name: effect.equation for name, effect in catalogue.effects.items()}
    return Naming(base, tuple(singles), tuple(sets), tuple(unknown), bench, equations, risen=risen)


def _every_name_first(
    base: Candidate, named: Candidate, singles: list[Candidate], search: Search
) -> tuple[Candidate, list[Candidate], list[Candidate]]:
    """What is named once no effect does better in the place of an unknown source beside it; the sets that were found on
    the way, and the sources beside what is named."""
    further = list[Candidate]()
    beside = unknown_beside(base, named, search.bench)
    while beside and more_probable(beside[0], named) and len(named.names) < MOST_EFFECTS:
        found = sets_in_place_of(beside[0], named, base, singles, search)
        further += found
        if not found or not more_probable(found[0], named):
            break
        named, beside = found[0], unknown_beside(base, found[0], search.bench)
    return named, further, beside


def _from_the_deepest(
    base: Candidate, valleys: list[Candidate], search: Search
) -> tuple[Candidate, list[Candidate], list[Candidate]]:
    """The base model that none of its children leads out of, its other valleys, and the single effects from there."""
    singles = singles_of(base, valleys, search)
    for _ in range(ROUNDS):
        better = polished(base, singles, search.bench)
        if better is base:
            break
        base, valleys = better, [base, *valleys]
        singles = singles_of(base, valleys, search)
    return base, valleys, singles
