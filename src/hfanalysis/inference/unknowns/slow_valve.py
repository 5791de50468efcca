"""An unknown of the valve: one that takes its time to open, where the model's opens at once."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, FEED_FACTOR, switch, term
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.valve_opening import SlowOpening

Array = NDArray[np.float64]

SECONDS = 0

JAR = 0.03
"""Part of its way that a valve is open at least: flow and pressure need a beginning."""

SURE = 0.3
"""Standard deviation of the log of the seconds: where the rise begins and ends is a matter of definition."""


@term
def _opening(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    """The loss of a valve whose free area grows in proportion to time, and is all of the line's when it is open."""
    if hook == AT_FLOW and t < p[SECONDS]:
        share = max(t / p[SECONDS], JAR)
        site[FEED_FACTOR] += 1.0 / (share * share) - 1.0


@switch
def _open(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return t - p[SECONDS]


@lru_cache(maxsize=1)
def slow_valve() -> Effect:
    """A valve that is open after ``seconds``."""
    return Effect(
        name="probe_valve",
        equation="feed",
        meaning="a valve that opens slowly",
        reference="free form",
        parameters=(Parameter("seconds", "s", "until it is open", 0.1, center=0.1),),
        phases=(),
        sites=("feed_factor",),
        term=_opening,
        switch=_open,
    )


SECONDS_OF_VALVE = "probe_valve.seconds"
"""The parameter's name in a hypothesis."""


def loss_share(times: Array, seconds: float) -> Array:
    """Part of the feed's loss that is the valve's at each of ``times`` [s]."""
    return np.asarray(1.0 - np.clip(times / seconds, JAR, 1.0) ** 2)


def with_valve(hypothesis: Hypothesis, found: SlowOpening) -> tuple[Hypothesis, Array]:
    """The hypothesis with a valve that opens as the run line's pressure came up, and its x."""
    free = Free(SECONDS_OF_VALVE, found.seconds, SURE, "positive")
    return hypothesis.with_active(slow_valve().at(seconds=found.seconds), (free,)), np.zeros(1)
