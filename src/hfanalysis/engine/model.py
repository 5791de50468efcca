"""The governing equations of the unsteady engine as one compiled right-hand side (report, chapter 3).

Tank, feed line, injector, grain, chamber, nozzle and the rocket's ascent. The chamber pressure follows from the stored
masses by the gas law. Every equation has its sites (:mod:`hfanalysis.engine.sites`); with no terms active they are the
neutral element and the equations are the report's.

Beyond the report: nitrogen in tank and chamber (only terms bring it in), the enthalpy of the nitrous oxide that is in
the chamber, and, after burn-out, gas that enters unburnt and cold.
"""

from __future__ import annotations

from math import pi
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from hfanalysis.compiled import by_address, caller, compiled, inlined, separate
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
    H_CHAMBER,
    H_LEAVING,
    HOT_SHARE,
    INJECTOR_FACTOR,
    IS_BURNING,
    IS_LIQUID,
    M_CHAMBER,
    M_LIQUID,
    M_NITROGEN,
    M_TANK,
    NITROGEN_INFLOW,
    NITROGEN_SHARE,
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
    U_BY_MASS,
    U_BY_TEMPERATURE,
    call_term,
)
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, saturated_tank
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, drag
from hfanalysis.thermo.air import air
from hfanalysis.thermo.combustion import FORMATION_OFFSET
from hfanalysis.thermo.combustion_table import Grid, chamber_pressure
from hfanalysis.thermo.constants import GAS_CONSTANT, NITROGEN_MOLAR_MASS
from hfanalysis.thermo.saturation import LN_VAPOR_CV, VAPOR_ENTHALPY, VAPOR_GRUENEISEN, evaluate

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Table = tuple[Array, float, float, float]


class Equations(NamedTuple):
    """An engine as compiled code reads it.

    Addresses of :func:`rates` and of the events' function; saturated nitrous oxide, burnt gas and the drag coefficient
    over Mach number as tables; CONSTANTS and the effects' parameters; the active terms; ENVIRONMENT and SITES, which
    every evaluation writes anew; the KEPT parts of an evaluation.
    """

    rates: int
    events: int
    saturation: Table
    gas: Grid
    drag: Array
    c: Array
    terms: Integers
    env: Array
    site: Array
    kept: Array


_VECTOR, _REAL, _FLAG = types.float64[::1], types.float64, types.boolean
_TUPLE: Any = types.Tuple
_TABLE = _TUPLE((types.float64[:, :, ::1], _REAL, _REAL, _REAL))
_GRID = _TUPLE((types.float64[:, ::1], types.float64[:, ::1], types.float64[:, :, :, ::1]))
EQUATIONS = types.NamedTuple(  # type: ignore[no-untyped-call]
    (types.int64, types.int64, _TABLE, _GRID, types.float64[:, ::1], _VECTOR, types.int64[:, ::1], *[_VECTOR] * 3),
    Equations,
)
EVALUATION = types.none(_REAL, _VECTOR, _FLAG, _FLAG, types.int64, _VECTOR, _VECTOR)
address_of, equations_at = by_address(EQUATIONS)
call = caller(EVALUATION)
"""In compiled code, :class:`Equations` are passed on as ``model = address_of(m)``."""

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
    "spare_web", "fuel_end",
)  # fmt: skip
"""SI. A negative liquid_loss stands for the quadratic law, a NaN oxidizer_enthalpy for that of what leaves the tank, a
NaN polytropic_exponent for c_p/c_v when the liquid runs out, a NaN ambient_pressure for that of the altitude, an
infinite fuel_end [s] for the end of the web; parameters of effects follow."""

(VOLUME, AREA, LOSS_FACTOR, POLYTROPIC_EXPONENT, LIQUID_LOSS, VAPOR_LOSS, GRAIN_LENGTH, REGRESSION_A, REGRESSION_N,
 DEAD_VOLUME, FUEL_DENSITY, THROAT_AREA, EXIT_AREA, OUTER_RADIUS, OXIDIZER_ENTHALPY, DRY_MASS, DRAG_AREA, CLIMB,
 LAUNCH_ALTITUDE, AMBIENT_PRESSURE, FLIES, FUEL_MASS, OXIDIZER_MASS, INITIAL_TEMPERATURE,
 SPARE_WEB, FUEL_END) = range(26)  # fmt: skip

KEEPS, KEPT_TANK, KEPT_CHAMBER, KEPT_NOZZLE, KEPT = 0, 1, 10, 22, 30
"""Where in :attr:`Equations.kept` stands whether evaluations leave their parts there, where those of tank, chamber and
nozzle begin (what was asked, then what was answered), and how many numbers there are. The same question gets the same
answer without work: most columns of a Jacobian leave two of the three alone."""


def nothing_kept() -> Array:
    """:attr:`Equations.kept` before the first evaluation."""
    kept = np.full(KEPT, np.nan)
    kept[KEEPS] = 1.0
    return kept


PAD = 1e-3
"""Height [m] above which a rocket has left its pad."""

SMALL_FLUX = 0.01
"""Oxidizer flux [kg/(m^2 s)] below which regression is bent to a finite slope."""

LEAST_GAS = 1e-9
"""Mass [kg] of burnt gas below which its mixture is no longer asked for."""

TYPICAL_RT = 0.9e6
"""R T [J/kg] of burnt gas, where the search for its pressure begins."""

COLD_GAMMA = 1.3
"""Heat capacity ratio of unburnt gas: nitrous oxide has 1.27, nitrogen 1.40 (ideal gases at 298 K)."""

SPECIFIC_NITROGEN = GAS_CONSTANT / NITROGEN_MOLAR_MASS
NITROGEN_CV = 2.5 * SPECIFIC_NITROGEN

LEAST_ULLAGE = 1e-9
"""Volume [m^3] that nitrogen in a full tank has at least."""

COLDEST_VAPOR, WARMEST_VAPOR = 185.0, 305.0
"""Temperatures [K] between which the vapour's heat capacity and enthalpy are read from the saturation line."""


@compiled
def flux_power(flux: float, n: float) -> float:
    """G^n, below SMALL_FLUX the parabola that joins it smoothly and ends in 0 with a finite slope."""
    if flux >= SMALL_FLUX:
        return float(flux**n)
    x = max(flux, 0.0) / SMALL_FLUX
    return float(SMALL_FLUX**n * x * (2.0 - n - (1.0 - n) * x))


@compiled
def neutral(site: Array) -> None:
    """Sources to 0, factors to 1."""
    site[:] = 0.0
    site[FEED_FACTOR] = site[INJECTOR_FACTOR] = site[REGRESSION_FACTOR] = 1.0
    site[TEMPERATURE_FACTOR] = site[THROAT_FACTOR] = site[THRUST_FACTOR] = 1.0


@inlined
def act(hook: int, t: float, y: Array, m: Equations, dy: Array) -> None:
    """Every active term at one hook."""
    for k in range(m.terms.shape[0]):
        p_at, x_at = m.terms[k, PARAMETERS_AT], m.terms[k, STATES_AT]
        call_term(m.terms[k, ADDRESS], hook, t, m.env, m.c, p_at, y, x_at, m.site, dy)  # type: ignore[call-arg]


@compiled
def evaluate_rates(t: float, y: Array, liquid: bool, burning: bool, m: Equations, dy: Array, out: Array) -> None:
    """:func:`rates`, for Python."""
    call(m.rates, t, y, liquid, burning, address_of(m), dy, out)


@inlined
def rates_at(t: float, y: Array, liquid: bool, burning: bool, model: int, dy: Array, out: Array) -> None:
    """:func:`rates`, for other compiled code: called, not merged into it."""
    call(equations_at(model).rates, t, y, liquid, burning, model, dy, out)


@separate(EVALUATION)
def rates(t: float, y: Array, liquid: bool, burning: bool, model: int, dy: Array, out: Array) -> None:
    """dy/dt and OUTPUTS in one phase; ENVIRONMENT and SITES keep what was found on the way."""
    m = equations_at(model)
    neutral(m.site)
    for i in range(y.size):
        dy[i] = 0.0
    surroundings(y, liquid, burning, m)
    tank_pressure(y, liquid, m)
    act(AT_TANK, t, y, m, dy)
    m.env[P_TANK] += m.site[TANK_PRESSURE]
    chamber(y, m)
    act(AT_CHAMBER, t, y, m, dy)
    m.env[P_CHAMBER] *= m.site[TEMPERATURE_FACTOR]
    m.env[RT_CHAMBER] *= m.site[TEMPERATURE_FACTOR]
    act(AT_FLOW, t, y, m, dy)
    feed(liquid, m)
    opening, surface = grain(y, burning, m)
    act(RATES, t, y, m, dy)
    opening *= m.site[REGRESSION_FACTOR]
    m.env[FUEL_FLOW] = surface * opening + m.site[FUEL_SOURCE]
    dy[RADIUS] = opening
    ejected, thrust = nozzle(m)
    dy[IMPULSE] = thrust
    tank_rates(y, liquid, m, dy)
    chamber_rates(y, burning, ejected, m, dy)
    ascent(y, thrust, m, dy)
    report(ejected, thrust, dy, m, out)


@inlined
def asked(kept: Array, at: int, question: tuple[float, ...]) -> bool:
    """Whether the kept answer is to this very question, to the bit."""
    same = True
    for i in range(len(question)):
        same = same and kept[at + i] == question[i]
    return same


@inlined
def keep(kept: Array, at: int, question: tuple[float, ...], answer: tuple[float, ...]) -> None:
    """Keep question and answer, if this evaluation is one to keep."""
    if kept[KEEPS] > 0.0:
        for i in range(len(question)):
            kept[at + i] = question[i]
        for i in range(len(answer)):
            kept[at + len(question) + i] = answer[i]


@inlined
def surroundings(y: Array, liquid: bool, burning: bool, m: Equations) -> None:
    """Phase, ambient pressure, and what of the state terms may read."""
    env = m.env
    env[IS_LIQUID], env[IS_BURNING] = (1.0 if liquid else 0.0), (1.0 if burning else 0.0)
    env[P_AMBIENT] = air(y[ALTITUDE])[0] if m.c[FLIES] > 0.0 else m.c[AMBIENT_PRESSURE]
    env[T_TANK], env[M_TANK], env[M_NITROGEN], env[PORT_RADIUS] = y[TEMPERATURE], y[TANK], y[NITROGEN], y[RADIUS]


@inlined
def tank_pressure(y: Array, liquid: bool, m: Equations) -> None:
    """Pressure, density and enthalpy of what leaves the tank."""
    if liquid:
        saturated(y, m)
    else:
        superheated(y, m)


@inlined
def saturated(y: Array, m: Equations) -> None:
    """Liquid under its vapour, with nitrogen in the ullage."""
    env, volume = m.env, m.c[VOLUME]
    p, density, liquid, by_mass, by_temperature, h = tank_of(m, volume, y[TANK], y[TEMPERATURE])
    if y[NITROGEN] > 0.0:
        p += y[NITROGEN] * SPECIFIC_NITROGEN * y[TEMPERATURE] / max(volume - liquid / density, LEAST_ULLAGE)
    env[P_TANK], env[RHO_FEED], env[M_LIQUID], env[H_LEAVING], env[NITROGEN_SHARE] = p, density, liquid, h, 0.0
    env[U_BY_MASS], env[U_BY_TEMPERATURE] = by_mass, by_temperature


@inlined
def tank_of(m: Equations, *question: float) -> tuple[float, float, float, float, float, float]:
    """:func:`saturated_tank` of volume, mass and temperature, or what is kept of it."""
    kept, at = m.kept, KEPT_TANK + 3
    if asked(kept, KEPT_TANK, question):
        return kept[at], kept[at + 1], kept[at + 2], kept[at + 3], kept[at + 4], kept[at + 5]
    answer = saturated_tank(m.saturation, *question)
    keep(kept, KEPT_TANK, question, answer)
    return answer


@inlined
def superheated(y: Array, m: Equations) -> None:
    """Vapour and nitrogen, mixed."""
    env, volume, held = m.env, m.c[VOLUME], y[TANK] + y[NITROGEN]
    by_pressure = y[COMPRESSIBILITY] * SPECIFIC_GAS_CONSTANT * y[TANK] + SPECIFIC_NITROGEN * y[NITROGEN]
    env[P_TANK], env[RHO_FEED], env[M_LIQUID] = by_pressure * y[TEMPERATURE] / volume, held / volume, 0.0
    env[NITROGEN_SHARE], env[H_LEAVING] = y[NITROGEN] / held, 0.0
    if np.isnan(m.c[OXIDIZER_ENTHALPY]):
        env[H_LEAVING] = vapor(m, VAPOR_ENTHALPY, y[TEMPERATURE])


@inlined
def vapor(m: Equations, row: int, temperature: float) -> float:
    """A row of the table at the vapour's temperature, inside the range where it is read."""
    inside = min(max(temperature, COLDEST_VAPOR), WARMEST_VAPOR)
    table, start, step, critical = m.saturation
    return float(evaluate(table, start, step, critical, row, inside)[0])


@inlined
def chamber(y: Array, m: Equations) -> None:
    """Pressure and gas of the chamber."""
    env = m.env
    volume = m.c[DEAD_VOLUME] + pi * y[RADIUS] * y[RADIUS] * m.c[GRAIN_LENGTH]
    h = m.c[OXIDIZER_ENTHALPY]
    if np.isnan(h):
        h = y[ENTHALPY] / max(y[OXIDIZER], LEAST_GAS)
    p, rt, gamma, mass, ratio = gas_of(m, y[OXIDIZER], y[FUEL], y[CHAMBER_NITROGEN], y[COLD], y[COLD_ENERGY], h, volume)
    env[P_CHAMBER], env[RT_CHAMBER], env[GAMMA_CHAMBER], env[OF_RATIO] = p, rt, gamma, ratio
    env[M_CHAMBER], env[H_CHAMBER], env[HOT_SHARE] = mass, h, 1.0 - max(y[COLD], 0.0) / mass


@inlined
def gas_of(m: Equations, *question: float) -> tuple[float, float, float, float, float]:
    """:func:`chamber_gas`, or what is kept of it."""
    kept, at = m.kept, KEPT_CHAMBER + 7
    if asked(kept, KEPT_CHAMBER, question):
        return kept[at], kept[at + 1], kept[at + 2], kept[at + 3], kept[at + 4]
    answer = chamber_gas(m.gas, *question)
    keep(kept, KEPT_CHAMBER, question, answer)
    return answer


@inlined
def chamber_gas(
    gas: Grid, oxidizer: float, fuel: float, nitrogen: float, cold: float, cold_energy: float, h: float, volume: float
) -> tuple[float, float, float, float, float]:
    """p, R T, gamma, mass and O/F of what the chamber holds: burnt gas, later cold gas too."""
    entered = oxidizer + nitrogen
    hot = max(entered + fuel, LEAST_GAS)
    ratio = min(max(entered, LEAST_GAS) / max(fuel, LEAST_GAS), 1e4)
    share = nitrogen / max(entered, LEAST_GAS) if nitrogen > 0.0 else 0.0
    guess = hot * TYPICAL_RT / volume
    p, rt, gamma = chamber_pressure(gas, hot, volume, np.log(ratio), h, min(share, 1.0), guess)
    unburnt = max(cold, 0.0)
    mass = hot + unburnt
    if unburnt > 0.0:
        p += max(cold_energy, 0.0) / volume
        rt, gamma = p * volume / mass, (hot * gamma + unburnt * COLD_GAMMA) / mass
    return p, rt, gamma, mass, ratio


@inlined
def feed(liquid: bool, m: Equations) -> None:
    """Flow through feed line and injector, and the pressure between them."""
    c, env, site = m.c, m.env, m.site
    drop = env[P_TANK] - env[P_CHAMBER] - site[FEED_LOSS]
    if c[LIQUID_LOSS] >= 0.0:
        loss = c[LIQUID_LOSS] if liquid else c[VAPOR_LOSS]
        flow = mass_flow(c[AREA], env[RHO_FEED], drop - loss) * site[INJECTOR_FACTOR]
    else:
        factor = c[LOSS_FACTOR] * site[FEED_FACTOR]
        flow = mass_flow_with_feed(c[AREA], factor, env[RHO_FEED], drop) * site[INJECTOR_FACTOR]
        loss = factor * flow * flow / env[RHO_FEED]
    env[OXIDIZER_FLOW], env[P_RUN] = flow, env[P_TANK] - loss - site[FEED_LOSS]


@inlined
def grain(y: Array, burning: bool, m: Equations) -> tuple[float, float]:
    """Regression rate [m/s], and fuel that it frees per metre [kg/m]."""
    port = y[RADIUS]
    flux = m.env[OXIDIZER_FLOW] / (pi * port * port)
    opening = m.c[REGRESSION_A] * flux_power(flux, m.c[REGRESSION_N]) if burning else 0.0
    surface = 2.0 * pi * port * m.c[GRAIN_LENGTH] * m.c[FUEL_DENSITY]
    m.env[FUEL_FLOW] = surface * opening
    return opening, surface


@inlined
def nozzle(m: Equations) -> tuple[float, float]:
    """Mass flow [kg/s] and thrust [N]."""
    env, throat = m.env, m.c[THROAT_AREA] * m.site[THROAT_FACTOR]
    flow, thrust = expanded(
        m, env[GAMMA_CHAMBER], env[RT_CHAMBER], env[P_CHAMBER], env[P_AMBIENT], throat, m.c[EXIT_AREA]
    )
    return flow, thrust * m.site[THRUST_FACTOR]


@inlined
def expanded(m: Equations, *question: float) -> tuple[float, float]:
    """Flow and thrust of :func:`expand`, or what is kept of them."""
    kept, at = m.kept, KEPT_NOZZLE + 6
    if asked(kept, KEPT_NOZZLE, question):
        return kept[at], kept[at + 1]
    answer = expand(*question)[:2]
    keep(kept, KEPT_NOZZLE, question, answer)
    return answer


@inlined
def tank_rates(y: Array, liquid: bool, m: Equations, dy: Array) -> None:
    """Masses and temperature of the tank (report, eq. 3.9 and the polytropic vapour).

    The polytropic vapour is as warm as its pressure asks for at the compressibility with which it began. Heat Q raises
    the pressure of a real one by G Q/V (Grueneisen's parameter G, about 0.3), which an ideal gas of its c_v would do by
    Z R Q/(c_v V): half as much near 275 K. So it warms by what that pressure asks for.
    """
    env, site, outflow = m.env, m.site, m.env[OXIDIZER_FLOW] + m.site[TANK_LEAK]
    inert = env[NITROGEN_SHARE] * outflow
    dy[TANK] = inert - outflow
    dy[NITROGEN] = site[NITROGEN_INFLOW] - inert
    if liquid:
        dy[TEMPERATURE] = (site[TANK_HEAT] + outflow * (env[U_BY_MASS] - env[H_LEAVING])) / env[U_BY_TEMPERATURE]
        return
    dy[TEMPERATURE] = y[TEMPERATURE] * (y[EXPONENT] - 1.0) * -outflow / (y[TANK] + y[NITROGEN])
    if site[TANK_HEAT] != 0.0:
        cv, g = np.exp(vapor(m, LN_VAPOR_CV, y[TEMPERATURE])), vapor(m, VAPOR_GRUENEISEN, y[TEMPERATURE])
        warming = site[TANK_HEAT] / (y[TANK] * cv + y[NITROGEN] * NITROGEN_CV)
        held = y[COMPRESSIBILITY] * SPECIFIC_GAS_CONSTANT * y[TANK] + SPECIFIC_NITROGEN * y[NITROGEN]
        dy[TEMPERATURE] += warming * (g * cv * y[TANK] + SPECIFIC_NITROGEN * y[NITROGEN]) / held


@inlined
def chamber_rates(y: Array, burning: bool, ejected: float, m: Equations, dy: Array) -> None:
    """What enters burns, or after burn-out stays cold; all leaves in the same proportion."""
    env, leaving = m.env, ejected / m.env[M_CHAMBER]
    into, share = m.site[OXIDIZER_SOURCE], env[NITROGEN_SHARE]
    for i in (OXIDIZER, CHAMBER_NITROGEN, ENTHALPY, COLD, COLD_ENERGY, FUEL):
        dy[i] = -leaving * y[i]
    if burning:
        into += env[OXIDIZER_FLOW] * (1.0 - share)
        dy[CHAMBER_NITROGEN] += env[OXIDIZER_FLOW] * share
    else:
        constant = share * SPECIFIC_NITROGEN + (1.0 - share) * SPECIFIC_GAS_CONSTANT
        dy[COLD] += env[OXIDIZER_FLOW]
        dy[COLD_ENERGY] += env[OXIDIZER_FLOW] * constant * y[TEMPERATURE]
    dy[OXIDIZER] += into
    dy[ENTHALPY] += into * (FORMATION_OFFSET + env[H_LEAVING])
    dy[FUEL] += env[FUEL_FLOW]


@inlined
def ascent(y: Array, thrust: float, m: Equations, dy: Array) -> None:
    """The rocket climbs; on its pad it stands, and what lifts it is the thrust alone."""
    c, port = m.c, y[RADIUS]
    if not c[FLIES] > 0.0:
        return
    fuel = c[FUEL_DENSITY] * pi * c[GRAIN_LENGTH] * (c[OUTER_RADIUS] * c[OUTER_RADIUS] - port * port)
    total = c[DRY_MASS] + y[TANK] + y[NITROGEN] + fuel + m.env[M_CHAMBER]
    pull = total * STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + y[ALTITUDE])) ** 2 * c[CLIMB]
    net = thrust - drag(y[ALTITUDE], y[SPEED], c[DRAG_AREA], m.drag) - pull
    stands = y[ALTITUDE] <= c[LAUNCH_ALTITUDE] + PAD
    dy[ALTITUDE] = y[SPEED] * c[CLIMB]
    dy[SPEED] = 0.0 if stands and net <= 0.0 else net / total


@inlined
def report(ejected: float, thrust: float, dy: Array, m: Equations, out: Array) -> None:
    """OUTPUTS."""
    env, site = m.env, m.site
    out[O_TANK_PRESSURE], out[O_CHAMBER_PRESSURE], out[O_RT] = env[P_TANK], env[P_CHAMBER], env[RT_CHAMBER]
    out[O_THRUST], out[O_OXIDIZER_FLOW], out[O_FUEL_FLOW] = thrust, env[OXIDIZER_FLOW], env[FUEL_FLOW]
    out[O_NOZZLE_FLOW], out[O_OF], out[O_ACCELERATION] = ejected, env[OF_RATIO], dy[SPEED]
    out[O_RUN_PRESSURE], out[O_GAMMA], out[O_ENTHALPY] = env[P_RUN], env[GAMMA_CHAMBER], env[H_CHAMBER]
    out[O_SHARE], out[O_AMBIENT] = env[NITROGEN_SHARE], env[P_AMBIENT]
    out[O_NITROGEN_INFLOW], out[O_OUTFLOW] = site[NITROGEN_INFLOW], env[OXIDIZER_FLOW] + site[TANK_LEAK]
