"""Whether an effect of the size that was found can be on a stand, and how large that is in words.

What can be is said by the effect itself (:class:`hfanalysis.engine.effect.Believable`). It is no limit of a prior: it
is what a careful engineer would believe before asking what else it could be. A size beyond it lowers the probability
of the name.
"""

from __future__ import annotations

from math import log

from hfanalysis.engine.effect import Active
from hfanalysis.products.diagnosis import Plausibility
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.sentences import capitalised, text

STEEPNESS = 3.0
"""Log of the odds lost per squared e-fold beyond the limit."""

MOST_LOST = 15.0
"""Log of the odds that a size loses at most."""


def _parameter(active: Active) -> str:
    """The strength that is judged: of several of one kind the largest."""
    assert active.effect.believable is not None
    if active.effect.strengths == 1:
        return active.effect.believable.parameter
    return max(active.strengths, key=lambda name: abs(active.strengths[name]))


def excess(active: Active) -> float:
    """The size of an effect over the largest believable one [-]; 0 where nothing is known of it."""
    limit = active.effect.believable
    return 0.0 if limit is None else abs(active.strengths[_parameter(active)]) / limit.most


def lost(active: Active) -> float:
    """Log of the odds that an effect loses by its size [natural log]."""
    beyond = excess(active)
    return 0.0 if beyond <= 1.0 else min(STEEPNESS * log(beyond) ** 2 + 1.0, MOST_LOST)


def judged(active: Active) -> Plausibility:
    """How large the effect is, whether that is possible, and why."""
    limit = active.effect.believable
    if limit is None:
        return Plausibility(size=None, plausible=None, why="nothing is known of how large this effect can be")
    chosen = _parameter(active)
    size, most = limit.text(active.strengths[chosen]), limit.text(limit.most)
    possible = excess(active) <= 1.0
    judgment = "{chosen} {size} (limit {most})" if possible else "{chosen} {size} is beyond {most}. {why}"
    why = text(
        judgment,
        chosen=LONG_NAMES.get(chosen, chosen.replace("_", " ")),
        size=size,
        most=most,
        why=capitalised(limit.why),
    )
    return Plausibility(size=size, plausible=possible, why=why)
