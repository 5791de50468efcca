"""The one-dimensional nozzle in all its regimes (report, section 3.1.4).

From low to high chamber pressure: subsonic throughout, choked with a subsonic diverging part (one point), a normal
shock in the diverging part, supersonic throughout. Areas, pressures and temperatures are stagnation values of the
chamber gas; the heat capacity ratio is constant (frozen composition).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.compiled import Real, compiled, inlined, law
from hfanalysis.engine.equations import EXIT_AREA, KEPT_NOZZLE, THROAT_AREA, Equations, asked, keep
from hfanalysis.engine.sites import GAMMA_CHAMBER, P_AMBIENT, P_CHAMBER, RT_CHAMBER, THROAT_FACTOR, THRUST_FACTOR
from hfanalysis.thermo.combustion import Gas
from hfanalysis.thermo.combustion_table import Grid, gas_at

SUBSONIC, SHOCK, SUPERSONIC = 0, 1, 2
"""Indices of REGIMES."""

SMALL_EXCESS = 1e-4
"""Excess of the chamber's over the ambient pressure, relative [-], below which the exit velocity falls linearly."""

REGIMES = ("subsonic", "shock in the diverging part", "supersonic")


@dataclass(frozen=True)
class Flow:
    """Mass flow [kg/s], thrust [N], Mach number and pressure [Pa] at the exit, and the regime in words."""

    mass_flow: float
    thrust: float
    exit_mach: float
    exit_pressure: float
    regime: str


def nozzle_flow(gas: Gas, pressure: float, ambient: float, throat_area: float, exit_area: float) -> Flow:
    """Flow through a nozzle of the given areas [m^2] from a chamber at ``pressure`` to ``ambient`` [Pa].

    Raises ValueError where the exit is smaller than the throat.
    """
    if exit_area < throat_area:
        raise ValueError(f"the exit ({exit_area} m^2) is smaller than the throat ({throat_area} m^2)")
    flow = expand(gas.gamma, gas.gas_constant * gas.temperature, pressure, ambient, throat_area, exit_area)
    return Flow(flow[0], flow[1], flow[2], flow[3], REGIMES[int(flow[4])])


@compiled
def area_ratio(mach: float, gamma: float) -> float:
    """A/A* = ((2/(g+1)) (1 + (g-1)/2 M^2))^((g+1)/(2(g-1))) / M [-] (report, eq. 3.33).

    >>> round(area_ratio(2.0, 1.4), 4)
    1.6875
    """
    base = 2.0 / (gamma + 1.0) * (1.0 + 0.5 * (gamma - 1.0) * mach * mach)
    return float(base ** (0.5 * (gamma + 1.0) / (gamma - 1.0)) / mach)


@compiled
def mach_at_area(ratio: float, gamma: float, supersonic: bool) -> float:
    """Mach number [-] at A/A* = ``ratio`` >= 1 on one branch: Halley on ln(A/A*) in ln M, kept on its side of M = 1.

    >>> round(mach_at_area(1.6875, 1.4, True), 4)
    2.0
    """
    if ratio <= 1.0:
        return 1.0
    # near the throat ln(A/A*) is quadratic in ln M; far from it the branches follow powers of the ratio
    target = np.log(ratio)
    spread = np.sqrt(target * (gamma + 1.0))
    x = min(spread, 2.5) if supersonic else max(-spread, -target - 0.6)
    half = 0.5 * (gamma - 1.0)
    power = 0.5 * (gamma + 1.0) / (gamma - 1.0)
    throat = power * np.log(1.0 + half)
    for _ in range(60):
        square = np.exp(2.0 * x)
        bracket = 1.0 + half * square
        error = power * np.log(bracket) - throat - x - target
        slope = (square - 1.0) / bracket
        if slope == 0.0:
            break
        curvature = (gamma + 1.0) * square / (bracket * bracket)
        newton = error / slope
        new = x - newton / max(1.0 - 0.5 * newton * curvature / slope, 0.5)  # Halley's correction
        if (new > 0.0) != supersonic or new == 0.0:
            new = 0.5 * x
        done = abs(new - x) < 1e-7 or abs(error) < 1e-15
        x = new
        if done:  # of third order: what is left is the cube of the last change
            break
    return float(np.exp(x))


@compiled
def pressure_ratio(mach: float, gamma: float) -> float:
    """p/p_0 [-] of isentropic flow at a Mach number (report, eq. 3.34).

    >>> round(pressure_ratio(2.0, 1.4), 5)
    0.1278
    """
    return float((1.0 + 0.5 * (gamma - 1.0) * mach * mach) ** (-gamma / (gamma - 1.0)))


@compiled
def pressure_after_shock(mach: float, gamma: float) -> float:
    """p_2/p_1 [-] across a normal shock (report, eq. 3.37).

    >>> round(pressure_after_shock(2.0, 1.4), 4)
    4.5
    """
    return (2.0 * gamma * mach * mach - (gamma - 1.0)) / (gamma + 1.0)


@compiled
def stagnation_after_shock(mach: float, gamma: float) -> float:
    """p_0y/p_0x [-] across a normal shock (report, eq. 3.39).

    >>> round(stagnation_after_shock(2.0, 1.4), 4)
    0.7209
    """
    square = mach * mach
    first = (2.0 * gamma * square - (gamma - 1.0)) / (gamma + 1.0)
    second = (gamma + 1.0) * square / (2.0 + (gamma - 1.0) * square)
    return float(first ** (-1.0 / (gamma - 1.0)) * second ** (gamma / (gamma - 1.0)))


@law
def choked_flow_factor(gamma: Real) -> Real:
    """mdot sqrt(R T) / (A p_0) [-] of a choked throat (report, eq. 3.45 at M = 1)."""
    return np.sqrt(gamma) * (0.5 * (gamma + 1.0)) ** (-0.5 * (gamma + 1.0) / (gamma - 1.0))


@law
def choked_flow(gamma: Real, specific_temperature: Real, pressure: Real, throat_area: Real) -> Real:
    """mdot [kg/s] of a choked throat (report, eq. 3.45 at M = 1).

    ``specific_temperature`` R T [J/kg], ``pressure`` [Pa] and ``throat_area`` [m^2].
    """
    return choked_flow_factor(gamma) * throat_area * pressure / np.sqrt(specific_temperature)


@law
def characteristic_velocity(specific_temperature: Real, gamma: Real) -> Real:
    """c* = p_0 A / mdot [m/s] of a choked throat; ``specific_temperature`` R T [J/kg]."""
    return np.sqrt(specific_temperature) / choked_flow_factor(gamma)


@compiled
def mach_at_pressure(ratio: float, gamma: float) -> float:
    """Mach number [-] at p/p_0 = ``ratio`` <= 1 (report, eq. 2.10; the inverse of :func:`pressure_ratio`).

    >>> round(mach_at_pressure(0.1278, 1.4), 3)
    2.0
    """
    return float(np.sqrt(2.0 / (gamma - 1.0) * (ratio ** (-(gamma - 1.0) / gamma) - 1.0)))


@compiled
def expand(
    gamma: float, specific_temperature: float, pressure: float, ambient: float, throat_area: float, exit_area: float
) -> tuple[float, float, float, float, int]:
    """Mass flow [kg/s], thrust [N], exit Mach number, exit pressure [Pa], regime; no flow for p <= ambient.

    ``specific_temperature`` is R T of the chamber gas [J/kg], ``pressure`` and ``ambient`` [Pa], areas [m^2] (report,
    section 3.1.4).
    """
    if not pressure > ambient:
        return 0.0, 0.0, 0.0, ambient, SUBSONIC
    ratio = exit_area / throat_area
    # a nozzle with less than the throat's critical pressure behind it is choked: no need to ask for its subsonic flow
    if ambient >= pressure * pressure_ratio(1.0, gamma):
        first = mach_at_area(ratio, gamma, False)
        if ambient >= pressure * pressure_ratio(first, gamma):
            mach = mach_at_pressure(ambient / pressure, gamma)
            # flow grows as the root of the excess pressure: bent to a finite slope where solvers would stall
            x = min((pressure / ambient - 1.0) / SMALL_EXCESS, 1.0)
            mach *= 0.5 * np.sqrt(x) * (3.0 - x)
            return ejected(gamma, specific_temperature, pressure, ambient, exit_area, mach, ambient, SUBSONIC)
    full = mach_at_area(ratio, gamma, True)
    exit_pressure = pressure * pressure_ratio(full, gamma)
    if ambient < exit_pressure * pressure_after_shock(full, gamma):
        return ejected(gamma, specific_temperature, pressure, ambient, exit_area, full, exit_pressure, SUPERSONIC)
    # behind a shock p_e M_e sqrt(1 + (g-1)/2 M_e^2) A_e carries the choked flow: p_e = p_a gives M_e in closed form
    choked = choked_flow_factor(gamma) * throat_area * pressure / (exit_area * ambient)
    square = (np.sqrt(1.0 + 2.0 * (gamma - 1.0) * choked * choked / gamma) - 1.0) / (gamma - 1.0)
    return ejected(gamma, specific_temperature, pressure, ambient, exit_area, np.sqrt(square), ambient, SHOCK)


@compiled
def ejected(
    gamma: float,
    specific_temperature: float,
    pressure: float,
    ambient: float,
    exit_area: float,
    mach: float,
    exit_pressure: float,
    regime: int,
) -> tuple[float, float, float, float, int]:
    """Flow [kg/s] and thrust F = mdot v_e + (p_e - p_a) A_e [N] (report, eq. 3.43 to 3.46) from the exit's state.

    ``specific_temperature`` R T [J/kg] of the chamber, pressures [Pa], ``exit_area`` [m^2]; then ``mach``,
    ``exit_pressure`` [Pa] and ``regime`` as they were given. Total temperature is conserved.
    """
    exit_temperature = specific_temperature / (1.0 + 0.5 * (gamma - 1.0) * mach * mach)
    velocity = mach * np.sqrt(gamma * exit_temperature)
    flow = exit_pressure / exit_temperature * velocity * exit_area
    return flow, flow * velocity + (exit_pressure - ambient) * exit_area, mach, exit_pressure, regime


def expand_along(
    gas: Grid, pressure: Array, of_ratio: Array, enthalpy: ArrayLike, throat_area: ArrayLike, exit_area: float,
    ambient: float,
) -> Array:  # fmt: skip
    """Flow [kg/s], thrust [N], R T [J/kg] and gamma of burnt gas at each instant, (4, n); NaN where there is none.

    ``pressure`` [Pa] and ``of_ratio`` (n,), ``enthalpy`` of the oxidizer [J/kg] and ``throat_area`` [m^2] (n,) or one.
    """
    given = np.broadcast_arrays(pressure, of_ratio, enthalpy, throat_area)
    return _expand_along(gas, exit_area, ambient, *(np.ascontiguousarray(x) for x in given))


@compiled
def _expand_along(
    gas: Grid, exit_area: float, ambient: float, pressure: Array, ratio: Array, enthalpy: Array, throat: Array
) -> Array:
    out = np.full((4, pressure.size), np.nan)
    for i in range(pressure.size):
        if ratio[i] > 0.0 and pressure[i] > 0.0:
            rt, gamma = gas_at(gas, np.log(pressure[i]), np.log(ratio[i]), enthalpy[i], 0.0)
            flow, thrust, _, _, _ = expand(gamma, rt, pressure[i], ambient, throat[i], exit_area)
            out[0, i], out[1, i], out[2, i], out[3, i] = flow, thrust, rt, gamma
    return out


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
    """Flow [kg/s] and thrust [N] of :func:`expand`, or what is kept of them."""
    kept, at = m.kept, KEPT_NOZZLE + 6
    if asked(kept, KEPT_NOZZLE, question):
        return kept[at], kept[at + 1]
    answer = expand(*question)[:2]
    keep(kept, KEPT_NOZZLE, question, answer)
    return answer
