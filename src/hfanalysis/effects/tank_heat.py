"""Heating blankets, or any other source of heat, into the oxidizer."""

from __future__ import annotations

from math import exp

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import RATES, TANK_HEAT, term

POWER, LAG = range(2)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        site[TANK_HEAT] += p[POWER] * (1.0 - exp(-max(t, 0.0) / p[LAG]))


EFFECT = Effect(
    name="tank_heat",
    equation="tank_energy",
    meaning="the oxidizer in the tank receives a heat flow that soon is constant",
    reference="dU/dt = -mdot h + Qdot: the report's eq. 3.9 with a source; two 500 W blankets in section 4.1",
    formula="Q = P (1 - exp(-t/tau)), P constant: what came in before the valve opened shows in the temperature",
    sites=("tank_heat",),
    parameters=(
        Parameter("power", "W", "heat flow into the tank's content", typical=1000.0, low=0.0, high=20e3),
        Parameter(
            "lag", "s", "until the heat flow is there: it comes through the wall", 0.9, center=0.1, low=0.02, high=20.0
        ),
    ),
    phases=("liquid", "vapor"),
    term=_term,
    twins=("tank_wall_heat_capacity",),
    decisive="a thermocouple on the tank's wall, and the blankets' current",
)
