"""What held-out data bear out of the evidence for a claim.

Whatever is claimed, its likeliest rival (a placebo) and a free curve are fitted to a part of the data and asked for the
rest. A fit to all of it promises to explain so much more of each stretch than the base model does, given the others;
fits to the rest keep a part of that, and the evidence counts as far as it is kept. What is claimed is what has most of
that evidence: more than the rival, and more than the curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.predictive import Foretold, log_predictive

SPARE = 3.0
"""Log probability [natural log] by which what is kept may be less than what was promised. Source: a fit to half of the
data has twice the variance; each parameter that an effect has, of which there are one to four, costs a half per
stretch for it."""

ROUNDS = 3
"""Times that another claim takes the place of one that is not borne out."""


class Claim(Protocol):
    """What is claimed, and the candidate behind it."""

    @property
    def label(self) -> str:
        """None, named, ambiguous or unknown."""

    @property
    def chosen(self) -> Candidate:
        """What the claim is made by; the base model where there is none."""


def borne_out(found: Naming, claimed: Callable[[Naming], Claim]) -> Naming:
    """The same with the evidence of all that a claim rests on as far as held-out data bear it out."""
    before: Foretold | None = None
    for _ in range(ROUNDS):
        claim = claimed(found)
        asked = [c for c in _contenders(found, claim) if c.key not in found.held_out]
        if claim.label == "none" or not asked:
            break
        before = log_predictive(found.base, found.bench) if before is None else before
        if before is None:
            break
        told = {c.key: _kept(c, found, before) for c in asked}
        found = replace(
            found,
            held_out={**found.held_out, **{key: None if kept is None else kept.gain for key, kept in told.items()}},
            singles=_lessened(found.singles, told, found.base),
            sets=_lessened(found.sets, told, found.base),
            unknown=_lessened(found.unknown, told, found.base),
        )
    return found


@dataclass(frozen=True)
class Kept:
    """The ``gain`` in log probability of what was held out, and the ``part`` [-] that it is of what was promised."""

    gain: float
    part: float


def _kept(one: Candidate, found: Naming, before: Foretold) -> Kept | None:
    """What a candidate keeps of what it promises beyond the base model; None where that tells nothing."""
    there = log_predictive(one, found.bench)
    if there is None:
        return None
    gain, promised = there.rest - before.rest, there.all - before.all
    return Kept(gain, part_kept(gain, promised))


def part_kept(gain: float, promised: float) -> float:
    """The part [-] of a promise that is kept, both in log probability; all of it within SPARE.

    >>> part_kept(20.0, 22.0), part_kept(7.0, 40.0), part_kept(-30.0, 5.0)
    (1.0, 0.25, 0.0)
    """
    return min(max((gain + SPARE) / max(promised, SPARE), 0.0), 1.0)


def _contenders(found: Naming, claim: Claim) -> list[Candidate]:
    """What is claimed, what it is part of or has as its part, the likeliest rival, and the likeliest free curve."""
    chosen = claim.chosen
    if chosen is found.base:
        return []
    first = next((c for c in found.singles if c.names == chosen.names[:1]), None)
    rival = next((c for c in found.singles if not set(c.names) & set(chosen.names)), None)
    curve = next((c for c in found.unknown if len(c.names) == 1), None)
    kept = [c for c in (chosen, first, rival, curve) if c is not None and c.log_evidence > found.base.log_evidence]
    return list({c.key: c for c in kept}.values())


def _lessened(
    candidates: tuple[Candidate, ...], told: dict[tuple[str, ...], Kept | None], base: Candidate
) -> tuple[Candidate, ...]:
    """Those with no more evidence than is borne out, the best first."""
    out = [_at_most(c, told.get(c.key), base) for c in candidates]
    return tuple(sorted(out, key=lambda c: -c.log_evidence))


def _at_most(one: Candidate, kept: Kept | None, base: Candidate) -> Candidate:
    gain = one.log_evidence - base.log_evidence
    if kept is None or gain <= 0.0:
        return one
    return replace(one, log_evidence=base.log_evidence + kept.part * gain)
