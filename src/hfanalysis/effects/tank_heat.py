"""Heating blankets, or any other source of heat, into the oxidizer."""

from __future__ import annotations

from math import exp

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import RATES, TANK_HEAT, term

POWER, LAG, FADE, BEGUN = range(4)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        since = max(t, 0.0)
        arrived = 1.0 - (1.0 - p[BEGUN]) * exp(-since / p[LAG])
        site[TANK_HEAT] += p[POWER] * arrived * exp(-since / p[FADE])


EFFECT = Effect(
    name="tank_heat",
    plain_name="heat into the tank",
    stand_only="the stand's heating blankets",
    equation="tank_energy",
    meaning="the oxidizer in the tank receives heat from outside, the less the longer",
    reference="dU/dt = -mdot h + Qdot: the report's eq. 3.7 with a source; section 4.1: two blankets of 500 W, turned "
    "off before the opening, whose residual heat fades. A lag of a second is that of heat through a centimeter of "
    "aluminum, one of tens of seconds that of its heat capacity over the heat transfer to the liquid; what came in "
    "before the valve opened shows in the temperature",
    formula="Q = P (1 - (1 - s) exp(-t/tau)) exp(-t/fade)",
    sites=("tank_heat",),
    parameters=(
        Parameter("power", "W", "heat flow into the tank's content", typical=1000.0, low=0.0, high=20e3),
        Parameter(
            "lag", "s", "until the heat flow is there: it comes through the wall", 4.0, center=2.0, low=0.02, high=20.0
        ),
        Parameter("fade", "s", "in which what is hot gives its heat away", 60.0, center=40.0, low=3.0, high=500.0),
        Parameter("begun", "-", "share of the heat flow that is there at once", 0.3, center=0.5, low=0.0, high=1.0),
    ),
    phases=("liquid", "vapor"),
    term=_term,
    twins=("tank_wall_heat_capacity",),
    decisive="a thermocouple on the tank's wall, and the blankets' current",
    believable=Believable(
        "power",
        1e4,
        "a stand's heating blankets draw some hundred watts each, and 22 kg of aluminum that are 10 K warmer than the "
        "oxidizer hold 10 kW for 20 s",
        unit="kW",
        factor=1e-3,
    ),
)
