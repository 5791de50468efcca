"""An injector whose C_i drifts while the liquid lasts, along another course than the intervals are made for.

They (hfanalysis.calibrate.drifting) suppose a straight line; here most of the change may come early (holes that warm
up) or late (vapor in what the tank lets out).
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Active, Believable, Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, term

EARLY, LATE = 0.3, 3.0
"""Powers of time with which a drift goes: half of the change in the first tenth of the liquid, or in its last fifth."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_FLOW:
        site[INJECTOR_FACTOR] *= 1.0 + p[0] * ((min(max(t, 0.0), p[1]) / p[1]) ** p[2] - 1.0 / (1.0 + p[2]))


COURSE = Effect(
    name="injector_course",
    plain_name="injector that drifts along a curve",
    equation="injector",
    meaning="the injector lets more or less through the longer the liquid flows, mostly early or mostly late",
    reference="a power of time about its mean",
    formula="mdot = mdot_0 (1 + d ((t / t_v)^q - 1 / (1 + q)))",
    sites=("injector_factor",),
    parameters=(Parameter("drift", "-", "change while the liquid lasts", 0.05, high=0.5),
                Parameter("time", "s", "that the liquid lasts", 5.0),
                Parameter("power", "-", "of time", 1.0)),
    phases=("liquid", "vapor"),
    term=_term,
    twins=(),
    decisive="cold flow of nitrous oxide",
    believable=Believable("drift", 0.2, "of the vapor that flows in"),
)  # fmt: skip


def drawn(generator: np.random.Generator, std: float, lasts: float) -> Active:
    """A drift of ``std`` [-] while the liquid ``lasts`` [s], along any of these courses."""
    power = EARLY * (LATE / EARLY) ** generator.uniform()
    return Active(COURSE, (std * float(generator.standard_normal()), lasts, power))


def factor(drift: Active, time: Array) -> Array:
    """What it multiplies the flow by (n,) [-], at ``time`` (n,) [s]."""
    change, lasts, power = drift.values
    return np.asarray(1.0 + change * ((np.clip(time, 0.0, lasts) / lasts) ** power - 1.0 / (1.0 + power)))
