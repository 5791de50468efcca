"""The governing equations of the unsteady engine as one compiled right-hand side (report, chapter 3).

Tank, feed line, injector, grain, chamber, nozzle and the rocket's ascent. The chamber pressure follows from the stored
masses by the gas law. Every equation has its sites (:mod:`hfanalysis.engine.sites`); with no terms active they are the
neutral element and the equations are the report's.

Beyond the report: nitrogen in tank and chamber (only terms bring it in), the enthalpy of the nitrous oxide that is in
the chamber, and, after burn-out, gas that enters unburnt and cold.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.sites import (
    ADDRESS,
    AT_CHAMBER,
    AT_FLOW,
    AT_TANK,
    FEED_FACTOR,
    FEED_LOSS,
    FUEL_FLOW,
    FUEL_SOURCE,
    GAMMA_CHAMBER,
    HOT_SHARE,
    INJECTOR_FACTOR,
    IS_BURNING,
    IS_LIQUID,
    M_LIQUID,
    M_NITROGEN,
    M_TANK,
    NITROGEN_INFLOW,
    OF_RATIO,
    OXIDIZER_FLOW,
    OXIDIZER_SOURCE,
    P_AMBIENT,
    P_CHAMBER,
    P_RUN,
    P_TANK,
    PARAMETERS_AT,
    PORT_RADIUS,
    RATES,
    REGRESSION_FACTOR,
    RHO_FEED,
    RT_CHAMBER,
    STATES_AT,
    T_TANK,
    TANK_HEAT,
    TANK_LEAK,
    TANK_PRESSURE,
    TEMPERATURE_FACTOR,
    THROAT_FACTOR,
    THRUST_FACTOR,
    call_term,
)
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, saturated_tank
from hfanalysis.flight.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, drag
from hfanalysis.thermo.air import air
from hfanalysis.thermo.combustion import FORMATION_OFFSET
from hfanalysis.thermo.combustion_table import Grid, chamber_pressure
from hfanalysis.thermo.constants import GAS_CONSTANT, NITROGEN_MOLAR_MASS
from hfanalysis.thermo.saturation import LN_VAPOR_CV, VAPOR_ENTHALPY, evaluate

Array = NDArray[np.float64]
Table = tuple[Array, float, float, float]
Tables = tuple[Table, Grid, Array]
"""Saturated nitrous oxide, burnt gas, drag coefficient over Mach number."""
Work = tuple[Array, Array]

STATES = (
    "tank_mass", "tank_temperature", "port_radius", "chamber_oxidizer", "chamber_fuel", "altitude", "speed", "impulse",
    "tank_nitrogen", "chamber_nitrogen", "chamber_enthalpy", "cold_gas", "cold_energy", "vapor_compressibility",
    "vapor_exponent",
)  # fmt: skip
"""SI. chamber_enthalpy is the stored nitrous oxide's [J], cold_energy the unburnt gas's m R T [J]; the last two are
constants that are set when the liquid runs out. The states of effects follow."""

(TANK, TEMPERATURE, RADIUS, OXIDIZER, FUEL, ALTITUDE, SPEED, IMPULSE, NITROGEN, CHAMBER_NITROGEN, ENTHALPY, COLD,
 COLD_ENERGY, COMPRESSIBILITY, EXPONENT) = range(len(STATES))  # fmt: skip

OUTPUTS = (
    "tank_pressure", "chamber_pressure", "chamber_temperature_by_mass", "thrust", "oxidizer_flow", "fuel_flow",
    "nozzle_flow", "of_ratio", "acceleration", "run_pressure", "gamma", "oxidizer_enthalpy", "nitrogen_share",
    "ambient_pressure", "nitrogen_inflow", "tank_outflow",
)  # fmt: skip
"""SI; oxidizer_flow is all that passes the injector, nitrogen_share that of nitrogen in it by mass."""

(O_TANK_PRESSURE, O_CHAMBER_PRESSURE, O_RT, O_THRUST, O_OXIDIZER_FLOW, O_FUEL_FLOW, O_NOZZLE_FLOW, O_OF, O_ACCELERATION,
 O_RUN_PRESSURE, O_GAMMA, O_ENTHALPY, O_SHARE, O_AMBIENT, O_NITROGEN_INFLOW, O_OUTFLOW) = range(16)  # fmt: skip

CONSTANTS = (
    "volume", "area", "loss_factor", "polytropic_exponent", "liquid_loss", "vapor_loss", "grain_length", "a", "n",
    "dead_volume", "fuel_density", "throat_area", "exit_area", "outer_radius", "oxidizer_enthalpy", "dry_mass",
    "drag_area", "climb", "launch_altitude", "ambient_pressure", "flies", "fuel_mass", "oxidizer_mass", "temperature",
)  # fmt: skip
"""SI. A negative liquid_loss stands for the quadratic law, a NaN oxidizer_enthalpy for that of what leaves the tank, a
NaN polytropic_exponent for c_p/c_v when the liquid runs out, a NaN ambient_pressure for that of the altitude;
parameters of effects follow."""

(VOLUME, AREA, LOSS_FACTOR, POLYTROPIC_EXPONENT, LIQUID_LOSS, VAPOR_LOSS, GRAIN_LENGTH, REGRESSION_A, REGRESSION_N,
 DEAD_VOLUME, FUEL_DENSITY, THROAT_AREA, EXIT_AREA, OUTER_RADIUS, OXIDIZER_ENTHALPY, DRY_MASS, DRAG_AREA, CLIMB,
 LAUNCH_ALTITUDE, AMBIENT_PRESSURE, FLIES, FUEL_MASS, OXIDIZER_MASS, INITIAL_TEMPERATURE) = range(24)  # fmt: skip

PAD = 1e-3
"""Height [m] above which a rocket has left its pad."""

SMALL_FLUX = 0.01
"""Oxidizer flux [kg/(m^2 s)] below which regression is bent to a finite slope."""

LEAST_GAS = 1e-9
"""Mass [kg] of burnt gas below which its mixture is no longer asked for."""

COLD_GAMMA = 1.3
"""Heat capacity ratio of unburnt gas: nitrous oxide has 1.27, nitrogen 1.40 (ideal gases at 298 K)."""

SPECIFIC_NITROGEN = GAS_CONSTANT / NITROGEN_MOLAR_MASS
NITROGEN_CV = 2.5 * SPECIFIC_NITROGEN

COLDEST_VAPOR, WARMEST_VAPOR = 185.0, 305.0
"""Temperatures [K] between which the vapour's heat capacity and enthalpy are read from the saturation line."""


@njit(cache=True, error_model="numpy")
def flux_power(flux: float, n: float) -> float:
    """G^n, below SMALL_FLUX the parabola that joins it smoothly and ends in 0 with a finite slope."""
    if flux >= SMALL_FLUX:
        return float(flux**n)
    x = max(flux, 0.0) / SMALL_FLUX
    return float(SMALL_FLUX**n * x * (2.0 - n - (1.0 - n) * x))


@njit(cache=True, error_model="numpy")
def neutral(site: Array) -> None:
    """Sources to 0, factors to 1."""
    site[:] = 0.0
    site[FEED_FACTOR] = site[INJECTOR_FACTOR] = site[REGRESSION_FACTOR] = 1.0
    site[TEMPERATURE_FACTOR] = site[THROAT_FACTOR] = site[THRUST_FACTOR] = 1.0


@njit(cache=True, error_model="numpy")
def _act(terms: NDArray[np.int64], hook: int, t: float, env: Array, c: Array, y: Array, site: Array, dy: Array) -> None:
    for k in range(terms.shape[0]):
        p_at, x_at = terms[k, PARAMETERS_AT], terms[k, STATES_AT]
        call_term(terms[k, ADDRESS], hook, t, env, c, p_at, y, x_at, site, dy)  # type: ignore[call-arg]


@njit(cache=True, error_model="numpy")
def chamber_gas(gas: Grid, c: Array, y: Array, guess: float) -> tuple[float, float, float, float, float, float]:
    """p, R T, gamma, mass, O/F and oxidizer enthalpy of what the chamber holds: burnt gas, later cold gas too."""
    volume = c[DEAD_VOLUME] + pi * y[RADIUS] * y[RADIUS] * c[GRAIN_LENGTH]
    entered = y[OXIDIZER] + y[CHAMBER_NITROGEN]
    hot = max(entered + y[FUEL], LEAST_GAS)
    ratio = min(max(entered, LEAST_GAS) / max(y[FUEL], LEAST_GAS), 1e4)
    share = y[CHAMBER_NITROGEN] / max(entered, LEAST_GAS) if y[CHAMBER_NITROGEN] > 0.0 else 0.0
    h = c[OXIDIZER_ENTHALPY]
    if np.isnan(h):
        h = y[ENTHALPY] / max(y[OXIDIZER], LEAST_GAS)
    p, rt, gamma = chamber_pressure(gas, hot, volume, np.log(ratio), h, min(share, 1.0), guess)
    cold = max(y[COLD], 0.0)
    mass = hot + cold
    if cold > 0.0:
        p += max(y[COLD_ENERGY], 0.0) / volume
        rt, gamma = p * volume / mass, (hot * gamma + cold * COLD_GAMMA) / mass
    return p, rt, gamma, mass, ratio, h


@njit(cache=True, error_model="numpy")
def rates(
    t: float,
    y: Array,
    liquid: bool,
    burning: bool,
    tables: Tables,
    c: Array,
    terms: NDArray[np.int64],
    work: Work,
    dy: Array,
    out: Array,
) -> None:
    """dy/dt and OUTPUTS in one phase; ``work`` is scratch: arrays of the lengths of ENVIRONMENT and SITES."""
    sat, gas, drag_table = tables
    env, site = work
    neutral(site)
    any_terms = terms.shape[0] > 0
    for i in range(len(STATES), y.size):
        dy[i] = 0.0
    volume, port = c[VOLUME], y[RADIUS]
    if c[FLIES] > 0.0:
        ambient, _, _ = air(y[ALTITUDE])
    else:
        ambient = c[AMBIENT_PRESSURE]
    # tank
    nitrogen = y[NITROGEN]
    by_mass = by_temperature = 0.0
    t_vapor = min(max(y[TEMPERATURE], COLDEST_VAPOR), WARMEST_VAPOR)
    if liquid:
        p_t, density, m_l, by_mass, by_temperature, h_leaving = saturated_tank(sat, volume, y[TANK], y[TEMPERATURE])
        if nitrogen > 0.0:
            p_t += nitrogen * SPECIFIC_NITROGEN * y[TEMPERATURE] / max(volume - m_l / density, 1e-9)
        tank_share = 0.0
    else:
        m_l, density = 0.0, (y[TANK] + nitrogen) / volume
        p_t = y[COMPRESSIBILITY] * SPECIFIC_GAS_CONSTANT * y[TEMPERATURE] * y[TANK] / volume
        p_t += nitrogen * SPECIFIC_NITROGEN * y[TEMPERATURE] / volume
        tank_share = nitrogen / (y[TANK] + nitrogen)
        h_leaving = 0.0
        if np.isnan(c[OXIDIZER_ENTHALPY]):
            h_leaving = evaluate(sat[0], sat[1], sat[2], sat[3], VAPOR_ENTHALPY, t_vapor)[0]
    if any_terms:
        env[IS_LIQUID], env[IS_BURNING], env[P_AMBIENT] = (1.0 if liquid else 0.0), (1.0 if burning else 0.0), ambient
        env[P_TANK], env[T_TANK], env[M_TANK], env[M_LIQUID] = p_t, y[TEMPERATURE], y[TANK], m_l
        env[M_NITROGEN] = nitrogen
        env[PORT_RADIUS], env[RHO_FEED] = port, density
        _act(terms, AT_TANK, t, env, c, y, site, dy)
        p_t += site[TANK_PRESSURE]
        env[P_TANK] = p_t
    # chamber
    p_c, rt, gamma, mass, ratio, h = chamber_gas(gas, c, y, ambient)
    if any_terms:
        env[P_CHAMBER], env[RT_CHAMBER], env[GAMMA_CHAMBER], env[OF_RATIO] = p_c, rt, gamma, ratio
        env[HOT_SHARE] = 1.0 - max(y[COLD], 0.0) / mass
        _act(terms, AT_CHAMBER, t, env, c, y, site, dy)
        p_c *= site[TEMPERATURE_FACTOR]
        rt *= site[TEMPERATURE_FACTOR]
        env[P_CHAMBER], env[RT_CHAMBER] = p_c, rt
        _act(terms, AT_FLOW, t, env, c, y, site, dy)
    # feed line and injector
    drop = p_t - p_c - site[FEED_LOSS]
    if c[LIQUID_LOSS] >= 0.0:
        loss = c[LIQUID_LOSS] if liquid else c[VAPOR_LOSS]
        flow = mass_flow(c[AREA], density, drop - loss) * site[INJECTOR_FACTOR]
    else:
        factor = c[LOSS_FACTOR] * site[FEED_FACTOR]
        flow = mass_flow_with_feed(c[AREA], factor, density, drop) * site[INJECTOR_FACTOR]
        loss = factor * flow * flow / density
    # grain
    opening = c[REGRESSION_A] * flux_power(flow / (pi * port * port), c[REGRESSION_N]) if burning else 0.0
    surface = 2.0 * pi * port * c[GRAIN_LENGTH] * c[FUEL_DENSITY]
    if any_terms:
        env[OXIDIZER_FLOW], env[FUEL_FLOW], env[P_RUN] = flow, surface * opening, p_t - loss - site[FEED_LOSS]
        _act(terms, RATES, t, env, c, y, site, dy)
        opening *= site[REGRESSION_FACTOR]
    fuel_flow = surface * opening + site[FUEL_SOURCE]
    # nozzle
    nozzle, thrust, _, _, _ = expand(gamma, rt, p_c, ambient, c[THROAT_AREA] * site[THROAT_FACTOR], c[EXIT_AREA])
    thrust *= site[THRUST_FACTOR]
    # rates of the tank
    outflow = flow + site[TANK_LEAK]
    inert = tank_share * outflow
    dy[TANK] = inert - outflow
    dy[NITROGEN] = site[NITROGEN_INFLOW] - inert
    if liquid:
        dy[TEMPERATURE] = (site[TANK_HEAT] + outflow * (by_mass - h_leaving)) / by_temperature
    else:
        held = y[TANK] + nitrogen
        dy[TEMPERATURE] = y[TEMPERATURE] * (y[EXPONENT] - 1.0) * -outflow / held
        if site[TANK_HEAT] != 0.0:
            cv = np.exp(evaluate(sat[0], sat[1], sat[2], sat[3], LN_VAPOR_CV, t_vapor)[0])
            dy[TEMPERATURE] += site[TANK_HEAT] / (y[TANK] * cv + nitrogen * NITROGEN_CV)
    dy[RADIUS] = opening
    # rates of the chamber: what enters burns, or after burn-out stays cold
    leaving = nozzle / mass
    fresh = flow * (1.0 - tank_share)
    into = fresh + site[OXIDIZER_SOURCE]
    if burning:
        dy[OXIDIZER] = into - leaving * y[OXIDIZER]
        dy[CHAMBER_NITROGEN] = flow * tank_share - leaving * y[CHAMBER_NITROGEN]
        dy[ENTHALPY] = into * (FORMATION_OFFSET + h_leaving) - leaving * y[ENTHALPY]
        dy[COLD] = -leaving * y[COLD]
        dy[COLD_ENERGY] = -leaving * y[COLD_ENERGY]
    else:
        dy[OXIDIZER] = site[OXIDIZER_SOURCE] - leaving * y[OXIDIZER]
        dy[CHAMBER_NITROGEN] = -leaving * y[CHAMBER_NITROGEN]
        dy[ENTHALPY] = site[OXIDIZER_SOURCE] * (FORMATION_OFFSET + h_leaving) - leaving * y[ENTHALPY]
        constant = tank_share * SPECIFIC_NITROGEN + (1.0 - tank_share) * SPECIFIC_GAS_CONSTANT
        dy[COLD] = flow - leaving * y[COLD]
        dy[COLD_ENERGY] = flow * constant * y[TEMPERATURE] - leaving * y[COLD_ENERGY]
    dy[FUEL] = fuel_flow - leaving * y[FUEL]
    dy[COMPRESSIBILITY] = 0.0
    dy[EXPONENT] = 0.0
    dy[IMPULSE] = thrust
    # ascent
    dy[ALTITUDE] = dy[SPEED] = 0.0
    if c[FLIES] > 0.0:
        fuel = c[FUEL_DENSITY] * pi * c[GRAIN_LENGTH] * (c[OUTER_RADIUS] * c[OUTER_RADIUS] - port * port)
        total = c[DRY_MASS] + y[TANK] + nitrogen + fuel + mass
        pull = total * STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + y[ALTITUDE])) ** 2 * c[CLIMB]
        net = thrust - drag(y[ALTITUDE], y[SPEED], c[DRAG_AREA], drag_table) - pull
        # on its pad the rocket stands; what lifts it is the thrust alone
        stands = y[ALTITUDE] <= c[LAUNCH_ALTITUDE] + PAD
        dy[ALTITUDE] = y[SPEED] * c[CLIMB]
        dy[SPEED] = 0.0 if stands and net <= 0.0 else net / total
    out[O_TANK_PRESSURE], out[O_CHAMBER_PRESSURE], out[O_RT], out[O_THRUST] = p_t, p_c, rt, thrust
    out[O_OXIDIZER_FLOW], out[O_FUEL_FLOW], out[O_NOZZLE_FLOW], out[O_OF] = flow, fuel_flow, nozzle, ratio
    out[O_ACCELERATION], out[O_RUN_PRESSURE] = dy[SPEED], p_t - loss - site[FEED_LOSS]
    out[O_GAMMA], out[O_ENTHALPY], out[O_SHARE], out[O_AMBIENT] = gamma, h, tank_share, ambient
    out[O_NITROGEN_INFLOW], out[O_OUTFLOW] = site[NITROGEN_INFLOW], outflow
