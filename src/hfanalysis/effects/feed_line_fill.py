"""A feed line that the opening valve finds empty.

What is left in it when the tank's liquid is gone is not followed: no log shows the chamber go on burning then.
"""

from __future__ import annotations

from math import sqrt

from hfanalysis.engine.effect import Effect, OwnState, Parameter
from hfanalysis.engine.model import AREA, LIQUID_LOSS, LOSS_FACTOR
from hfanalysis.engine.sites import (
    AT_FLOW,
    FEED_LOSS,
    IS_LIQUID,
    OXIDIZER_FLOW,
    P_CHAMBER,
    P_TANK,
    RATES,
    RHO_FEED,
    TANK_LEAK,
    term,
)

VOLUME, STEEPNESS = range(2)
CONTENT, EMPTY = range(2)
LIQUID_DENSITY = 880.0
"""Of what fills the line [kg/m^3]: nitrous oxide saturated at 278 K."""

LEAST_VOLUME = 2e-6
"""Of any valve and fitting [m^3]: a line much smaller than that changes nothing."""

LEAST_RESISTANCE = 0.05
"""Of the line over that of the injector, where the engine states none: filling does not become infinitely fast."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if env[IS_LIQUID] <= 0.0:
        return
    empty = max(x[EMPTY], 0.0)
    # the line's own pressure comes up as it fills: what it lacks is spent on filling
    by_volume = empty ** p[STEEPNESS] * max(env[P_TANK] - env[P_CHAMBER], 0.0) / (p[VOLUME] + LEAST_VOLUME)
    if hook == AT_FLOW:
        site[FEED_LOSS] += p[VOLUME] * by_volume
    elif hook == RATES:
        resistance = LEAST_RESISTANCE * 0.5 / (c[AREA] * c[AREA])
        if c[LIQUID_LOSS] < 0.0:
            resistance = max(resistance, c[LOSS_FACTOR])
        onward, spare = env[OXIDIZER_FLOW], by_volume * env[RHO_FEED] / resistance
        # sqrt(onward^2 + V spare) - onward, over the volume: a small line fills at once, none not at all
        filling = spare / (sqrt(onward * onward + p[VOLUME] * spare) + onward + LEAST_FLOW)
        site[TANK_LEAK] += p[VOLUME] * filling
        dx[CONTENT], dx[EMPTY] = p[VOLUME] * filling, -filling / LIQUID_DENSITY


LEAST_FLOW = 1e-6
"""Onward flow [kg/s] that keeps the quotient finite where nothing flows."""


EFFECT = Effect(
    name="feed_line_fill",
    equation="feed",
    meaning="the feed line is filled when the valve opens",
    reference="report, section 4.1 and phase 1 of its hot fires: the run line's pressure rises until the line is full. "
    "Flow into the line by the line's own loss p_T - p_run = K mdot^2 / rho, on to the chamber by the report's eq. 3.2",
    formula="p_T - p_run = K mdot_inj^2 / rho + g (p_T - p_c),  g = e^k V / (V + 2 mL),  "
    "rho V de/dt = mdot_inj - sqrt(mdot_inj^2 + g (p_T - p_c) rho / K),  e(0) = 1, the empty share",
    sites=("feed_loss", "tank_leak"),
    parameters=(
        Parameter("volume", "m^3", "of the line between valve and injector", typical=2e-4, low=0.0, high=3e-3),
        Parameter(
            "steepness",
            "-",
            "of the pressure that is still lacking, over the room still empty",
            0.7,
            center=1.5,
            low=1.0,
            high=4.0,
        ),
    ),
    phases=("liquid",),
    term=_term,
    states=(
        OwnState("line_content", "kg", 1e-3, lambda engine, values: 0.0),
        OwnState("line_empty", "-", 1e-3, lambda engine, values: 1.0),
    ),
    twins=(),
    decisive="the run line's pressure at 1 kHz, and the line's length and bore",
)
