"""An unknown of a sensor's clock: a channel that is read late, as by another logger."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.effect import Channels, Effect, Parameter
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis

Array = NDArray[np.float64]

TYPICAL = 0.03
"""Seconds by which clocks of two loggers typically differ."""


@lru_cache(maxsize=16)
def late(channel: str) -> Effect:
    """A channel that is read ``delay`` seconds late, or early where that is negative."""

    def distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
        return {**channels, channel: np.interp(times - values["delay"], times, channels[channel])}

    return Effect(
        name=f"probe_clock_of_{channel}",
        equation="sensor",
        meaning=f"an unknown delay of {channel}",
        reference="free form",
        parameters=(Parameter("delay", "s", "by which the channel is read late", TYPICAL),),
        phases=(),
        sites=(channel,),
        distort=distort,
    )


def delay_name(channel: str) -> str:
    """The parameter's name in a hypothesis."""
    return f"{late(channel).name}.delay"


def with_delay(hypothesis: Hypothesis, channel: str, delay: float) -> tuple[Hypothesis, Array]:
    """The hypothesis with a delay [s] of a channel, and its x."""
    free = Free(delay_name(channel), 0.0, TYPICAL)
    return hypothesis.with_active(late(channel).at(delay=delay), (free,)), np.array([free.place(delay)])
