"""A feed line that the opening valve finds empty, and that goes on feeding when the tank's liquid is gone."""

from __future__ import annotations

from math import sqrt

from hfanalysis.engine.effect import Effect, OwnState, Parameter
from hfanalysis.engine.model import AREA, LIQUID_LOSS, LOSS_FACTOR
from hfanalysis.engine.sites import (
    AT_FLOW,
    FEED_LOSS,
    IS_BURNING,
    IS_LIQUID,
    OXIDIZER_FLOW,
    OXIDIZER_SOURCE,
    P_CHAMBER,
    P_TANK,
    RATES,
    RHO_FEED,
    TANK_LEAK,
    term,
)

VOLUME, CUSHION = range(2)
CONTENT, ROOM = range(2)
LIQUID_DENSITY = 880.0
"""Of what is left in the line when the tank runs dry [kg/m^3]: nitrous oxide saturated at 278 K."""

LEAST_RESISTANCE = 0.05
"""Of the line over that of the injector, where the engine states none: filling does not become infinitely fast."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    cushion = p[CUSHION] * LIQUID_DENSITY
    drop = max(env[P_TANK] - env[P_CHAMBER], 0.0)
    if env[IS_LIQUID] > 0.0:
        # the line's own pressure comes up as its last gas is pushed out: what it lacks is spent on filling
        room = max(x[ROOM], 0.0)
        lacking = room / (room + cushion) * drop
        if hook == AT_FLOW:
            site[FEED_LOSS] += lacking
        elif hook == RATES:
            resistance = LEAST_RESISTANCE * 0.5 / (c[AREA] * c[AREA])
            if c[LIQUID_LOSS] < 0.0:
                resistance = max(resistance, c[LOSS_FACTOR])
            onward = env[OXIDIZER_FLOW]
            filling = sqrt(onward * onward + lacking * env[RHO_FEED] / resistance) - onward
            site[TANK_LEAK] += filling
            dx[CONTENT], dx[ROOM] = filling, -filling
    elif hook == RATES and env[IS_BURNING] > 0.0:
        # liquid in the line takes the vapour's place in the injector, and passes it as sqrt(rho)
        content = max(x[CONTENT], 0.0)
        taken = content / (content + cushion) * env[OXIDIZER_FLOW]
        draining = taken * sqrt(LIQUID_DENSITY / env[RHO_FEED])
        site[TANK_LEAK] -= taken
        site[OXIDIZER_SOURCE] += draining - taken
        dx[CONTENT] = -draining


EFFECT = Effect(
    name="feed_line_fill",
    equation="feed",
    meaning="the feed line is filled when the valve opens, and empties into the chamber when the tank's liquid is gone",
    reference="report, section 4.1 and phase 1 of its hot fires: the run line's pressure rises until the line is full. "
    "Flow into the line by the line's own loss p_T - p_run = K mdot^2 / rho, on to the chamber by the report's eq. 3.2",
    formula="p_T - p_run = K mdot_inj^2 / rho + g (p_T - p_c),  g = room / (room + rho V_c),  "
    "d(room)/dt = mdot_inj - sqrt(mdot_inj^2 + g (p_T - p_c) rho / K),  room(0) = rho V",
    sites=("feed_loss", "tank_leak", "oxidizer_source"),
    parameters=(
        Parameter("volume", "m^3", "of the line between valve and injector", typical=2e-4, low=0.0, high=3e-3),
        Parameter(
            "cushion",
            "m^3",
            "room left at which half the pressure has come up",
            2e-5,
            center=4e-5,
            low=5e-6,
            high=5e-4,
            given=True,
        ),
    ),
    phases=("liquid", "vapor"),
    term=_term,
    states=(
        OwnState("line_content", "kg", 1e-3, lambda engine, values: 0.0),
        OwnState(
            "line_room",
            "kg of room",
            1e-3,
            lambda engine, values: values["volume"] * float(engine.saturation.liquid_density(engine.temperature)),
        ),
    ),
    twins=(),
    decisive="the run line's pressure at 1 kHz, and the line's length and bore",
)
