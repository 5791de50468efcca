"""Model-form error: what a candidate leaves open, as large as the data ask for.

Tank and chamber are idealized in ways of their own, and a test may be well described on one side and badly on the
other: each side has its own step.
"""

from __future__ import annotations

from typing import NamedTuple

from hfanalysis.inference.observations.channel import CHAMBER_FORM, FORM_ERROR

STEPS, RATIO = 7, 3.0
"""Sizes that a model-form error may have, and the ratio of neighbors."""


class Form(NamedTuple):
    """Steps of the model-form error on the tank's side, and of chamber and thrust; 0 is the finest."""

    tank: int
    chamber: int

    @property
    def total(self) -> int:
        """Steps of both sides."""
        return self.tank + self.chamber

    @property
    def errors(self) -> tuple[float, float]:
        """Standard deviations as parts of a channel's range [-]: of the tank's channels, and of chamber and thrust."""
        return FORM_ERROR * RATIO**self.tank, CHAMBER_FORM * FORM_ERROR * RATIO**self.chamber

    @property
    def both_finer(self) -> Form:
        """One step finer on both sides, as far as there is one."""
        return Form(max(self.tank - 1, 0), max(self.chamber - 1, 0))

    @property
    def either_finer(self) -> list[Form]:
        """The forms one step finer on one side."""
        both = self.both_finer
        either = (Form(both.tank, self.chamber), Form(self.tank, both.chamber))
        return [form for form in either if form != self]

    @property
    def finer(self) -> list[list[Form]]:
        """The forms one step finer: on both sides, and if none of these will do, on either."""
        both = self.both_finer
        return [] if both == self else [[both], [form for form in self.either_finer if form != both]]

    def coarser(self, tank: bool, chamber: bool) -> Form:
        """One step coarser on these sides, as far as there is one."""
        return Form(min(self.tank + tank, STEPS - 1), min(self.chamber + chamber, STEPS - 1))

    @property
    def coarser_ones(self) -> list[Form]:
        """The forms one step coarser on either side, and on both, as far as there are any."""
        forms = [self.coarser(*sides) for sides in ((True, False), (False, True), (True, True))]
        return [form for form in dict.fromkeys(forms) if form != self]


FINEST, COARSEST = Form(0, 0), Form(STEPS - 1, STEPS - 1)
"""The least and the largest model-form error on either side. Evidence: that fits begin at the coarsest was changed
after a practice case was wrong (docs/diagnosis.md)."""
