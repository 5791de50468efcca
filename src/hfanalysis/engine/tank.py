"""The self-pressurizing oxidizer tank: liquid and vapor in equilibrium, then vapor alone.

Report, section 3.1.2 ("Self-Pressurizing Oxidizer Tank"). The saturated tank is written in its total mass M and its
temperature T; with M and T given, the volume fixes how much of it is liquid (eq. 3.4). The report's three linear
equations (mass, volume, energy) then have the closed form of :func:`temperature_rate`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.compiled import Real, compiled, inlined, inner, law
from hfanalysis.engine import equations as eq
from hfanalysis.engine import sites as at
from hfanalysis.engine.equations import Equations, Table, asked, at_saturation, keep
from hfanalysis.thermo.constants import GAS_CONSTANT, NITROGEN_MOLAR_MASS, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.saturation import (
    LIQUID_ENERGY,
    LIQUID_ENTHALPY,
    LIQUID_VOLUME,
    LN_PRESSURE,
    LN_VAPOR_CP,
    LN_VAPOR_CV,
    LN_VAPOR_VOLUME,
    VAPOR_ENERGY,
    VAPOR_ENTHALPY,
    VAPOR_GRUENEISEN,
    Property,
    Saturation,
    evaluate,
    place,
    row_at,
)

SPECIFIC_GAS_CONSTANT = GAS_CONSTANT / OXIDIZER_MOLAR_MASS
"""R_u / W_o of nitrous oxide [J/(kg K)]."""

TEMPERATURE_STEP = 0.1
"""Steps [K] at most along an adiabatic blowdown. Evidence: masses are those of a run of the tank to 1e-5
(tests/engine/test_tank.py)."""

SPECIFIC_NITROGEN = GAS_CONSTANT / NITROGEN_MOLAR_MASS
"""R_u / W of nitrogen [J/(kg K)]."""

NITROGEN_CV = 2.5 * SPECIFIC_NITROGEN
"""c_v of nitrogen [J/(kg K)]. Source: a diatomic ideal gas has 5/2 R."""

LEAST_ULLAGE = 1e-9
"""Volume [m^3] that nitrogen in a full tank has at least."""

COLDEST_VAPOR, WARMEST_VAPOR = 185.0, 305.0
"""Temperatures [K] between which the vapor's heat capacity and enthalpy are read from the saturation line. Source: the
line itself: it begins at the triple point (182.3 K) and c_p has no bound at its end (309.5 K)."""


@dataclass(frozen=True)
class TankSplit:
    """How a saturated tank's content divides: masses [kg] of the phases (negative where it cannot be saturated)."""

    liquid: float
    vapor: float


def split(saturation: Saturation, volume: float, mass: float, temperature: float) -> TankSplit:
    """Liquid and vapor mass [kg] of a saturated tank: V = m_l v_l + m_v v_v (report, eq. 3.4).

    ``volume`` [m^3], total ``mass`` [kg], ``temperature`` [K]. A negative liquid mass means superheated vapor, a
    negative vapor mass a tank so full that the liquid is compressed.
    """
    liquid = liquid_mass(saturation.kernel_table, volume, mass, temperature)
    return TankSplit(liquid, mass - liquid)


def nitrogen_pressure(saturation: Saturation, volume: float, mass: float, temperature: float, nitrogen: float) -> float:
    """What ``nitrogen`` [kg] in the ullage of a saturated tank adds to its pressure [Pa]; a tank of ``volume`` [m^3]
    with ``mass`` [kg] of nitrous oxide at ``temperature`` [K]."""
    if nitrogen == 0.0:
        return 0.0
    liquid = split(saturation, volume, mass, temperature).liquid * float(saturation.liquid_volume(temperature)[0])
    return nitrogen * SPECIFIC_NITROGEN * temperature / max(volume - liquid, LEAST_ULLAGE)


@law
def compressibility(pressure: Real, volume: Real, mass: Real, temperature: Real) -> Real:
    """Z = p V / (m R T) [-] of the vapor at the end of the liquid (report, eq. 4.2); [Pa], [m^3], [kg], [K]."""
    return pressure * volume / (mass * SPECIFIC_GAS_CONSTANT * temperature)


@law
def polytropic(pressure: Real, start: Real, exponent: Real, mass: Real) -> Real:
    """p = p_v (M/M_v)^m [Pa] of the vapor that is left (report, eq. 3.11), from ``pressure`` [Pa] and ``start`` [kg]
    on.

    >>> round(polytropic(38e5, 2.4, 1.15, 1.2) / 1e5, 2)
    17.12
    """
    return pressure * (mass / start) ** exponent


@law
def liquid_of(volume: Real, mass: Real, v_l: Real, v_v: Real) -> Real:
    """m_l = (M v_v - V) / (v_v - v_l) [kg], of which V = m_l v_l + m_v v_v (report, eq. 3.4); [m^3], [kg], [m^3/kg]."""
    return (mass * v_v - volume) / (v_v - v_l)


def internal_energy(saturation: Saturation, volume: ArrayLike, mass: ArrayLike, temperature: ArrayLike) -> Array:
    """U = m_l u_l + m_v u_v [J] of a saturated tank of ``volume`` [m^3] with ``mass`` [kg] at ``temperature`` [K].

    Numbers, or arrays of one shape.
    """
    v_l, v_v = saturation.liquid_volume(temperature)[0], saturation.vapor_volume(temperature)[0]
    u_l, u_v = (saturation.energy(p, temperature)[0] for p in (Property.LIQUID_ENERGY, Property.VAPOR_ENERGY))
    liquid = liquid_of(np.asarray(volume), np.asarray(mass), v_l, v_v)
    return np.asarray(liquid * u_l + (mass - liquid) * u_v)


def mass_along_blowdown(saturation: Saturation, volume: float, t_empty: float, temperatures: Array) -> Array:
    """Total mass [kg] that an adiabatic saturated tank held at each temperature [K] before it ran dry at t_empty.

    From M = V / v_v(t_empty) upwards. No flow measurement enters: the thermodynamics alone tie mass to temperature.
    Shape as ``temperatures``, which must not fall below ``t_empty``.
    """
    wanted, out = np.asarray(temperatures, dtype=np.float64), np.empty(np.shape(temperatures))
    order = np.argsort(wanted)
    mass = volume * float(saturation.vapor_density(t_empty))
    out[order] = mass_along(saturation.kernel_table, volume, mass, t_empty, wanted[order])
    return out


@compiled
def liquid_mass(table: Table, volume: float, mass: float, temperature: float) -> float:
    """m_l = (M v_v - V) / (v_v - v_l) [kg] of a tank of ``volume`` [m^3] with ``mass`` [kg] at ``temperature`` [K]."""
    v_l, _ = evaluate(*table, LIQUID_VOLUME, temperature)
    v_v = np.exp(evaluate(*table, LN_VAPOR_VOLUME, temperature)[0])
    return float(liquid_of(volume, mass, v_l, v_v))


@compiled
def energy_derivatives(table: Table, volume: float, mass: float, temperature: float) -> tuple[float, float, float]:
    """U_M [J/kg], U_T [J/K] of the saturated tank's internal energy, and the liquid's enthalpy h_l [J/kg]."""
    _, _, _, by_mass, by_temperature, h_l = saturated_tank(table, volume, mass, temperature)
    return by_mass, by_temperature, h_l


@compiled
def saturated_tank(
    table: Table, volume: float, mass: float, temperature: float
) -> tuple[float, float, float, float, float, float]:
    """p_sat [Pa], rho_l [kg/m^3], m_l [kg], U_M [J/kg], U_T [J/K], h_l [J/kg]: the whole tank from one place in the
    table."""
    rows = table[0]
    k, x, d = place(*table, temperature)
    ln_p, _ = row_at(rows, LN_PRESSURE, k, x, d)
    v_l, v_l_slope = row_at(rows, LIQUID_VOLUME, k, x, d)
    ln_v_v, ln_v_v_slope = row_at(rows, LN_VAPOR_VOLUME, k, x, d)
    u_l, u_l_slope = row_at(rows, LIQUID_ENERGY, k, x, d)
    u_v, u_v_slope = row_at(rows, VAPOR_ENERGY, k, x, d)
    h_l, _ = row_at(rows, LIQUID_ENTHALPY, k, x, d)
    v_v = np.exp(ln_v_v)
    gap = v_v - v_l
    m_l = liquid_of(volume, mass, v_l, v_v)
    m_v = mass - m_l
    m_l_slope = (m_l * v_l_slope + m_v * v_v * ln_v_v_slope) / gap
    by_mass = (u_l * v_v - u_v * v_l) / gap
    by_temperature = m_l * u_l_slope + m_v * u_v_slope + (u_l - u_v) * m_l_slope
    return np.exp(ln_p), 1.0 / v_l, m_l, by_mass, by_temperature, h_l


@law
def temperature_rate(by_mass: Real, by_temperature: Real, h_l: Real, outflow: Real, heat: Real) -> Real:
    """dT/dt [K/s] of the saturated tank losing liquid at ``outflow`` [kg/s] and receiving ``heat`` [W].

    From d(M, T)/dt in dU/dt = -mdot h_l + Qdot (report, eq. 3.7 with a heat term); the first three are those of
    :func:`energy_derivatives`.
    """
    return (heat + outflow * (by_mass - h_l)) / by_temperature


@compiled
def mass_along(table: Table, volume: float, mass: float, temperature: float, temperatures: Array) -> Array:
    """Mass [kg] of an adiabatic saturated tank at one of ``temperatures`` (n,) [K] after the other, from ``mass`` [kg]
    on.

    dM/dT = U_T / (h_l - U_M) does not ask how fast it cools. ``volume`` [m^3]. Runge-Kutta steps of TEMPERATURE_STEP at
    most.
    """
    out = np.empty_like(temperatures)
    for i in range(temperatures.size):
        steps = max(int(np.ceil(abs(temperatures[i] - temperature) / TEMPERATURE_STEP)), 1)
        h = (temperatures[i] - temperature) / steps
        for _ in range(steps):
            k1 = along_blowdown(table, volume, mass, temperature)
            k2 = along_blowdown(table, volume, mass + 0.5 * h * k1, temperature + 0.5 * h)
            k3 = along_blowdown(table, volume, mass + 0.5 * h * k2, temperature + 0.5 * h)
            k4 = along_blowdown(table, volume, mass + h * k3, temperature + h)
            mass += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            temperature += h
        out[i] = mass
    return out


@compiled
def along_blowdown(table: Table, volume: float, mass: float, temperature: float) -> float:
    """dM/dT = U_T / (h_l - U_M) [kg/K] of an adiabatic saturated tank that loses liquid: dU = h_l dM."""
    by_mass, by_temperature, h_l = energy_derivatives(table, volume, mass, temperature)
    return by_temperature / (h_l - by_mass)


@inlined
def tank_pressure(y: Array, liquid: bool, m: Equations) -> None:
    """Pressure [Pa], density [kg/m^3] and enthalpy [J/kg] of what leaves the tank, of ``y`` (states,) [SI]."""
    if liquid:
        saturated(y, m)
    else:
        superheated(y, m)


@inlined
def saturated(y: Array, m: Equations) -> None:
    """Liquid under its vapor, with nitrogen in the ullage; ``y`` (states,) [SI]."""
    env, volume = m.env, m.c[eq.VOLUME]
    p, density, liquid, by_mass, by_temperature, h = tank_of(m, volume, y[eq.TANK], y[eq.TEMPERATURE])
    if y[eq.NITROGEN] > 0.0:
        p += y[eq.NITROGEN] * SPECIFIC_NITROGEN * y[eq.TEMPERATURE] / max(volume - liquid / density, LEAST_ULLAGE)
    env[at.P_TANK], env[at.RHO_FEED], env[at.M_LIQUID], env[at.H_LEAVING] = p, density, liquid, h
    env[at.NITROGEN_SHARE] = 0.0
    env[at.U_BY_MASS], env[at.U_BY_TEMPERATURE] = by_mass, by_temperature


@inlined
def tank_of(m: Equations, *question: float) -> tuple[float, float, float, float, float, float]:
    """:func:`saturated_tank` of volume [m^3], mass [kg] and temperature [K], or what is kept of it."""
    kept, at = m.kept, eq.KEPT_TANK + 3
    if asked(kept, eq.KEPT_TANK, question):
        return kept[at], kept[at + 1], kept[at + 2], kept[at + 3], kept[at + 4], kept[at + 5]
    answer = saturated_tank(m.saturation, *question)
    keep(kept, eq.KEPT_TANK, question, answer)
    return answer


@inlined
def superheated(y: Array, m: Equations) -> None:
    """Vapor and nitrogen, mixed; ``y`` (states,) [SI]."""
    env, volume, held = m.env, m.c[eq.VOLUME], y[eq.TANK] + y[eq.NITROGEN]
    env[at.P_TANK], env[at.RHO_FEED] = constant_held(y) * y[eq.TEMPERATURE] / volume, held / volume
    env[at.M_LIQUID] = 0.0
    env[at.NITROGEN_SHARE], env[at.H_LEAVING] = y[eq.NITROGEN] / held, 0.0
    if np.isnan(m.c[eq.OXIDIZER_ENTHALPY]):
        env[at.H_LEAVING] = vapor(m, VAPOR_ENTHALPY, y[eq.TEMPERATURE])


@inlined
def constant_held(y: Array) -> float:
    """p V / T of vapor and nitrogen [J/K] in ``y`` (states,): masses times Z times their gas constants (report, eq.
    3.14)."""
    return float(y[eq.COMPRESSIBILITY] * SPECIFIC_GAS_CONSTANT * y[eq.TANK] + SPECIFIC_NITROGEN * y[eq.NITROGEN])


@inner
def run_dry(m: Equations, y: Array) -> None:
    """The vapor's compressibility and exponent [-] into ``y`` (states,), which hold from the end of the liquid on
    (report, section 4.2.2)."""
    p = np.exp(at_saturation(m, LN_PRESSURE, y[eq.TEMPERATURE]))
    y[eq.COMPRESSIBILITY] = compressibility(p, m.c[eq.VOLUME], y[eq.TANK], y[eq.TEMPERATURE])
    y[eq.EXPONENT] = m.c[eq.POLYTROPIC_EXPONENT]
    if np.isnan(y[eq.EXPONENT]):
        cp, cv = at_saturation(m, LN_VAPOR_CP, y[eq.TEMPERATURE]), at_saturation(m, LN_VAPOR_CV, y[eq.TEMPERATURE])
        y[eq.EXPONENT] = np.exp(cp - cv)


@inlined
def vapor(m: Equations, row: int, temperature: float) -> float:
    """A row [SI] of the table at the vapor's ``temperature`` [K], inside the range where it is read."""
    return at_saturation(m, row, min(max(temperature, COLDEST_VAPOR), WARMEST_VAPOR))


@inlined
def tank_rates(y: Array, liquid: bool, m: Equations, dy: Array) -> None:
    """Masses [kg/s] and temperature [K/s] of the tank into ``dy`` (states,) (report, eq. 3.1, 3.7 and, of the vapor,
    3.16).

    The polytropic vapor is as warm as its pressure asks for at the compressibility with which it began. Heat Q raises
    the pressure of a real one by G Q/V (Grueneisen's parameter G, about 0.3), which an ideal gas of its c_v would do by
    Z R Q/(c_v V): half as much near 275 K. So it warms by what that pressure asks for.
    """
    env, site, outflow = m.env, m.site, m.env[at.OXIDIZER_FLOW] + m.site[at.TANK_LEAK]
    inert = env[at.NITROGEN_SHARE] * outflow
    dy[eq.TANK] = inert - outflow
    dy[eq.NITROGEN] = site[at.NITROGEN_INFLOW] - inert
    if liquid:
        known = env[at.U_BY_MASS], env[at.U_BY_TEMPERATURE], env[at.H_LEAVING]
        dy[eq.TEMPERATURE] = temperature_rate(*known, outflow, site[at.TANK_HEAT])
        return
    dy[eq.TEMPERATURE] = y[eq.TEMPERATURE] * (y[eq.EXPONENT] - 1.0) * -outflow / (y[eq.TANK] + y[eq.NITROGEN])
    if site[at.TANK_HEAT] != 0.0:
        cv, g = np.exp(vapor(m, LN_VAPOR_CV, y[eq.TEMPERATURE])), vapor(m, VAPOR_GRUENEISEN, y[eq.TEMPERATURE])
        warming = site[at.TANK_HEAT] / (y[eq.TANK] * cv + y[eq.NITROGEN] * NITROGEN_CV)
        dy[eq.TEMPERATURE] += warming * (g * cv * y[eq.TANK] + SPECIFIC_NITROGEN * y[eq.NITROGEN]) / constant_held(y)
