"""Nitrogen from the purge line entering the tank through its check valve, once the tank's pressure has fallen
enough."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Believable, Channels, Effect, Parameter
from hfanalysis.engine.injector import bent_root
from hfanalysis.engine.nozzle import choked_flow_factor
from hfanalysis.engine.sites import NITROGEN_INFLOW, P_TANK, RATES, T_TANK, TANK_HEAT, switch, term
from hfanalysis.engine.tank import NITROGEN_CV, SPECIFIC_NITROGEN

AREA, SUPPLY, CRACKING, TEMPERATURE, LINE_TO_VALVE, CRITICAL = range(6)
GAMMA = 1.4
"""Heat capacity ratio of nitrogen [-]. Source: a diatomic ideal gas has 7/5."""

CHOKED = float(choked_flow_factor(GAMMA))
"""mdot sqrt(R T) / (A p_0) of nitrogen through a choked throat [-]."""

SMALL_SHARE = 1e-3
"""Share of the choked flow squared [-] below which the flow falls linearly."""

LEAST_AREA = 1e-6
"""Effective area [m^2] of a leak that opens its valve by half: what a smaller one loses in it grows with the leak."""

CP = NITROGEN_CV + SPECIFIC_NITROGEN
"""c_p of nitrogen [J/(kg K)]. Source: a diatomic ideal gas has 7/2 R."""


@switch
def _opens(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return p[SUPPLY] - p[CRACKING] - env[P_TANK]


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    ratio = (env[P_TANK] + p[CRACKING]) / p[SUPPLY]
    if ratio >= 1.0:
        return
    # choked below the critical ratio, an ellipse above it (ISO 6358), bent to a finite slope where the valve closes
    beyond = max((ratio - p[CRITICAL]) / (1.0 - p[CRITICAL]), 0.0)
    share = 1.0 - beyond * beyond
    choked = p[AREA] * CHOKED * p[SUPPLY] / sqrt(SPECIFIC_NITROGEN * p[TEMPERATURE])
    flow = choked * bent_root(share, SMALL_SHARE)
    site[NITROGEN_INFLOW] += flow
    site[TANK_HEAT] += flow * (CP * p[TEMPERATURE] - NITROGEN_CV * env[T_TANK])


def _line(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    """The purge line's pressure above the tank's, beyond the cracking pressure: what a flow loses in the open valve, as
    in any restriction by its square. It cannot be more than what drives the flow."""
    if "p_purge" not in channels:
        return dict(channels)
    opens_at = values["supply_pressure"] - values["cracking_pressure"]
    driving = np.maximum(opens_at - channels["p_tank"], 1.0)
    critical = values["critical_ratio"]
    beyond = np.maximum((1.0 - driving / values["supply_pressure"] - critical) / (1.0 - critical), 0.0)
    share, at_valve = np.maximum(1.0 - beyond**2, 0.0), channels["p_tank"] + values["cracking_pressure"]
    dynamic = 0.5 * CHOKED**2 * values["supply_pressure"] ** 2 * share / np.maximum(at_valve, 1.0)
    dropped = values["line_to_valve"] ** 2 * dynamic * values["area"] / (values["area"] + LEAST_AREA)
    lifted = np.where(channels["p_tank"] < opens_at, driving * dropped / (driving + dropped), 0.0)
    return {**channels, "p_purge": channels["p_purge"] + lifted}


EFFECT = Effect(
    name="n2_purge",
    plain_name="nitrogen into the tank",
    stand_only="the stand's purge line",
    equation="tank_volume",
    meaning="nitrogen enters the tank through the purge line's check valve",
    reference="report, section 4.2.2: the valve opens when the tank is below the purge line by its cracking pressure; "
    "flow of an orifice by ISO 6358; the spring takes the cracking pressure, the open valve loses by the flow's square",
    formula="mdot = A p_s sqrt(gamma / (R T_s)) (2/(gamma+1))^((gamma+1)/(2 (gamma-1))) phi(p_T + p_crack, p_s); "
    "1 / (p_purge - p_T - p_crack) = 2 A_v^2 (p_T + p_crack) / (mdot^2 R T_s) + 1 / (p_s - p_T - p_crack), "
    "A_v = A / r",
    sites=("nitrogen_inflow", "tank_heat"),
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
        Parameter(
            "line_to_valve", "-", "effective area of line and valve over that of the open valve", 0.6, 0.3, 0.01, 3.0
        ),
        Parameter(
            "critical_ratio",
            "-",
            "pressure ratio below which the flow is choked: 0.53 in an ideal nozzle, 0.2 to 0.5 in valves",
            0.12,
            center=0.35,
            low=0.0,
            high=0.53,
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    switch=_opens,
    distort=_line,
    twins=(),
    decisive="a flow meter, or the pressure of the nitrogen bottle over time",
    believable=Believable(
        "area", 4.7e-5, "47 mm^2 are the bore of a tube of 3/8 inch, 7.75 mm", unit="mm^2", factor=1e6
    ),
)
