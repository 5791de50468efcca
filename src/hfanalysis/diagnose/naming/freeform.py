"""Unknown: a free-form source at a site of the model, or in a sensor, that competes with the names."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.dropping import dropped
from hfanalysis.diagnose.naming.plain import plain_sources
from hfanalysis.inference.candidate import (
    SHORT,
    TOO_FAR_BEHIND,
    Bench,
    Candidate,
    attempted,
    by_evidence,
    candidate,
)
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.form import FINEST
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import LinearUnknown
from hfanalysis.inference.unknowns import in_slopes

REFITTED = 3
"""Sites whose source is fitted with the full model, by their linear evidence."""

ALIKE = 5.0, 0.2
"""Linear evidence behind the best kind of source at a site from which on the other is not fitted, and the same as part
of the best: an edge that the linear search blurs has more than it seems."""

LEAST = 4.0
"""Log evidence, linear, from which on a source is fitted."""

BESIDE = 6.0
"""Log of the odds against an unknown source beside a named effect: what a closure gets wrong looks like one."""

BEYOND = 100.0
"""Log evidence behind the names, at one form, from which on the best source is not fitted at any other."""

REST = 0.5
"""Part of what the best names explain that a source beside them must add for the answer to be unknown."""

NEAR = 0.3
"""Part of that which the likeliest source beside the names must add for others to be tried."""

STRIDES = (1.0, 0.5, 0.2)
"""Parts of the way to the linear estimate from which a full fit may start: a large source is not linear."""


def unknown_instead(base: Candidate, valleys: list[Candidate], named: Candidate, bench: Bench) -> list[Candidate]:
    """Sources instead of any name, from the base model or its other ``valleys``, where they are worth it; the best
    first."""
    sides = [partial(side, base, named, bench) for side in (_instead, _at_finest, plain_sources)]
    sides += [partial(_instead, valley, named, bench) for valley in valleys]
    instead, at_finest, *others = each(lambda side: side(), sides)
    done = {c.names for c in instead if c.form == FINEST}
    found = [*instead, *(c for c in at_finest if c.names not in done), *(c for side in others for c in side)]
    return by_evidence(_priced(c) for c in found)


def unknown_beside(base: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """Sources beside what is named, where that is anything; the best first."""
    if not named.names:
        return []
    sides = [partial(_beside, base, named, bench), partial(plain_sources, named, named, bench)]
    return by_evidence(_priced(c) for side in each(lambda side: side(), sides) for c in side)


def _instead(base: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """Sources instead of any name."""
    start, sources = _worth_it(base, bench)
    return _fitted(start, sources, bench, named)


def _beside(base: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """Sources beside the best name.

    The likeliest shows what is left. Where it comes near to being the answer, all are tried at the form that they ask
    for, and names that the best of them can do without are left out.
    """
    start, sources = _worth_it(named, bench)
    needed = REST * (named.log_evidence - base.log_evidence)
    found = [c for source in sources[:1] if (c := with_fitted(start, source, bench)) is not None]
    if any(_priced(c).log_evidence - named.log_evidence > NEAR * needed for c in found):
        found = _fitted(start, sources, bench)
        best = max(found, key=lambda c: c.log_evidence)
        found += [less for less in [dropped(best, bench)] if less is not best]
    return found


def _priced(found: Candidate) -> Candidate:
    """A candidate at the price of its source's kind."""
    beside = BESIDE if len(found.names) > 1 else 0.0
    own = found.source.price if found.source is not None else 0.0
    return replace(found, log_evidence=found.log_evidence - beside - own)


def _worth_it(parent: Candidate, bench: Bench) -> tuple[Candidate, list[LinearUnknown]]:
    """The few sources that are seen at the parent's form, or else at the next finer one, to which it does not fit, and
    the parent there: what is too weak for a coarse form may be plain at a finer one."""
    sources = _seen(parent, bench)
    if not sources and parent.form != FINEST and (finer := bench.refitted(parent, parent.form.both_finer)):
        parent, sources = finer, _seen(finer, bench)
    return parent, _few(sources)


def _at_finest(base: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """The likeliest source at the finest form, where the base model asks for a coarser one.

    A model-form error in chamber and thrust takes up what only one of them shows: at a form that lets the base model
    fit, such a source is not seen.
    """
    if base.form == FINEST or (finest := bench.refitted(base, FINEST)) is None:
        return []
    return _fitted(finest, _seen(finest, bench)[:1], bench, named)


def _few(sources: list[LinearUnknown]) -> list[LinearUnknown]:
    """Of the best few sites, the best kind of source and what is nearly as good, the best first."""
    sites = list(dict.fromkeys(s.place.name for s in sources))[:REFITTED]
    best = {name: max(s.log_evidence for s in sources if s.place.name == name) for name in sites}
    least = {name: evidence - max(ALIKE[0], ALIKE[1] * evidence) for name, evidence in best.items()}
    return [s for s in sources if s.place.name in best and s.log_evidence > least[s.place.name]]


def _fitted(
    start: Candidate, sources: list[LinearUnknown], bench: Bench, named: Candidate | None = None
) -> list[Candidate]:
    """The parent with each of these sources, at the form that it asks for.

    Those far behind the best of them, or behind what is ``named`` at the same form, stay at the form of the parent;
    the best goes on unless it is out of the question.
    """
    tried = each(lambda source: with_fitted(start, source, bench), sources)
    found = by_evidence(c for c in tried if c is not None)
    if not found:
        return []
    rival = found[0].log_evidence
    if named is not None and named.names:
        same = named if named.form == start.form else bench.refitted(named, start.form)
        rival = max(rival, same.log_evidence if same else -np.inf)
    racing = [c for c in found if c.log_evidence > rival - TOO_FAR_BEHIND]
    if not racing and found[0].log_evidence > rival - BEYOND:
        racing = found[:1]
    return [*each(bench.judged, racing), *found[len(racing) :]]


def _seen(parent: Candidate, bench: Bench) -> list[LinearUnknown]:
    """Sources that the linear search sees, the best first; none where the engine cannot be run with all sites open."""
    try:
        sources = in_slopes(parent.fit, bench.at(parent.form))
    except (ValueError, ArithmeticError):
        return []
    return [source for source in sources if source.log_evidence >= LEAST]


def with_fitted(parent: Candidate, source: LinearUnknown, bench: Bench) -> Candidate | None:
    """The parent with a source more, fitted with the full model at the parent's form."""
    made, _ = source.added_to(parent.fit)
    start = _nearest(made, bench.at(parent.form), [_towards(parent.fit, source, share) for share in STRIDES])
    if start is None:
        return None
    found = attempted(made, bench.at(parent.form), start, SHORT)
    return None if found is None else candidate((*parent.names, source.place.name), found, parent.form, source)


def _towards(fitted: Fit, source: LinearUnknown, share: float) -> Array:
    """A share of the way from a fit to where the linear search sees its constants and a source beside them."""
    return np.concatenate([fitted.x + share * (source.nuisances - fitted.x), source.added_to(fitted, share)[1]])


def _nearest(hypothesis: Hypothesis, observed: Observed, starts: list[Array]) -> Array | None:
    best: tuple[float, Array] | None = None
    for x in starts:
        try:
            there = predict(hypothesis, observed, x, tangents=False)
        except (ValueError, ArithmeticError):
            continue
        value = float(there.residual @ there.residual + x @ x)
        if np.isfinite(value) and (best is None or value < best[0]):
            best = (value, x)
    return None if best is None else best[1]
