"""Sets of several effects: forward from the best few, by score tests, dropping what is no longer needed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.diagnose.candidate import Bench, Candidate, attempted, candidate
from hfanalysis.diagnose.predict import predict
from hfanalysis.diagnose.score import score_tests
from hfanalysis.diagnose.search import Search
from hfanalysis.diagnose.singles import HOPELESS
from hfanalysis.diagnose.threads import each

SEEN = 5.0
"""Log evidence of a single effect from which on others are tried beside it."""

ASKED = 2.5
"""Gain in log probability that a score test must promise for a further effect to be fitted."""

PARTNERS = 4
"""Effects that are tried as a further one, by their score."""

MOST_EFFECTS = 4

CERTAIN = 8.0
"""Standard deviations from nothing, other constants free, from which on an effect is not tried to be left out."""


def sets_of(base: Candidate, singles: list[Candidate], search: Search) -> list[Candidate]:
    """Sets of several effects: forward from the best few, dropping what is no longer needed."""
    found: dict[frozenset[str], Candidate] = {}
    tried: set[frozenset[str]] = set()
    front = [c for c in singles[:2] if c.log_evidence > base.log_evidence + SEEN]
    for size in range(2, MOST_EFFECTS + 1):
        search.progress(f"trying {size} effects together", 0.6 + 0.06 * size)
        grown = []
        for parent in front:
            grown += _partners(parent, search, tried)
        better = [c for c in grown if c.log_evidence > _parent_evidence(c, singles, found)]
        if not better:
            break
        best = [_dropped(c, search.bench) for c in sorted(better, key=lambda c: -c.log_evidence)[:2]]
        found |= {frozenset(c.names): c for c in (*better, *best) if len(c.names) > 1}
        front = best[:1]
    return sorted(found.values(), key=lambda c: -c.log_evidence)


def _parent_evidence(child: Candidate, singles: list[Candidate], found: Mapping[frozenset[str], Candidate]) -> float:
    """The best evidence among subsets of a set."""
    names = set(child.names)
    known = [c.log_evidence for c in (*singles, *found.values()) if set(c.names) < names]
    return max(known, default=-np.inf)


def _partners(parent: Candidate, search: Search, tried: set[frozenset[str]]) -> list[Candidate]:
    """The parent with each of the few effects that a score test asks for, at the form that suits them.

    The score is taken at the next finer form, to which the parent does not fit: what it lacks shows there.
    """
    bench, catalogue = search.bench, search.catalogue
    finer = bench.at(parent.form.both_finer)
    slopes = predict(parent.fit.hypothesis, finer, parent.fit.x, tangents=True).slopes
    assert slopes is not None
    names = [n for n in catalogue.effects if n not in parent.names and frozenset((*parent.names, n)) not in tried]
    tests = each(lambda n: score_tests(parent.fit, slopes, catalogue, n, finer, search.settings), names)
    scores = [(found[0], name, made) for name, (made, found) in zip(names, tests, strict=True) if found]
    asked = [s for s in sorted(scores, key=lambda s: -s[0][0])[:PARTNERS] if s[0][0] >= ASKED]
    tried |= {frozenset((*parent.names, name)) for _, name, _ in asked}
    fits = each(lambda s: attempted(s[2], bench.at(parent.form), s[0][1]), asked)
    out = [
        candidate((*parent.names, name), found, parent.form)
        for (_, name, _), found in zip(asked, fits, strict=True)
        if found is not None
    ]
    top = max((c.log_evidence for c in out), default=0.0)
    return each(bench.judged, [c for c in out if c.log_evidence > top - HOPELESS])


def _dropped(found: Candidate, bench: Bench) -> Candidate:
    """The set without the effects whose loss makes the data no less probable."""
    for name in found.names[:-1]:
        if len(found.names) < 2:
            break
        if _certain(found, name):
            continue
        hypothesis = found.fit.hypothesis.without(name)
        kept = [i for i, f in enumerate(found.fit.hypothesis.free) if f.name.partition(".")[0] != name]
        again = attempted(hypothesis, bench.at(found.form), found.fit.x[kept])
        if again is None:
            continue
        less = bench.judged(candidate(tuple(n for n in found.names if n != name), again, found.form))
        if less.log_evidence > found.log_evidence:
            found = less
    return found


def _certain(found: Candidate, name: str) -> bool:
    """Whether a strength of an effect is so far from nothing that the set cannot do without it."""
    active = next(a for a in found.fit.burnt.steps.engine.effects if a.effect.name == name)
    strengths = [f"{name}.{p.name}" for p in active.effect.parameters[: active.effect.strengths]]
    values, stds = found.fit.values, found.fit.stds
    return any(abs(values[s]) > CERTAIN * stds[s] for s in strengths)
