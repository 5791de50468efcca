"""An unknown of the flow: one that swings at a frequency, for a while."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import pi, sin, tanh

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, switch, term
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.swinging import Swing

Array = NDArray[np.float64]

SHARE, PHASE, FREQUENCY, START, END = range(5)

EDGE = 0.1
"""Seconds in which it comes and goes."""


@term
def _swinging(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_FLOW:
        there = 0.5 * (tanh((t - p[START]) / EDGE) - tanh((t - p[END]) / EDGE))
        site[INJECTOR_FACTOR] += p[SHARE] * there * sin(2.0 * pi * p[FREQUENCY] * t + p[PHASE])


@switch
def _begins(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return t - p[START] + 2.0 * EDGE


@lru_cache(maxsize=1)
def swinging() -> Effect:
    """An injector that passes more and less by ``share``, and with it a flow that swings."""
    return Effect(
        name="probe_swing",
        equation="injector",
        meaning="a flow that swings",
        reference="free form",
        parameters=(
            Parameter("share", "-", "of the flow", 0.01),
            Parameter("phase", "-", "at the opening", 1.0),
            *(
                Parameter(name, unit, "of the swing", 1.0, center=1.0, given=True)
                for name, unit in (("frequency", "Hz"), ("start", "s"), ("end", "s"))
            ),
        ),
        phases=(),
        sites=("injector_factor",),
        term=_swinging,
        switch=_begins,
    )


SHARE_OF_SWING, PHASE_OF_SWING = "probe_swing.share", "probe_swing.phase"
"""Names of its size and phase in a hypothesis."""

SURE = 0.3
"""Standard deviation of its phase, and of its size relative to itself, as the spectrum has them."""


def with_swing(hypothesis: Hypothesis, found: Swing) -> tuple[Hypothesis, Array]:
    """The hypothesis with a flow that swings as run line and chamber showed it, and its x."""
    active = swinging().at(
        share=found.share, phase=found.phase, frequency=found.frequency, start=found.start, end=found.end
    )
    free = (
        Free(SHARE_OF_SWING, found.share, SURE * found.share),
        Free(PHASE_OF_SWING, found.phase, SURE),
    )
    return hypothesis.with_active(active, free), np.zeros(2)


def swing_at(times: Array, values: Mapping[str, float], given: Swing) -> Array:
    """What the injector passes more at ``times`` [s], as part of what it passes."""
    there = 0.5 * (np.tanh((times - given.start) / EDGE) - np.tanh((times - given.end) / EDGE))
    angle = 2.0 * np.pi * given.frequency * times + values[PHASE_OF_SWING]
    return np.asarray(values[SHARE_OF_SWING] * there * np.sin(angle))
