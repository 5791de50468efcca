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

PRICE = 5.0
"""Log of the odds against each of them: models of this kind are usually right to the first."""

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
        self.floor = 0

    def at(self, steps: int) -> Observed:
        """The data at a step of FORMS."""
        if steps not in self._at:
            self._at[steps] = self.observed.at_form(FORMS[steps])
        return self._at[steps]

    @property
    def fine(self) -> Observed:
        """The data at the finest form that any candidate can be expected to meet."""
        return self.at(self.floor)

    def settle(self, best: Fit) -> None:
        """Find that form: down from the coarsest, as long as the best coarse fit can follow."""
        found = best
        for steps in range(self.coarsest - 1, -1, -1):
            again = attempted(found.hypothesis, self.at(steps), found.x, SHORT)
            if again is None or again.residual @ again.residual > HOPELESSLY * again.residual.size:
                self.floor = steps + 1
                return
            found = again
        self.floor = 0

    @property
    def coarsest(self) -> int:
        """The last step."""
        return len(FORMS) - 1

    def judged(self, names: tuple[str, ...], found: Fit, unknown: bool = False) -> Candidate:
        """A fit at the finest form, refitted at the one that makes the data most probable."""
        best = Candidate(names, found, found.log_evidence - PRICE * self.floor, self.floor, unknown)
        if not self.tempering or best.leftover < CALM:
            return best
        for steps in range(self.floor + 1, len(FORMS)):
            again = attempted(best.fit.hypothesis, self.at(steps), best.fit.x, SHORT)
            if again is None or again.log_evidence - PRICE * steps <= best.log_evidence:
                break
            best = Candidate(names, again, again.log_evidence - PRICE * steps, steps, unknown)
        return best


HOPELESSLY = 6.0
"""Chi-square per observation from which on the best explanation does not follow the data to a form at all."""

CALM = 1.15
"""Chi-square per observation below which no larger model-form error is asked for."""


def attempted(hypothesis: Hypothesis, observed: Observed, start: Array, most: int = LONG) -> Fit | None:
    """A fit, or None where its start cannot be run."""
    try:
        return fit(hypothesis, observed, start, most)
    except (ValueError, ArithmeticError):
        return None
