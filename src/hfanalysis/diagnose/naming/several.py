"""Sets of several effects: forward from the best few, by score tests, dropping what is no longer needed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.dropping import dropped, without
from hfanalysis.diagnose.naming.fading import fades, fading_fit
from hfanalysis.diagnose.naming.score import score_tests
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.slack import slack_gain
from hfanalysis.inference.candidate import (
    LONG,
    SHORT,
    TOO_FAR_BEHIND,
    Bench,
    Candidate,
    attempted,
    by_evidence,
    candidate,
    more_probable,
)
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed

PLAIN = 5.0
"""Log evidence of a single effect from which on others are tried beside it."""

ASKED = 2.5
"""Gain in log probability that a score test must promise for a further effect to be fitted."""

FAR = 3.0
"""Log evidence that a single effect gains from the constants of a pair before sets are tried anew. Evidence: a practice
case was wrong while a single effect did not go on from where a pair led (docs/diagnosis.md)."""

PARTNERS = 4
"""Effects that are tried as a further one, by their score, on either side that can be finer."""

MOST_EFFECTS = 4
"""Effects that a set has at most."""

Pairs = dict[tuple[tuple[str, ...], float], list[Candidate]]
"""What was found with a further effect beside a candidate, by its names and its log evidence [natural log]."""


def sets_of(
    base: Candidate, singles: list[Candidate], search: Search, pairs: Pairs | None = None
) -> tuple[list[Candidate], list[Candidate]]:
    """The singles and sets of several effects, with the evidence that they have with slack; each the best first.

    Forward from the best two, dropping what is no longer needed. A further effect has to make the data more probable
    where both have slack: what the closure of the first gets wrong is no second effect. Where the second did no more
    than show the first the way to a better fit, the search begins anew with that.
    """
    bench, tried = search.bench, set[frozenset[str]]()
    singles = by_evidence(singles)
    front = [c for c in singles[:2] if c.log_evidence > base.log_evidence + PLAIN]
    known = _loosened(singles, base, bench)
    found: list[Candidate] = []
    for size in range(2, MOST_EFFECTS + 1):
        search.progress(f"trying {size} effects together", 0.6 + 0.06 * size)
        at_hand: Pairs = pairs if size == 2 and pairs is not None else {}
        grown = by_evidence(_partners(front, search, tried, at_hand))
        if size == 2 and (better := _shown_the_way(grown[:2], singles, bench)):
            return sets_of(base, _best_each([*better, *singles]), search, at_hand)
        best = [c for c in each(lambda c: dropped(c, bench), grown[:2]) if len(c.names) > 1]
        loose = _loosened([*best, *grown], base, bench)
        front = [c for c, free in zip(best, loose, strict=False) if free.log_evidence > _of_subsets(c, known)][:1]
        if not front:
            break
        found += loose
        known += loose
        last = front[0]
    if found and (other := swapped(last, search)) is not last:
        found += _loosened([other], base, bench)
    return known[: len(singles)], [by_what_each_explains(c, singles) for c in by_evidence(_best_each(found))]


def sets_in_place_of(
    unknown: Candidate, named: Candidate, base: Candidate, singles: list[Candidate], search: Search
) -> list[Candidate]:
    """What is ``named`` with each effect that is asked for in the place of an ``unknown`` source, the best first.

    At the form that the source led to: what a coarser one takes for model-form error may have a name.
    """
    bench = search.bench
    parent = named if named.form == unknown.form else bench.refitted(named, unknown.form)
    if parent is None:
        return []
    grown = by_evidence(_beside(parent, search, set()))
    best = [less for c in grown[:1] if (less := dropped(c, bench)) is not c and len(less.names) > 1]
    found = by_evidence(_best_each(_loosened(by_evidence([*best, *grown]), base, bench)))
    return [by_what_each_explains(c, singles) for c in found]


def by_what_each_explains(found: Candidate, singles: list[Candidate]) -> Candidate:
    """The set with its names in the order of what each explains alone: it is named for the first of them.

    A set may have been come upon from the lesser one.
    """
    alone = {c.names[0]: c.log_evidence for c in singles}
    return replace(found, names=tuple(sorted(found.names, key=lambda n: -alone.get(n, -np.inf))))


def _shown_the_way(pairs: list[Candidate], singles: list[Candidate], bench: Bench) -> list[Candidate]:
    """The first effects of pairs, fitted again from the pairs' constants: those that are far better there."""

    def alone(pair: Candidate) -> Candidate | None:
        again = without(pair, pair.names[1], bench.at(pair.form))
        return None if again is None else bench.judged(candidate(pair.names[:1], again, pair.form))

    known = {c.names: c.log_evidence for c in singles}
    return [c for c in each(alone, pairs) if c is not None and c.log_evidence > known[c.names] + FAR]


def _loosened(candidates: list[Candidate], base: Candidate, bench: Bench) -> list[Candidate]:
    """Candidates of one kind, more probable by what slack brings the first of them, in proportion to what they explain.

    Among themselves they are compared without slack, which would make neighbors alike. An effect that is hardly there
    has no slack to speak of: it stays with the ``base`` model.
    """
    if not candidates:
        return []
    gain, most = slack_gain(candidates[0], bench), candidates[0].log_evidence - base.log_evidence
    explained = [min(max((c.log_evidence - base.log_evidence) / max(most, 1e-9), 0.0), 1.0) for c in candidates]
    return [replace(c, log_evidence=c.log_evidence + gain * e) for c, e in zip(candidates, explained, strict=True)]


def _of_subsets(candidate: Candidate, known: list[Candidate]) -> float:
    """The best evidence among subsets of a set."""
    names = set(candidate.names)
    return max((c.log_evidence for c in known if set(c.names) < names), default=-np.inf)


def _best_each(candidates: list[Candidate]) -> list[Candidate]:
    """Of every set of names the candidate with most evidence."""
    best: dict[frozenset[str], Candidate] = {}
    for c in candidates:
        names = frozenset(c.names)
        if names not in best or more_probable(c, best[names]):
            best[names] = c
    return list(best.values())


def _partners(front: list[Candidate], search: Search, tried: set[frozenset[str]], pairs: Pairs) -> list[Candidate]:
    """Each parent with each of the few effects that a score test asks for or that fade, at the form that suits them;
    those of parents that ``pairs`` has are at hand, the others are kept there."""
    found = list[Candidate]()
    for parent in front:
        key = parent.names, parent.log_evidence
        if key not in pairs:
            pairs[key] = _beside(parent, search, tried)
        tried |= {frozenset(c.names) for c in pairs[key]}
        found += pairs[key]
    return found


def _beside(parent: Candidate, search: Search, tried: set[frozenset[str]]) -> list[Candidate]:
    """One parent with each of its partners in sets that were not ``tried``, which take up what is tried here."""
    bench, observed = search.bench, search.bench.at(parent.form)
    effects = search.catalogue.effects
    names = [n for n in effects if frozenset((*parent.names, n)) not in tried and n not in parent.names]
    asked = _asked(parent, [bench.at(form) for form in parent.form.either_finer or [parent.form]], search, names)
    wanted = [*asked, *(n for n in names if n not in asked and fades(search, n))]
    tried |= {frozenset((*parent.names, name)) for name in wanted}

    def grown(name: str) -> Candidate | None:
        if name in asked:
            found = attempted(asked[name][0], observed, asked[name][1], SHORT)
        else:
            found = fading_fit(parent.fit, search, name, observed)
        return None if found is None else candidate((*parent.names, name), found, parent.form)

    started = _in_the_running([c for c in each(grown, wanted) if c is not None], bench)
    return each(bench.judged, _in_the_running(each(partial(bench.converged, most=LONG - SHORT), started), bench))


def _in_the_running(grown: list[Candidate], bench: Bench) -> list[Candidate]:
    """Those that are not, and do not promise to stay, far behind the best; all have the same parent, whose form they
    share."""
    least = max((c.log_evidence for c in grown), default=0.0) - TOO_FAR_BEHIND
    return [c for c in grown if bench.reach(c) > least]


def _asked(
    parent: Candidate, forms: list[Observed], search: Search, names: list[str]
) -> dict[str, tuple[Hypothesis, Array]]:
    """The few effects with most to gain at each form, with where their fit starts, by score tests.

    The forms are finer on one side than the parent fits to: what it lacks shows there.
    """
    first = predict(parent.fit.hypothesis, forms[0], parent.fit.x, tangents=True).slopes
    assert first is not None
    slopes = [first, *(observed.rewhitened(first, forms[0]) for observed in forms[1:])]
    tests = each(lambda n: score_tests(parent.fit, slopes, search.catalogue, n, forms, search.settings), names)
    asked: dict[str, tuple[Hypothesis, Array]] = {}
    for k in range(len(forms)):
        seen = {
            n: (made, of[k][0]) for n, (made, of) in zip(names, tests, strict=True) if of[k] and of[k][0][0] >= ASKED
        }
        for name in sorted(seen, key=lambda n: -seen[n][1][0])[:PARTNERS]:
            made, (_, start) = seen[name]
            asked.setdefault(name, (made, start))
    return asked


def swapped(found: Candidate, search: Search) -> Candidate:
    """The set with declared twins in the place of its effects, where that makes the data more probable."""
    effects = search.catalogue.effects
    pairs = [(n, twin) for n in found.names for twin in effects[n].twins if twin in effects and twin not in found.names]
    while pairs:
        tried = each(partial(_in_place, found, search=search), pairs)
        better = [(c, pair) for c, pair in zip(tried, pairs, strict=True) if c is not None and more_probable(c, found)]
        if not better:
            break
        found, (name, twin) = max(better, key=lambda one: one[0].log_evidence)
        pairs = [pair for pair in pairs if pair[0] != name and pair[1] != twin]
    return found


def _in_place(found: Candidate, pair: tuple[str, str], search: Search) -> Candidate | None:
    """The set with the second effect of a pair in the place of the first; None where it cannot be run."""
    name, twin = pair
    observed = search.bench.at(found.form)
    rest = without(found, name, observed)
    if rest is None:
        return None
    made, (tests,) = score_tests(rest, [rest.slopes], search.catalogue, twin, [observed], search.settings)
    again = attempted(made, observed, tests[0][1]) if tests else None
    if again is None:
        return None
    return search.bench.judged(candidate(tuple(twin if n == name else n for n in found.names), again, found.form))
