"""What held-out data bear out of the evidence for a claim.

Whatever is claimed, its likeliest rival (a placebo) and a free curve are fitted to a part of the data and asked for the
rest. A fit to all of it promises to explain so much more of each stretch than the base model does, given the others;
fits to the rest keep a part of that, and what they do not keep is taken from the evidence. What is claimed is what has
most of that evidence: more than the rival, and more than the curve.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

from hfanalysis.diagnose.naming.naming import RIVAL, Naming
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.predictive import Foretold, log_predictive

SPARE = 3.0
"""Log probability [natural log] by which what is kept may be less than what was promised. Source: a fit to half of the
data has twice the variance; each parameter that an effect has, of which there are one to four, costs a half per
stretch for it."""

REACH = 2.0
"""Times what stretches lose of a promise that can be lost of the evidence. Source: choice; given the others on both
sides, stretches tell little of what is slow, and where they tell less than half of the evidence, what noise takes of
their promise says little of the other part."""

ROUNDS = 8
"""Times that something is asked: what is claimed, what that has as its part, and what comes near it then."""


class Claim(Protocol):
    """What is claimed, and the candidate behind it."""

    @property
    def label(self) -> str:
        """None, named, ambiguous or unknown."""

    @property
    def chosen(self) -> Candidate:
        """What the claim is made by; the base model where there is none."""


def borne_out(found: Naming, claimed: Callable[[Naming], Claim]) -> Naming:
    """The same with the evidence of all that a claim rests on as far as held-out data bear it out.

    A rival, or a curve, that is RIVAL behind what is left of the claim stays there: it is not asked.
    """
    told: dict[tuple[str, ...], Foretold | None] = {}
    all_of_it = {c.key: c.log_evidence for c in reversed(found.all)}
    before: Foretold | None = None
    for _ in range(ROUNDS):
        one = next((c for c in _contenders(found, claimed(found)) if c.key not in told), None)
        if one is None:
            break
        before = before or log_predictive(found.base, found.bench)
        if before is None:
            break
        told[one.key] = log_predictive(one, found.bench)
        found = _counted(found, one, before, told, all_of_it)
    return found


Told = Mapping[tuple[str, ...], Foretold | None]


def _counted(
    found: Naming, one: Candidate, before: Foretold, told: Told, all_of_it: Mapping[tuple[str, ...], float]
) -> Naming:
    """The same after a candidate was asked: its evidence is less by what it does not keep of its promise, beyond the
    base model, or of a set beyond its largest part that was asked before.

    Other sets with that part keep no more of what they have beyond it, until they are asked. ``all_of_it``: the
    evidence [natural log] of each as it was.
    """
    there, part = told[one.key], _largest_part(one, found)
    gain = None if there is None else there.rest - before.rest
    found = replace(found, held_out={**found.held_out, one.key: gain})
    if there is None:
        return found
    of_part = None if part is None else told.get(part.key)
    beyond, rest = (found.base, before) if part is None or of_part is None else (part, of_part)
    kept, promised, names = there.rest - rest.rest, there.all - rest.all, set(beyond.names)

    def lessened(c: Candidate) -> Candidate:
        alike = bool(names) and c.key not in told and names < set(c.names) and not c.unknown
        if c.key != one.key and not alike:
            return c
        further = max(all_of_it[c.key] - all_of_it[beyond.key], 0.0)
        left = beyond.log_evidence + further - broken(kept, promised, further)
        return replace(c, log_evidence=min(all_of_it[c.key], left))

    def each_of(candidates: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        return tuple(sorted(map(lessened, candidates), key=lambda c: -c.log_evidence))

    return replace(found, singles=each_of(found.singles), sets=each_of(found.sets), unknown=each_of(found.unknown))


def _largest_part(one: Candidate, found: Naming) -> Candidate | None:
    """The most probable explanation by some of the names of a set; None of a single one."""
    parts = [c for c in (*found.singles, *found.sets) if set(c.names) < set(one.names) and not c.unknown]
    return max(parts, key=lambda c: c.log_evidence, default=None) if not one.unknown else None


def broken(gain: float, promised: float, evidence: float) -> float:
    """What of an ``evidence`` is lost since a promise was not kept, all in log probability [natural log]; nothing where
    it was kept within SPARE.

    As large a part of the evidence as of the promise, and no more than REACH times what was lost of the promise.

    >>> broken(20.0, 22.0, 25.0), broken(7.0, 40.0, 40.0), broken(-30.0, 5.0, 20.0)
    (0.0, 30.0, 20.0)
    >>> broken(0.5, 4.5, 300.0)
    2.0
    """
    lost, promised = max(promised - gain - SPARE, 0.0), max(promised, SPARE)
    return min(lost * min(evidence / promised, REACH), evidence)


def _contenders(found: Naming, claim: Claim) -> list[Candidate]:
    """What a claim has as its part, what is claimed, and the likeliest rival and the likeliest free curve where they
    come near it."""
    chosen = claim.chosen
    if claim.label == "none" or chosen is found.base:
        return []
    rival = next((c for c in found.singles if not set(c.names) & set(chosen.names)), None)
    curve = next((c for c in found.unknown if len(c.names) == 1), None)
    near = [c for c in (rival, curve) if c is not None and c.log_evidence > chosen.log_evidence - RIVAL]
    part = _largest_part(chosen, found)
    return [*([part] if part is not None else []), chosen, *near]
