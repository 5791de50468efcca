"""The base model: the report's, with the constants that suit a test best, and the other valleys that it has.

It comes down from the coarsest model-form error as long as that makes the data more probable. Where no instant tells
when the fuel is gone a and n have more than one valley; coarse forms do not tell them apart, so the fit is made again
from other exponents. The deepest is the base model. The others are kept: what a hidden effect does may have bent a and
n into a valley from which that effect explains little, while it explains most from another.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.candidate import Bench, Candidate, by_evidence, candidate, followed
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.threads import each

FROM_EXPONENTS = (0.0, -1.5, 1.5)
"""Where the base model's fit starts in n besides, in standard deviations of its prior, once all else has followed.
Evidence: calibration case C020131 (two-phase flow) had 6 in log evidence for the true name from the deepest valley of a
and n, and is named with 0.97 from the other."""

NEARLY = 3.0
"""Log evidence behind the best valley, after a short fit, up to which another may yet turn out deeper."""

FAR_BEHIND = 300.0
"""Log evidence behind the base model from which on it is not looked there: not even an effect leads back. Evidence: 100
was too near, for n follows what a loss of thrust does."""

SAME = 0.1
"""Standard deviations of a prior within which two fits are one."""


def base_model(hypothesis: Hypothesis, bench: Bench) -> tuple[Candidate, list[Candidate]]:
    """The base model at the form that suits it, and its other valleys at that form, the best first.

    Raises ArithmeticError where it cannot be run.
    """
    best = bench.settled(hypothesis)
    if best is None:
        raise ArithmeticError("the base model cannot be fitted to this test")
    place, first, seen = [f.name for f in hypothesis.free].index("n"), best, [best]
    for exponent in FROM_EXPONENTS:
        start = first.fit.x.copy()
        start[place] = exponent
        other = followed(hypothesis, slice(place, place + 1), bench.at(first.form), start)
        if other is None or in_one_valley(other.x, first.fit.x):
            continue
        found = candidate((), other, first.form)
        if found.log_evidence > first.log_evidence - NEARLY:
            found = bench.told(bench.judged(found))
        seen.append(found)
        best = max(best, found, key=lambda c: c.log_evidence)
    return best, _elsewhere(best, seen, bench)


def _elsewhere(base: Candidate, seen: list[Candidate], bench: Bench) -> list[Candidate]:
    """Those of the fits that are in another valley than the base model, brought to their end at its form, each once."""
    ended = each(lambda c: _ended(c, base, bench), [c for c in seen if c is not base])
    valleys: list[Candidate] = []
    for one in by_evidence(c for c in ended if c is not None):
        far = one.log_evidence < base.log_evidence - FAR_BEHIND
        if not far and not any(in_one_valley(one.fit.x, c.fit.x) for c in (base, *valleys)):
            valleys.append(one)
    return valleys


def _ended(found: Candidate, base: Candidate, bench: Bench) -> Candidate | None:
    """A fit at the base model's form, gone on with to its end; None where it cannot be run there."""
    there = found if found.form == base.form else bench.refitted(found, base.form)
    return None if there is None else bench.converged(there)


def in_one_valley(one: Array, other: Array) -> bool:
    """Whether two fits whose constants are these (parameters,), in prior standard deviations, are in the same valley.

    Where the kink of a law runs through a valley (soot appears in the products, say), two fits of it end on either side
    and differ in their slopes, and so in their evidence, though not in what they fit."""
    return bool(np.abs(one - other).max() < SAME)
