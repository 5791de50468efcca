"""Every effect of the library alone.

At the form of the base model every effect is fitted with all calibrated constants free, from the start at which a score
test with the constants projected out sees most of it; the same from where the base model has other valleys, for the
effect may be what bent it into its own. From there all go down together: at each finer form those that have fallen far
behind are left out, and each stays at the form at which it has most evidence.
"""

from __future__ import annotations

from functools import partial
from itertools import count

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.base_model import FAR_BEHIND
from hfanalysis.diagnose.naming.fading import fades, fades_unseen, fading_fit, unseen_fits
from hfanalysis.diagnose.naming.score import Test, score_tests
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.valleys import ELSEWHERE, with_exponent
from hfanalysis.engine.effect import Effect
from hfanalysis.inference.candidate import (
    SHORT,
    TOO_FAR_BEHIND,
    WELL_FITTED,
    Bench,
    Candidate,
    attempted,
    by_evidence,
    candidate,
    followed,
    more_probable,
)
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.form import FINEST, Form
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.recorded import TOGETHER

SEEN = 0.7
"""Gain in log probability below which a score test has seen nothing."""

MODERATE = 0.6
"""Strength (as x) from which a fit starts that a score test does not lead: a large effect is not linear."""

STARTS = 2
"""Starts of an effect's fit."""

FOLLOWED, LARGE = 3, 2.0
"""Effects, those that explain most, to whose size the constants follow first where the base model is far away, and that
size (as x): four times the typical one, as the largest of size.py."""

LOST, KEPT = 0.5, 0.5
"""Log of posterior density by which a fit that is lost is worse than its parent, and the part of what a score test
promises that a fit brings if it went where that pointed."""

LOW = -1.5
"""Where n starts besides (as x) with a strength far from nothing: the base model's n has grown to take its place."""

CHAMBER_SIDE = ("grain", "chamber_mass", "chamber_energy", "nozzle")
"""Equations whose effects a and n may be bent to."""

WORSE = 0.05
"""Log of posterior density by which a child may fit worse than its parent: fits end within as much."""


def singles_of(base: Candidate, valleys: list[Candidate], search: Search) -> list[Candidate]:
    """Every effect that is seen from the base model or its other ``valleys``, the best first."""
    bench, names = search.bench, list(search.catalogue.effects)
    started = _first_children(base, valleys, search, names)
    if _far_away(base, bench):
        started += _once_all_has_followed(started, base, search)
    best: dict[str, Candidate] = {}
    for one in _raced([*started, *_from_elsewhere(base, valleys, search, names)], bench):
        name = one.names[0]
        if name not in best or more_probable(one, best[name]):
            best[name] = one
    found = each(partial(_no_worse, parent=base, bench=bench), each(bench.converged, list(best.values())))
    return by_evidence(found)


def _no_worse(child: Candidate, parent: Candidate, bench: Bench) -> Candidate:
    """The child; one that fits worse than its parent, which it is at strength 0, is fitted anew from there."""
    if child.form != parent.form or child.fit.objective <= parent.fit.objective + WORSE:
        return child
    start = np.concatenate([parent.fit.x, np.zeros(child.fit.x.size - parent.fit.x.size)])
    again = attempted(child.fit.hypothesis, bench.at(parent.form), start)
    if again is None:
        return child
    return max(child, candidate(child.names, again, child.form), key=lambda c: c.log_evidence)


def _first_children(base: Candidate, valleys: list[Candidate], search: Search, names: list[str]) -> list[Candidate]:
    """Each of the effects with what makes the base model's data most probable, at its form.

    From the starts that score tests promise most of. Where the base model is far from the data, or leaves much open,
    those see little of an effect; what they do not lead to anything starts from a moderate size. The constants follow
    first where an effect starts far from nothing, and from where a fit of all at once is lost, or brings far less than
    was promised. The base model's other ``valleys`` tell whether fuel may have ended unseen.
    """
    observed, done = search.bench.at(base.form), count()
    fits_of_base = [c.fit for c in (base, *valleys)]
    far = _far_away(base, search.bench)

    def child(name: str) -> Candidate | None:
        search.progress(f"fitting {name}", 0.6 * next(done) / len(names))
        made, starts = _promising(base, search, name)
        fits = [attempted(made, observed, x, SHORT) for _, x in starts]
        if not seen(fits) and far:
            starts = [*starts, (0.0, _moderate(base, search.catalogue.effects[name].strengths, made.size))]
            fits.append(attempted(made, observed, starts[-1][1], SHORT))
        again = [] if seen(fits) else _led_astray(base.fit, starts, fits)
        again += _far(base, search.catalogue.effects[name], made)
        fits += [followed(made, slice(base.fit.x.size, None), observed, x) for x in again]
        if not seen(fits) and fades(search, name):
            fits.append(fading_fit(base.fit, search, name, observed))
        if fades_unseen(fits_of_base, search, name, observed):
            fits += unseen_fits(base.fit, search, name, observed)
        return _best((name,), fits, base.form)

    def seen(fits: list[Fit | None]) -> bool:
        return any(f is not None and f.log_evidence > base.fit.log_evidence + SEEN for f in fits)

    return [c for c in each(child, names) if c is not None]


def _far_away(base: Candidate, bench: Bench) -> bool:
    """Whether the base model is far from the data, or leaves much open."""
    left = bench.at(base.form).left_open(base.fit.residual)
    return base.form != FINEST or any(part > WELL_FITTED for part in left)


def _once_all_has_followed(found: list[Candidate], base: Candidate, search: Search) -> list[Candidate]:
    """The effects that explain most of a test that the base model is far from, fitted once its constants have followed
    to a large size: all at once may have gone into a valley where a small size suits what they were bent to."""
    observed, size = search.bench.at(base.form), base.fit.x.size

    def again(one: Candidate) -> Candidate | None:
        own = slice(size, size + search.catalogue.effects[one.names[0]].strengths)
        start = np.concatenate([base.fit.x, np.zeros(one.fit.x.size - size)])
        start[own] = np.copysign(LARGE, one.fit.x[own])
        return _best(one.names, [followed(one.fit.hypothesis, slice(size, None), observed, start)], base.form)

    first = by_evidence(found)[:FOLLOWED]
    seen = [c for c in first if c.log_evidence > base.log_evidence + SEEN]
    return [c for c in each(again, seen) if c is not None]


def _from_elsewhere(base: Candidate, valleys: list[Candidate], search: Search, names: list[str]) -> list[Candidate]:
    """Effects from where the base model is not: from its other valleys, and those on the chamber's side also from it
    with n held elsewhere.

    Where the base model has bent a and n to what an effect does, that effect explains little from there, and most of it
    in another valley.
    """
    observed = search.bench.at(base.form)
    bent = [
        parent
        for away in ELSEWHERE
        if (parent := with_exponent(base, away, observed)) is not None
        and parent.log_evidence > base.fit.log_evidence - FAR_BEHIND
    ]
    tried = [(name, valley.fit) for valley in valleys for name in names]
    tried += [(name, parent) for parent in bent for name in names if _on_chamber_side(search.catalogue.effects[name])]

    def child(one: tuple[str, Fit]) -> Candidate | None:
        name, parent = one
        made, (tests,) = score_tests(
            parent, [parent.slopes], search.catalogue, name, [observed], search.settings, (0.0,)
        )
        return _best((name,), [attempted(made, observed, x, SHORT) for _, x in tests[:1]], base.form)

    return [c for c in each(child, tried) if c is not None]


def _on_chamber_side(effect: Effect) -> bool:
    """Whether what an effect does is seen in chamber and thrust first."""
    return effect.equation in CHAMBER_SIDE or (effect.equation == "sensor" and bool(set(effect.sites) & set(TOGETHER)))


def _promising(parent: Candidate, search: Search, name: str) -> tuple[Hypothesis, list[Test]]:
    """The parent with an effect more, and the STARTS of which a score test sees most, if it sees anything."""
    observed = search.bench.at(parent.form)
    made, (tests,) = score_tests(parent.fit, [parent.fit.slopes], search.catalogue, name, [observed], search.settings)
    return made, [(gain, x) for gain, x in tests if gain > SEEN][:STARTS]


def _led_astray(parent: Fit, starts: list[Test], fits: list[Fit | None]) -> list[Array]:
    """Starts whose fit ends where it explains less than its parent does, or all fits far less than they promised."""
    gains = [-np.inf if f is None else parent.objective - f.objective for f in fits]
    most = max(gains, default=0.0)
    return [x for (promised, x), gain in zip(starts, gains, strict=True) if gain < -LOST or most < KEPT * promised]


def _best(names: tuple[str, ...], fits: list[Fit | None], form: Form) -> Candidate | None:
    """The most probable of the fits that could be had."""
    found = max((f for f in fits if f is not None), key=lambda f: f.log_evidence, default=None)
    return None if found is None else candidate(names, found, form)


def _moderate(base: Candidate, strengths: int, size: int) -> Array:
    """The base's constants with an effect of moderate size."""
    start = np.zeros(size)
    start[: base.fit.x.size] = base.fit.x
    start[base.fit.x.size : base.fit.x.size + strengths] = MODERATE
    return start


def _far(base: Candidate, effect: Effect, made: Hypothesis) -> list[Array]:
    """The base's constants, and those with n at LOW, with the strengths that an effect wants to be started from."""
    first, exponent, out = base.fit.x.size, [f.name for f in made.free].index("n"), []
    for strength in effect.far_starts:
        for n in (base.fit.x[exponent], LOW):
            start = np.concatenate([base.fit.x, np.zeros(made.size - base.fit.x.size)])
            start[[exponent, first]] = n, made.free[first].place(strength)
            out.append(start)
    return out


def _raced(started: list[Candidate], bench: Bench) -> list[Candidate]:
    """Each at the form with most evidence for it, going down together; who falls far behind goes no further."""
    out, running = [], started
    while running:
        least = max(c.log_evidence for c in running) - TOO_FAR_BEHIND
        finer = each(partial(_finer, bench=bench, least=least), running)
        out += [c for c, further in zip(running, finer, strict=True) if further is None]
        running = [further for further in finer if further is not None]
    least = max((c.log_evidence for c in out), default=0.0) - TOO_FAR_BEHIND
    return each(lambda c: _settled(c, bench) if bench.tempering and c.log_evidence > least else c, out)


def _settled(found: Candidate, bench: Bench) -> Candidate:
    """The candidate after a step back where going down on both sides left one of them too fine."""
    eased = bench.eased(found)
    return found if eased is None else bench.judged(eased)


def _finer(found: Candidate, bench: Bench, least: float) -> Candidate | None:
    """The candidate at the next finer form, if it is above the ``least`` evidence here and has more there."""
    if found.form == FINEST or found.log_evidence <= least:
        return None
    return bench.finer(found) if bench.tempering else bench.refitted(found, found.form.both_finer)
