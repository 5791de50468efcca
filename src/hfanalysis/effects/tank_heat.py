"""Heating blankets, or any other source of heat, into the oxidizer."""

from __future__ import annotations

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import RATES, TANK_HEAT, term


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        site[TANK_HEAT] += p[0]


EFFECT = Effect(
    name="tank_heat",
    equation="tank_energy",
    meaning="the oxidizer in the tank receives a constant heat flow",
    reference="dU/dt = -mdot h + Qdot: the report's eq. 3.9 with a source; two 500 W blankets in section 4.1",
    formula="Q = constant",
    sites=("tank_heat",),
    parameters=(Parameter("power", "W", "heat flow into the tank's content", typical=1000.0, low=-5e3, high=20e3),),
    phases=("liquid", "vapor"),
    term=_term,
    twins=("tank_wall_heat_capacity",),
    decisive="a thermocouple on the tank's wall, and the blankets' current",
)
