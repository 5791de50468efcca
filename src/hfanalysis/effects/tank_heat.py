"""Heating blankets, or any other source of heat, into the oxidizer."""

from __future__ import annotations

from math import exp

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import RATES, TANK_HEAT, term

POWER, LAG, FADE = range(3)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        site[TANK_HEAT] += p[POWER] * (1.0 - exp(-max(t, 0.0) / p[LAG])) * exp(-max(t, 0.0) / p[FADE])


EFFECT = Effect(
    name="tank_heat",
    equation="tank_energy",
    meaning="the oxidizer in the tank receives heat from outside, the less the longer",
    reference="dU/dt = -mdot h + Qdot: the report's eq. 3.9 with a source; section 4.1: two blankets of 500 W, turned "
    "off before the opening, whose residual heat fades",
    formula="Q = P (1 - exp(-t/tau)) exp(-t/fade): what came in before the valve opened shows in the temperature",
    sites=("tank_heat",),
    parameters=(
        Parameter("power", "W", "heat flow into the tank's content", typical=1000.0, low=0.0, high=20e3),
        Parameter(
            "lag", "s", "until the heat flow is there: it comes through the wall", 0.9, center=0.1, low=0.02, high=20.0
        ),
        Parameter("fade", "s", "in which what is hot gives its heat away", 20.0, center=20.0, low=3.0, high=500.0),
    ),
    phases=("liquid", "vapor"),
    term=_term,
    twins=("tank_wall_heat_capacity",),
    decisive="a thermocouple on the tank's wall, and the blankets' current",
)
