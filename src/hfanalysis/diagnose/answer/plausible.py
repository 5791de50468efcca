"""Whether an effect of the size that was found can be on a stand, and how large that is in words.

What can be is said by the effect itself (:class:`hfanalysis.engine.effect.Believable`). It is no limit of a prior: it
is what a careful engineer would believe before asking what else it could be. A size beyond it lowers the probability
of the name. Where an effect's strength and what it does are of one unit, the most that it did is judged.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log

import numpy as np

from hfanalysis.diagnose.answer.effect_source import acting, acting_in, unit_of_source
from hfanalysis.engine.effect import Active, Believable
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.products.diagnosis import Plausibility
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.sentences import capitalised, text

STEEPNESS = 3.0
"""Log of the odds lost per squared e-fold beyond the limit."""

MOST_LOST = 15.0
"""Log of the odds that a size loses at most."""

IMPOSSIBLE = 6.0
"""Log of the odds that a size loses that cannot be, by its sign."""


@dataclass(frozen=True)
class Size:
    """How large an effect is [SI], ``of`` which of its parameters, and what can be believed.

    ``acts``: whether it is the most that the effect does over the time that is compared, where that is of the
    strength's unit, and not the strength: a drift that takes a minute to come is not there after ten seconds.
    """

    of: str
    value: float
    limit: Believable
    acts: bool = False

    @property
    def excess(self) -> float:
        """The size over the largest believable one [-]."""
        return abs(self.value) / self.limit.most

    @property
    def impossible(self) -> bool:
        """Whether it is of a sign that it cannot have."""
        return self.value < self.limit.least

    @property
    def lost(self) -> float:
        """Log of the odds that an effect loses by its size [natural log]."""
        by_size = 0.0 if self.excess <= 1.0 else min(STEEPNESS * log(self.excess) ** 2 + 1.0, MOST_LOST)
        return max(by_size, IMPOSSIBLE) if self.impossible else by_size

    @property
    def kept(self) -> float:
        """Part [-] of its probability that a name keeps by its size: all that can be believed, less beyond as the
        square of how far; next to nothing where it is impossible."""
        return exp(-IMPOSSIBLE) if self.impossible else 1.0 / max(self.excess, 1.0) ** 2


def size_of(active: Active) -> Size | None:
    """The size of an effect by its strength, of several of one kind the largest; None where nothing is known of how
    large it can be."""
    limit = active.effect.believable
    if limit is None:
        return None
    chosen = limit.parameter
    if active.effect.strengths > 1:
        chosen = max(active.strengths, key=lambda name: abs(active.strengths[name]))
    return Size(chosen, active.strengths[chosen], limit)


def sized(found: Fit, name: str, observed: Observed) -> Size | None:
    """The size of an effect of a fit, by what it did where that is of its strength's unit; None where it is not in the
    fit, or nothing is known of how large it can be."""
    active = acting_in(found).get(name)
    size = None if active is None else size_of(active)
    if active is None or size is None or active.effect.strengths > 1:
        return size
    strength = next(p for p in active.effect.parameters if p.name == size.of)
    if strength.unit != unit_of_source(active.effect):
        return size
    most = float(np.abs(acting(found, name, observed).mean).max())
    return replace(size, value=float(np.copysign(most, size.value)), acts=True)


def judged(size: Size | None) -> Plausibility:
    """How large an effect is, whether that is possible, and why."""
    if size is None:
        return Plausibility(size=None, plausible=None, why="nothing is known of how large this effect can be")
    limit, chosen = size.limit, size.of
    there, most = limit.text(size.value), limit.text(limit.most)
    if size.impossible:
        why = text("{chosen} of {size} cannot be: {why}", chosen=chosen, size=there, why=limit.least_why)
        return Plausibility(size=there, plausible=False, why=why)
    possible = size.excess <= 1.0
    judgment = "{chosen} {size}{at} (limit {most})" if possible else "{chosen} {size}{at} is beyond {most}. {why}"
    why = text(
        judgment,
        chosen=LONG_NAMES.get(chosen, chosen.replace("_", " ")),
        size=there,
        at=" at its largest" if size.acts else "",
        most=most,
        why=capitalised(limit.why),
    )
    return Plausibility(size=there, plausible=possible, why=why)
