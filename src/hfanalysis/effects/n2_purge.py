"""Nitrogen from the purge line entering the tank through its check valve, once the tank's pressure has fallen enough."""

from __future__ import annotations

from math import sqrt

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.injector import SMALL_DROP
from hfanalysis.engine.model import NITROGEN_CV, SPECIFIC_NITROGEN
from hfanalysis.engine.sites import NITROGEN_INFLOW, P_TANK, RATES, T_TANK, TANK_HEAT, switch, term

AREA, SUPPLY, CRACKING, TEMPERATURE = range(4)
GAMMA = 1.4
CRITICAL = (2.0 / (GAMMA + 1.0)) ** (GAMMA / (GAMMA - 1.0))
CP = NITROGEN_CV + SPECIFIC_NITROGEN


@switch
def _opens(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return p[SUPPLY] - p[CRACKING] - env[P_TANK]


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    drop = p[SUPPLY] - p[CRACKING] - env[P_TANK]
    if drop <= 0.0:
        return
    upstream = p[SUPPLY]
    # the spring takes the cracking pressure; what is left drives the flow, at most to the speed of sound
    drop = min(drop, (1.0 - CRITICAL) * upstream)
    root = (
        sqrt(drop) if drop >= SMALL_DROP else sqrt(SMALL_DROP) * 0.5 * (drop / SMALL_DROP) * (3.0 - drop / SMALL_DROP)
    )
    flow = p[AREA] * sqrt(2.0 * upstream / (SPECIFIC_NITROGEN * p[TEMPERATURE])) * root
    site[NITROGEN_INFLOW] += flow
    site[TANK_HEAT] += flow * (CP * p[TEMPERATURE] - NITROGEN_CV * env[T_TANK])


EFFECT = Effect(
    name="n2_purge",
    equation="tank_volume",
    meaning="nitrogen enters the tank through the purge line's check valve",
    reference="report, section 4.2.2: the valve opens when the tank is below the purge line by its cracking pressure; flow as "
    "through an orifice, mdot = C A sqrt(2 rho dp), choked at most",
    parameters=(
        Parameter("area", "m^2", "effective area of line and check valve", typical=1e-5, low=0.0, high=2e-4),
        Parameter(
            "supply_pressure", "Pa", "pressure of the purge line", 5e5, center=38e5, low=1e5, high=200e5, given=True
        ),
        Parameter(
            "cracking_pressure", "Pa", "of the check valve", 0.5e5, center=4.27e5, low=0.0, high=20e5, given=True
        ),
        Parameter(
            "temperature", "K", "of the nitrogen in its line", 15.0, center=293.15, low=200.0, high=330.0, given=True
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    switch=_opens,
    twins=(),
    decisive="a flow meter, or the pressure of the nitrogen bottle over time",
)
