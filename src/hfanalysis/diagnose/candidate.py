"""A candidate explanation: a set of effects, or an unknown source, with its fit at the model-form error it asks for.

What no candidate explains is model-form error; how large it is, is part of the question. Each candidate is judged at
the size that makes the data most probable, at a price per step: an explanation that leaves much open is tempered by it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fit import Fit, fit
from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.observed import FORM_ERROR, Observed

Array = NDArray[np.float64]

FORMS = tuple(FORM_ERROR * 3.0**i for i in range(6))
"""Model-form errors that a candidate may ask for, as parts of a channel's range."""

PRICE = 10.0
"""Log of the odds against each of them. Right explanations of simulated tests hardly ever ask for one: `make
blind-calibrate` prints how many (95 of 97 asked for none: odds of 48 to 1, or 12 at a temperature of 3.12)."""

FURTHER = 5.0
"""Log of the odds against each effect beyond the first: several at once are rarer than one."""

SHORT, LONG = 12, 25
"""Steps of a fit that looks around, and of one that is to converge."""


@dataclass(frozen=True)
class Candidate:
    """A set of ``names``, the fit, and its log evidence; ``steps`` of FORMS that it asks for."""

    names: tuple[str, ...]
    fit: Fit
    log_evidence: float
    steps: int = 0
    unknown: bool = False

    @property
    def chi2(self) -> float:
        """What is left, in squared standard deviations."""
        return float(self.fit.residual @ self.fit.residual)

    @property
    def leftover(self) -> float:
        """The same per observation."""
        return self.chi2 / self.fit.residual.size


class Bench:
    """The data at every model-form error, each made once."""

    def __init__(self, observed: Observed, tempering: bool = True) -> None:
        self.observed = observed
        self.tempering = tempering
        self._at: dict[int, Observed] = {0: observed}

    def at(self, steps: int) -> Observed:
        """The data at a step of FORMS."""
        if steps not in self._at:
            self._at[steps] = self.observed.at_form(FORMS[steps])
        return self._at[steps]

    @property
    def coarsest(self) -> int:
        """The last step."""
        return len(FORMS) - 1

    def judged(self, found: Candidate) -> Candidate:
        """A candidate at the form that makes the data most probable: finer as long as that helps, or else coarser.

        Without tempering it is the finest one, whatever that leaves.
        """
        if not self.tempering:
            return self.refitted(found, 0) or found
        best = found
        while best.steps > 0 and (again := self.refitted(best, best.steps - 1)) and more_probable(again, best):
            best = again
        if best.steps < found.steps:
            return best
        while (
            best.leftover > CALM
            and best.steps < self.coarsest
            and (again := self.refitted(best, best.steps + 1))
            and more_probable(again, best)
        ):
            best = again
        return best

    def refitted(self, found: Candidate, steps: int) -> Candidate | None:
        """The candidate at another form, None where it cannot be run."""
        again = attempted(found.fit.hypothesis, self.at(steps), found.fit.x, SHORT)
        return None if again is None else candidate(found.names, again, steps, found.unknown)

    def converged(self, found: Candidate) -> Candidate:
        """The candidate, its fit brought to its end."""
        if found.fit.converged:
            return found
        again = attempted(found.fit.hypothesis, self.at(found.steps), found.fit.x, LONG)
        better = None if again is None else candidate(found.names, again, found.steps, found.unknown)
        return better if better is not None and more_probable(better, found) else found


def candidate(names: tuple[str, ...], found: Fit, steps: int, unknown: bool = False) -> Candidate:
    """A fit at a form as a candidate, at the price of the form and of effects beyond the first."""
    further = max(len(names) - unknown - 1, 0)
    return Candidate(names, found, found.log_evidence - PRICE * steps - FURTHER * further, steps, unknown)


def more_probable(one: Candidate, other: Candidate) -> bool:
    """Whether one candidate has more evidence than another."""
    return one.log_evidence > other.log_evidence


CALM = 1.15
"""Chi-square per observation below which no larger model-form error is asked for."""


def attempted(hypothesis: Hypothesis, observed: Observed, start: Array, most: int = LONG) -> Fit | None:
    """A fit, or None where its start cannot be run."""
    try:
        return fit(hypothesis, observed, start, most)
    except (ValueError, ArithmeticError):
        return None
