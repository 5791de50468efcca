"""The self-pressurising oxidizer tank: liquid and vapour in equilibrium, then vapour alone.

Report, section 3.1.2 ("Self-Pressurizing Oxidizer Tank"). The saturated tank is written in its total mass M and its
temperature T; with M and T given, the volume fixes how much of it is liquid (eq. 3.5). The report's three linear
equations (mass, volume, energy) then have the closed form of :func:`temperature_rate`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.compiled import compiled
from hfanalysis.thermo.constants import GAS_CONSTANT, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.saturation import (
    LIQUID_ENERGY,
    LIQUID_ENTHALPY,
    LIQUID_VOLUME,
    LN_PRESSURE,
    LN_VAPOR_VOLUME,
    VAPOR_ENERGY,
    Array,
    Saturation,
    evaluate,
    place,
    row_at,
)

SPECIFIC_GAS_CONSTANT = GAS_CONSTANT / OXIDIZER_MOLAR_MASS
"""R_u / W_o of nitrous oxide [J/(kg K)]."""


@dataclass(frozen=True)
class TankSplit:
    """How a saturated tank's content divides: masses [kg] of the phases (negative where it cannot be saturated)."""

    liquid: float
    vapor: float


def split(saturation: Saturation, volume: float, mass: float, temperature: float) -> TankSplit:
    """Liquid and vapour mass [kg] of a saturated tank: V = m_l v_l + m_v v_v (report, eq. 3.5).

    ``volume`` [m^3], total ``mass`` [kg], ``temperature`` [K]. A negative liquid mass means superheated vapour, a
    negative vapour mass a tank so full that the liquid is compressed.
    """
    liquid = liquid_mass(saturation.kernel_table, volume, mass, temperature)
    return TankSplit(liquid, mass - liquid)


def compressibility(pressure: float, volume: float, mass: float, temperature: float) -> float:
    """Z = p V / (m R T) of the vapour at the end of the liquid (report, section 4.2.2); pressure [Pa], volume
    [m^3]."""
    return pressure * volume / (mass * SPECIFIC_GAS_CONSTANT * temperature)


def mass_along_blowdown(saturation: Saturation, volume: float, t_empty: float, temperatures: Array) -> Array:
    """Total mass [kg] that an adiabatic saturated tank held at each temperature [K] before it ran dry at t_empty.

    Integrates dM/dT = U_T / (h_l - U_M), which follows from dU = h_l dM, upwards from M = V / v_v(t_empty). No flow
    measurement enters: the thermodynamics alone tie mass to temperature. Shape as ``temperatures``, which must not
    fall below ``t_empty``.
    """
    return _mass_along_blowdown(saturation.kernel_table, volume, t_empty, np.asarray(temperatures, dtype=np.float64))


@compiled
def liquid_mass(table: tuple[Array, float, float, float], volume: float, mass: float, temperature: float) -> float:
    """m_l = (M v_v - V) / (v_v - v_l)."""
    v_l, _ = evaluate(*table, LIQUID_VOLUME, temperature)
    v_v = np.exp(evaluate(*table, LN_VAPOR_VOLUME, temperature)[0])
    return float((mass * v_v - volume) / (v_v - v_l))


@compiled
def energy_derivatives(
    table: tuple[Array, float, float, float], volume: float, mass: float, temperature: float
) -> tuple[float, float, float]:
    """U_M [J/kg], U_T [J/K] of the saturated tank's internal energy, and the liquid's enthalpy h_l [J/kg]."""
    _, _, _, by_mass, by_temperature, h_l = saturated_tank(table, volume, mass, temperature)
    return by_mass, by_temperature, h_l


@compiled
def saturated_tank(
    table: tuple[Array, float, float, float], volume: float, mass: float, temperature: float
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
    m_l = (mass * v_v - volume) / gap
    m_v = mass - m_l
    m_l_slope = (m_l * v_l_slope + m_v * v_v * ln_v_v_slope) / gap
    by_mass = (u_l * v_v - u_v * v_l) / gap
    by_temperature = m_l * u_l_slope + m_v * u_v_slope + (u_l - u_v) * m_l_slope
    return np.exp(ln_p), 1.0 / v_l, m_l, by_mass, by_temperature, h_l


@compiled
def temperature_rate(
    table: tuple[Array, float, float, float],
    volume: float,
    mass: float,
    temperature: float,
    outflow: float,
    heat: float,
) -> float:
    """dT/dt [K/s] of the saturated tank losing liquid at ``outflow`` [kg/s] and receiving ``heat`` [W].

    From d(M, T)/dt in dU/dt = -mdot h_l + Qdot (report, eq. 3.9 with a heat term).
    """
    by_mass, by_temperature, h_l = energy_derivatives(table, volume, mass, temperature)
    return (heat + outflow * (by_mass - h_l)) / by_temperature


@compiled
def _mass_along_blowdown(
    table: tuple[Array, float, float, float], volume: float, t_empty: float, temperatures: Array
) -> Array:
    out = np.empty_like(temperatures)
    order = np.argsort(temperatures)
    t = t_empty
    mass = volume / np.exp(evaluate(*table, LN_VAPOR_VOLUME, t_empty)[0])
    for i in order:
        steps = max(int(np.ceil((temperatures[i] - t) / 0.1)), 1)
        h = (temperatures[i] - t) / steps
        for _ in range(steps):
            k1 = _mass_slope(table, volume, mass, t)
            k2 = _mass_slope(table, volume, mass + 0.5 * h * k1, t + 0.5 * h)
            k3 = _mass_slope(table, volume, mass + 0.5 * h * k2, t + 0.5 * h)
            k4 = _mass_slope(table, volume, mass + h * k3, t + h)
            mass += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            t += h
        out[i] = mass
    return out


@compiled
def _mass_slope(table: tuple[Array, float, float, float], volume: float, mass: float, temperature: float) -> float:
    by_mass, by_temperature, h_l = energy_derivatives(table, volume, mass, temperature)
    return by_temperature / (h_l - by_mass)
