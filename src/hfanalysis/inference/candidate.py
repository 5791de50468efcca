"""A candidate explanation: a set of effects, or an unknown source, with its fit at the model-form error it asks for.

What no candidate explains is model-form error; how large it is, is part of the question. Each candidate is judged at
the size that makes the data most probable, at a price per step: an explanation that leaves much open is tempered by it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.departures import with_its_laws
from hfanalysis.inference.fitting.fit import ENDED, Fit, brought_to_end, fit, fit_on, promised
from hfanalysis.inference.fitting.form import COARSEST, FINEST, Form
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import History, Unknown

FIRST_STEP, STEP = 1.0, 5.0
"""Log of the odds against the first step of the model-form error, on either side, and against each further one. The
finest suits a generator whose gas is as ideal as the model's; a step coarser is as good a guess for a stand. How many
right explanations of simulated tests ask for more `make blind-calibrate` prints. Evidence: with the finest form a third
as large and no step nearly free, a practice case without an effect was called unknown for 0.03 bar."""

FURTHER = 5.0
"""Log of the odds against each effect beyond the first [natural log]: several at once are rarer than one."""

TOO_FAR_BEHIND = 30.0
"""Log evidence [natural log] behind the best at the same form from which on a candidate is not fitted any finer."""

DOUBT = 10.0
"""Log evidence that a form may promise to lose, by the slopes of a fit that has converged, and still be tried, for
nothing is linear. Evidence: in HF5 and five tests of the development set of docs/worlds.md 407 forms had promised to
lose more than 5, and none of them gained anything; the one that came nearest lost 2.9."""

SHORT, LONG, LONGEST = 12, 25, 60
"""Steps of a fit that looks around, of one that is to converge, and of one whose numbers are told: a valley may be long
and bent."""


@dataclass(frozen=True)
class Candidate:
    """A set of ``names``, the fit, and its log evidence; the ``form`` that it asks for.

    ``source``: the unknown that it has, if any, whose place is the last of the names. ``others``: fits in its other
    valleys, where they were looked for, each with its probability beside this one's [-].
    """

    names: tuple[str, ...]
    fit: Fit
    log_evidence: float
    form: Form = FINEST
    source: Unknown | None = None
    others: tuple[tuple[Fit, float], ...] = ()

    @property
    def unknown(self) -> bool:
        """Whether there is something in it that has no name."""
        return self.source is not None

    @property
    def key(self) -> tuple[str, ...]:
        """What it is known by among others: its names, those of a source last, with its kind."""
        return self.names if self.source is None else (*self.names, type(self.source).__name__)

    def history(self, observed: Observed) -> History:
        """Its source over time [s], in the unit of its place."""
        assert self.source is not None
        return self.source.history(self.fit, observed)

    @property
    def chi2(self) -> float:
        """What is left: the sum of the squares of the whitened residual [-]."""
        return float(self.fit.residual @ self.fit.residual)

    @property
    def leftover(self) -> float:
        """The same per observation [-]."""
        return self.chi2 / self.fit.residual.size


class Bench:
    """The data at every model-form error, each made once."""

    def __init__(self, observed: Observed, tempering: bool = True) -> None:
        self.observed = observed
        self.tempering = tempering
        self._at: dict[Form, Observed] = {FINEST: observed}

    def at(self, form: Form) -> Observed:
        """The data at a form."""
        if form not in self._at:
            self._at[form] = self.observed.with_errors(*form.errors)
        return self._at[form]

    def settled(self, hypothesis: Hypothesis) -> Candidate | None:
        """A model at the form that suits it, from the coarsest on: a fine one at once is lost where it starts far away.

        None where it cannot be run.
        """
        coarse = self.compared(hypothesis)
        return None if coarse is None else self.told(coarse)

    def compared(self, hypothesis: Hypothesis) -> Candidate | None:
        """As :meth:`settled`, to be compared with others: its numbers are not told."""
        coarse = attempted(hypothesis, self.at(COARSEST), np.zeros(hypothesis.size), SHORT)
        return None if coarse is None else self.converged(self.judged(candidate((), coarse, COARSEST)))

    def judged(self, found: Candidate) -> Candidate:
        """A candidate at the form that makes the data most probable: finer or coarser as long as that helps.

        Without tempering it is the finest one, whatever that leaves.
        """
        if not self.tempering:
            return self.refitted(found, FINEST) or found
        best = found
        while (better := self._better(best)) is not None:
            best = better
        return best

    def _better(self, found: Candidate) -> Candidate | None:
        """As :meth:`finer`, or else as :meth:`eased`; what may all be needed is fitted side by side."""
        if not found.form.finer:
            return self.eased(found)
        both, either = found.form.finer
        if (finer := self._best_of(found, self._refitted(found, both))) is not None:
            return finer
        coarser = self._coarser(found)
        tried = self._refitted(found, [*either, *coarser])
        finer = self._best_of(found, tried[: len(either)])
        return finer if finer is not None else self._best_of(found, tried[len(either) :])

    def finer(self, found: Candidate) -> Candidate | None:
        """The candidate one step finer, on both sides or else on one; None where it has no more evidence."""
        for forms in found.form.finer:
            if (better := self._best_of(found, self._refitted(found, forms))) is not None:
                return better
        return None

    def eased(self, found: Candidate) -> Candidate | None:
        """The candidate one step coarser where that may bring something; None where it has no more evidence."""
        return self._best_of(found, self._refitted(found, self._coarser(found)))

    def _coarser(self, found: Candidate) -> list[Form]:
        """The form one step coarser where a candidate leaves much open, and those that promise more by the slopes of
        its fit: which form it comes to must not hang on whether it was reached from a coarser or from a finer one."""
        left = self.at(found.form).left_open(found.fit.residual)
        wanted = [found.form.coarser(*(chi2 > WELL_FITTED for chi2 in left))]
        if found.fit.converged:
            wanted += [form for form in found.form.coarser_ones if self._promised(found, form) > 0.0]
        return [form for form in dict.fromkeys(wanted) if form != found.form]

    def _refitted(self, found: Candidate, forms: Sequence[Form]) -> list[Candidate | None]:
        """At forms of which something may be hoped for; None for the others."""
        hopeful = [form for form in forms if not found.fit.converged or self._promised(found, form) > -DOUBT]
        made = dict(zip(hopeful, each(partial(self._fairly_refitted, found), hopeful), strict=True))
        return [made.get(form) for form in forms]

    def _promised(self, found: Candidate, form: Form) -> float:
        """What another form gains in log evidence where the slopes of the fit hold: no run is needed to see that."""
        evidence = promised(found.fit, self.at(found.form), self.at(form))
        return evidence - found.fit.log_evidence - price(form) + price(found.form)

    @staticmethod
    def _best_of(found: Candidate, tried: Sequence[Candidate | None]) -> Candidate | None:
        """The best of those that are more probable than the candidate."""
        better = [c for c in tried if c is not None and more_probable(c, found)]
        return max(better, key=lambda c: c.log_evidence, default=None)

    def refitted(self, found: Candidate, form: Form) -> Candidate | None:
        """The candidate at another form, None where it cannot be run."""
        again = self._gone_on(found, form, SHORT)
        return None if again is None else candidate(found.names, again, form, found.source)

    def _fairly_refitted(self, found: Candidate, form: Form) -> Candidate | None:
        """As :meth:`refitted`, gone on with where it was stopped on its way and promises more than the candidate has:
        which form is taken must not hang on where a fit happens to stand after so many steps."""
        again = self.refitted(found, form)
        if again is None or more_probable(again, found) or self.reach(again) <= found.log_evidence:
            return again
        return self.converged(again)

    def converged(self, found: Candidate, most: int = LONGEST) -> Candidate:
        """The candidate, its fit gone on with until it has converged, or as far as at ``most`` so many steps lead."""
        again = None if found.fit.converged else self._gone_on(found, found.form, most)
        return found if again is None else _with_fit(found, again)

    def told(self, found: Candidate) -> Candidate:
        """A candidate whose numbers are told, its fit brought to its end: stopped on its way they are no answer."""
        near = self.converged(found)
        if near.fit.within <= ENDED or not near.fit.converged:
            return near
        try:
            return _with_fit(near, brought_to_end(near.fit, self.at(near.form)))
        except (ValueError, ArithmeticError):
            return near

    def by_its_laws(self, found: Candidate) -> Candidate:
        """A candidate whose numbers are told; where its laws depart so far that what they add is not linear, fitted by
        an engine of these laws, at the form that suits it then."""
        observed = self.at(found.form)
        made = with_its_laws(found.fit, observed)
        again = None if made is None else attempted(made, observed, found.fit.x, LONGEST)
        return found if again is None else self.told(self.judged(_with_fit(found, again)))

    def reach(self, found: Candidate) -> float:
        """The log evidence that a candidate has at its form, or would have if the slopes where it is now hold."""
        if found.fit.converged:
            return found.log_evidence
        observed = self.at(found.form)
        return found.log_evidence + max(promised(found.fit, observed, observed) - found.fit.log_evidence, 0.0)

    def _gone_on(self, found: Candidate, form: Form, most: int) -> Fit | None:
        """The candidate's fit, gone on with at a form; None where that cannot be run."""
        try:
            return fit_on(found.fit, self.at(found.form), self.at(form), most)
        except (ValueError, ArithmeticError):
            return None


def price(form: Form) -> float:
    """Log of the odds against a form [natural log]."""
    return sum(FIRST_STEP * min(steps, 1) + STEP * max(steps - 1, 0) for steps in form)


def candidate(names: tuple[str, ...], found: Fit, form: Form, source: Unknown | None = None) -> Candidate:
    """A fit at a form as a candidate, at the price of the form and of effects beyond the first."""
    further = max(len(names) - (source is not None) - 1, 0)
    return Candidate(names, found, found.log_evidence - price(form) - FURTHER * further, form, source)


def _with_fit(found: Candidate, fit: Fit) -> Candidate:
    """The candidate with another fit at its form; what its evidence holds besides stays."""
    return replace(found, fit=fit, log_evidence=found.log_evidence + fit.log_evidence - found.fit.log_evidence)


def more_probable(one: Candidate, other: Candidate) -> bool:
    """Whether one candidate has more evidence than another."""
    return one.log_evidence > other.log_evidence


def by_evidence(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Candidates, the best first."""
    return sorted(candidates, key=lambda c: -c.log_evidence)


WELL_FITTED = 1.15
"""Chi-square per observation, on a side, from which on a larger model-form error is tried whatever it promises."""


def attempted(hypothesis: Hypothesis, observed: Observed, start: Array, most: int = LONG) -> Fit | None:
    """A fit from ``start`` (parameters,), in prior standard deviations, in at ``most`` so many steps; None where it
    cannot be run there."""
    try:
        return fit(hypothesis, observed, start, most)
    except (ValueError, ArithmeticError):
        return None


def followed(made: Hypothesis, own: slice, observed: Observed, start: Array) -> Fit | None:
    """A fit in which the constants follow to an effect of a given size before its ``own`` parameters are free.

    ``start`` (parameters,) in prior standard deviations. Far from what suits them the constants would take the effect
    along on their way. None where it cannot be run.
    """
    near = attempted(held(made, own, start), observed, start, SHORT)
    return None if near is None else attempted(made, observed, near.x, SHORT)


def held(hypothesis: Hypothesis, places: slice, x: Array) -> Hypothesis:
    """The same with some of its free parameters held where they are: at ``x`` (parameters,), in prior standard
    deviations."""
    free = list(hypothesis.free)
    free[places] = [replace(f, least=at, most=at) for f, at in zip(free[places], x[places].tolist(), strict=True)]
    return replace(hypothesis, free=tuple(free))
