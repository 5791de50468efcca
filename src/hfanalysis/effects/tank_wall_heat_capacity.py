"""The tank's wall gives its heat to the oxidizer that cools while the tank empties."""

from __future__ import annotations

from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.equations import VOLUME
from hfanalysis.engine.sites import IS_LIQUID, M_LIQUID, RATES, RHO_FEED, T_TANK, TANK_HEAT, term

CAPACITY, TIME, EXCESS, VAPOR_SHARE = range(4)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    wetted = env[M_LIQUID] / (env[RHO_FEED] * c[VOLUME]) if env[IS_LIQUID] > 0.0 else 0.0
    cooling = (x[0] - env[T_TANK]) / p[TIME] * (wetted + p[VAPOR_SHARE] * (1.0 - wetted))
    site[TANK_HEAT] += p[CAPACITY] * cooling
    dx[0] = -cooling


EFFECT = Effect(
    name="tank_wall_heat_capacity",
    plain_name="heat from the tank's wall",
    equation="tank_energy",
    meaning="the tank's wall is a store of heat for the oxidizer",
    reference="report, section 5.1 (sources of error: adiabatic oxidizer tank) and 4.1 (blankets left hot); a lumped "
    "wall as in Whitmore and Chandler, J. Propulsion and Power 26 (2010) 706, and Zimmerman et al., AIAA 2013-4045",
    formula="Q = C f (T_w - T) / tau,  dT_w/dt = -f (T_w - T) / tau,  T_w(0) = T_0 + dT,  f = w + s (1 - w), w wetted",
    sites=("tank_heat",),
    parameters=(
        Parameter("capacity", "J/K", "m c_p of the wall that takes part", typical=4000.0, low=0.0, high=40e3),
        Parameter(
            "time", "s", "m c_p / (h A) of a wall that is wetted all over", 15.0, center=25.0, low=2.0, high=200.0
        ),
        Parameter("excess", "K", "wall above the oxidizer at ignition", 2.0, center=0.0, low=-20.0, high=100.0),
        Parameter(
            "vapor_share",
            "-",
            "heat transfer to vapor over that to liquid",
            0.3,
            center=0.4,
            low=0.0,
            high=1.0,
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    states=(OwnState("wall_temperature", "K", 0.1, lambda engine, values: engine.temperature + values["excess"]),),
    twins=("tank_heat",),
    decisive="a thermocouple on the tank's wall",
    believable=Believable("capacity", 2e4, "20 kJ/K are 22 kg of aluminum", unit="kJ/K", factor=1e-3),
)
