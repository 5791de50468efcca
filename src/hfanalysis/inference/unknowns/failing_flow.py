"""An unknown of the flow: one that fails before the liquid is gone, as gas comes in with the last of it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.model import O_OXIDIZER_FLOW
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, IS_LIQUID, M_LIQUID, switch, term
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.failing import FailingFlow

Array = NDArray[np.float64]

SHARE, LIQUID = range(2)

SURE = 0.25
"""Standard deviation of what fails, and of the liquid that is then left, relative to what the samples show."""

MOST = 0.95
"""Part of the flow that fails at most."""

STEADY = 0.05
"""Seconds before the flow fails at which it is still whole."""


@term
def _failing(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    """The flow falls in proportion to the liquid that is left."""
    if hook == AT_FLOW and env[IS_LIQUID] > 0.0 and env[M_LIQUID] < p[LIQUID]:
        site[INJECTOR_FACTOR] *= 1.0 - min(p[SHARE], MOST) * (1.0 - env[M_LIQUID] / p[LIQUID])


@switch
def _begins(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return env[M_LIQUID] - p[LIQUID]


@lru_cache(maxsize=1)
def failing_effect() -> Effect:
    """An injector that passes less and less as the last ``liquid`` leaves, by ``share`` at its end."""
    return Effect(
        name="probe_failing",
        equation="injector",
        meaning="a flow that fails before the liquid is gone",
        reference="free form",
        parameters=(
            Parameter("share", "-", "of the flow that has failed when the liquid is gone", 0.1),
            Parameter("liquid", "kg", "left when it begins to fail", 0.1, center=0.1),
        ),
        phases=("liquid",),
        sites=("injector_factor",),
        term=_failing,
        switch=_begins,
    )


SHARE_OF_FLOW, LIQUID_LEFT = "probe_failing.share", "probe_failing.liquid"
"""Names of its parameters in a hypothesis."""


def with_failing(parent: Fit, found: FailingFlow) -> tuple[Hypothesis, Array]:
    """A fit's hypothesis with a flow that fails as chamber and thrust showed it, and its x."""
    flow = flow_before(parent, found.t_v, found.seconds)
    # what is left behind a ramp of the flow is less than what a whole flow would take along
    liquid = flow * found.seconds * (1.0 - 0.5 * found.share)
    share = Free(SHARE_OF_FLOW, found.share, SURE, "positive")
    free = (replace(share, most=share.place(MOST)), Free(LIQUID_LEFT, liquid, SURE, "positive"))
    return parent.hypothesis.with_active(failing_effect().at(share=found.share, liquid=liquid), free), np.zeros(2)


def flow_before(fitted: Fit, t_v: float, seconds: float) -> float:
    """The flow of a fit shortly before it begins to fail [kg/s]."""
    gone = fitted.burnt.liquid_out if fitted.burnt.liquid_out is not None else t_v
    outputs = fitted.burnt.steps.at(np.array([max(gone - seconds - STEADY, 0.0)]))[1]
    return max(float(outputs[0, O_OXIDIZER_FLOW]), 1e-6)


def lost_at(times: Array, t_v: float, seconds: float, share: float) -> Array:
    """Part of the flow that has failed at ``times`` [s]."""
    return np.asarray(np.where(times < t_v, share * np.clip(1.0 + (times - t_v) / seconds, 0.0, 1.0), 0.0))
