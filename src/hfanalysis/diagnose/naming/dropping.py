"""Backward: effects that an explanation can do without."""

from __future__ import annotations

from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.observations.observed import Observed

CERTAIN = 8.0
"""Standard deviations from nothing, other constants free, from which on an effect is not tried to be left out."""


def dropped(found: Candidate, bench: Bench) -> Candidate:
    """The set without the effects whose loss makes the data no less probable; a source stays.

    One that was added last may have done no more than show the others the way to a better fit.
    """
    for name in found.names[:-1] if found.unknown else found.names:
        if len(found.names) < 2:
            break
        if _certain(found, name):
            continue
        again = without(found, name, bench.at(found.form))
        if again is None:
            continue
        names = list(found.names)
        names.remove(name)  # its first: the site of a source, which stays, may be called like an effect
        less = bench.judged(candidate(tuple(names), again, found.form, found.source))
        if less.log_evidence > found.log_evidence:
            found = less
    return found


def _certain(found: Candidate, name: str) -> bool:
    """Whether a strength of an effect is so far from nothing that the set cannot do without it."""
    active = next(a for a in found.fit.burnt.steps.engine.effects if a.effect.name == name)
    strengths = [f"{name}.{p.name}" for p in active.effect.parameters[: active.effect.strengths]]
    values, stds = found.fit.values, found.fit.stds
    return any(abs(values[s]) > CERTAIN * stds[s] for s in strengths)


def without(found: Candidate, name: str, observed: Observed) -> Fit | None:
    """The fit of a set without one of its effects."""
    hypothesis = found.fit.hypothesis.without(name)
    kept = [i for i, full in enumerate(found.fit.hypothesis.names) if full.partition(".")[0] != name]
    return attempted(hypothesis, observed, found.fit.x[kept], SHORT)
