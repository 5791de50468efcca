"""What an injector that drifts does to a and n: over the burn C_i may change, and the engine's model has one.

A flow that grows while the liquid lasts looks like a fuel that slows down less as its port opens, which is a larger n.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.course import Course
from hfanalysis.calibrate.evidence import Evidence, predicted
from hfanalysis.engine.effect import Active, Believable, Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, term

USUAL = 0.05
"""Standard deviation of the part by which C_i changes while the liquid lasts [-]. Source: what flows in is 10 to 20 %
vapor by mass at the end and less at the beginning (docs/calibration.md), which is worth 5 to 10 % of an effective C_i.
"""

BELIEVED = 3.0
"""Standard deviations of a drift beyond which it is the tank's balance that is off: a stratified tank shows drifts of a
third (HF5). Source: definition."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_FLOW:
        site[INJECTOR_FACTOR] *= 1.0 + p[0] * (min(max(t, 0.0), p[1]) / p[1] - 0.5)


DRIFT = Effect(
    name="injector_drift",
    plain_name="injector that drifts",
    equation="injector",
    meaning="the injector lets more or less through the longer the liquid flows",
    reference="a straight line about its mean",
    formula="mdot = mdot_0 (1 + d (t / t_v - 1/2))",
    sites=("injector_factor",),
    parameters=(Parameter("drift", "-", "change while the liquid lasts", 0.05, high=0.5),
                Parameter("time", "s", "that the liquid lasts", 5.0)),
    phases=("liquid", "vapor"),
    term=_term,
    twins=(),
    decisive="cold flow of nitrous oxide",
    believable=Believable("drift", 0.2, "of the vapor that flows in"),
)  # fmt: skip
"""No effect of the library: it is there for what it would do, not to be named."""


def drift_std(course: Course | None, value: float, lasts: float) -> float:
    """What the change of C_i over the liquid phase is off by [-]: the model has none.

    Args:
        course: of C_i over time, as far as the log tells it.
        value: C_i [-].
        lasts: the liquid [s].
    """
    if course is None or not value > 0.0:
        return USUAL
    seen, std = course.drift * lasts / value, course.std * lasts / value
    if abs(seen) > BELIEVED * float(np.hypot(USUAL, std)):
        return USUAL
    trusted = USUAL**2 / (USUAL**2 + std**2)
    return float(np.hypot(trusted * seen, np.sqrt(trusted) * std))


def by_drift(evidence: Evidence, a: float, n: float, std: float, lasts: float) -> Array:
    """Change of what was observed [Pa, s, kg] (n,) by a drift of ``std`` [-] over ``lasts`` [s], with this law."""
    lit = replace(evidence.engine, a=a, n=n)
    moved = replace(lit, effects=(*lit.effects, Active(DRIFT, (std, lasts))))
    before, after = (predicted(evidence, engine) for engine in (lit, moved))
    if before is None or after is None:
        raise ArithmeticError("the engine's model cannot be run with an injector that drifts")
    return np.asarray(after - before)
