"""A tank that is hotter above than below: its pressure falls to the bulk's saturation when the valve opens."""

from __future__ import annotations

from hfanalysis.engine.effect import Effect, OwnState, Parameter
from hfanalysis.engine.model import VOLUME
from hfanalysis.engine.sites import AT_TANK, OXIDIZER_FLOW, RATES, RHO_FEED, TANK_PRESSURE, term

EXCESS, MIXING = range(2)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_TANK:
        site[TANK_PRESSURE] += x[0]
    elif hook == RATES:
        dx[0] = -x[0] * env[OXIDIZER_FLOW] / (env[RHO_FEED] * p[MIXING] * c[VOLUME])


EFFECT = Effect(
    name="tank_stratification",
    equation="tank_energy",
    meaning="a hot ullage over a colder bulk: the pressure at rest is above the bulk's saturation and falls to it",
    reference="Clausius-Clapeyron slope of nitrous oxide (report, appendix); temperatures above and below differ in a "
    "tank at rest: Zimmerman, Waxman, Cantwell and Zilliac, AIAA 2013-4045. The layer's pressure is spent by expansion "
    "into the volume that leaves",
    formula="p_T = p_sat(T) + x,  x(0) = p_sat'(T_0) dT,  dx/dt = -x (mdot / rho) / (f V_T)",
    sites=("tank_pressure",),
    parameters=(
        Parameter("excess", "K", "ullage above the bulk's temperature at rest", typical=2.0, low=0.0, high=20.0),
        Parameter(
            "mixing", "-", "share of the tank's volume that flows out per e-fold", 0.02, center=0.03, low=2e-3, high=0.3
        ),
    ),
    phases=("liquid",),
    term=_term,
    states=(
        OwnState(
            "ullage_excess",
            "Pa",
            1e2,
            lambda engine, values: values["excess"] * float(engine.saturation.pressure_slope(engine.temperature)),
        ),
    ),
    twins=("tank_nonequilibrium",),
    decisive="thermocouples at the top and the bottom of the tank, before the valve opens",
)
