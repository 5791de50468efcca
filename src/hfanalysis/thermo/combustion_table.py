"""Equilibrium combustion as a smooth table over pressure and mixture, for compiled code.

Tabulated are ln(R T), gamma and ln(T) of the chamber gas, on uniform grids in ln p and ln(O/F); between nodes bicubic
Hermite polynomials with central slopes (continuous first derivatives).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, equilibrium, restart

Array = NDArray[np.float64]

PRESSURES = (0.2e5, 120e5)
RATIOS = (0.4, 200.0)
NODES = (20, 280)
"""Nodes in ln p and ln(O/F)."""

ROWS = 3
LN_RT, GAMMA, LN_T = 0, 1, 2

Grid = tuple[Array, float, float, float, float]


@dataclass(frozen=True)
class CombustionTable:
    """``values`` has the shape (rows, pressures, ratios); the grid starts and steps are in ln p and ln(O/F)."""

    values: Array
    pressure_start: float
    pressure_step: float
    ratio_start: float
    ratio_step: float

    @property
    def kernel(self) -> Grid:
        """What :func:`gas_at` reads."""
        return (self.values, self.pressure_start, self.pressure_step, self.ratio_start, self.ratio_step)


def build(oxidizer_enthalpy: float = PROPEP_OXIDIZER_ENTHALPY) -> CombustionTable:
    """Tabulate (about 0.7 s)."""
    restart()
    ln_p = np.linspace(np.log(PRESSURES[0]), np.log(PRESSURES[1]), NODES[0])
    ln_r = np.linspace(np.log(RATIOS[0]), np.log(RATIOS[1]), NODES[1])
    values = np.empty((ROWS, *NODES))
    for i, p in enumerate(np.exp(ln_p)):
        for j, r in enumerate(np.exp(ln_r)):
            gas = equilibrium(float(p), float(r), oxidizer_enthalpy)
            ln_t = np.log(gas.temperature)
            values[:, i, j] = np.log(gas.gas_constant) + ln_t, gas.gamma, ln_t
    return CombustionTable(values, float(ln_p[0]), float(ln_p[1] - ln_p[0]), float(ln_r[0]), float(ln_r[1] - ln_r[0]))


@njit(cache=True)
def _weights(x: float, count: int) -> tuple[int, float, float, float, float]:
    """First of four nodes and their weights for a cubic through the middle two with central slopes; ends held."""
    x = min(max(x, 0.0), count - 1.0)
    i = min(int(x), count - 2)
    t = x - i
    a = -0.5 * t + t * t - 0.5 * t**3
    b = 1.0 - 2.5 * t * t + 1.5 * t**3
    c = 0.5 * t + 2.0 * t * t - 1.5 * t**3
    d = -0.5 * t * t + 0.5 * t**3
    return i - 1, a, b, c, d


@njit(cache=True)
def gas_at(table: Grid, ln_pressure: float, ln_ratio: float) -> tuple[float, float]:
    """R T [J/kg] and gamma of the chamber gas."""
    values, p0, dp, r0, dr = table
    i, a0, a1, a2, a3 = _weights((ln_pressure - p0) / dp, values.shape[1])
    j, b0, b1, b2, b3 = _weights((ln_ratio - r0) / dr, values.shape[2])
    last_i, last_j = values.shape[1] - 1, values.shape[2] - 1
    out0 = out1 = 0.0
    for k in range(4):
        a = a0 if k == 0 else a1 if k == 1 else a2 if k == 2 else a3
        ik = min(max(i + k, 0), last_i)
        for m in range(4):
            b = b0 if m == 0 else b1 if m == 1 else b2 if m == 2 else b3
            jm = min(max(j + m, 0), last_j)
            out0 += a * b * values[0, ik, jm]
            out1 += a * b * values[1, ik, jm]
    return np.exp(out0), out1


@njit(cache=True)
def temperatures(table: Grid, ln_pressure: Array, ln_ratio: Array) -> Array:
    """Temperature [K] of the chamber gas along a history; the solver itself only needs R T."""
    values, p0, dp, r0, dr = table
    out = np.empty(ln_pressure.size)
    last_i, last_j = values.shape[1] - 1, values.shape[2] - 1
    for n in range(out.size):
        i, a0, a1, a2, a3 = _weights((ln_pressure[n] - p0) / dp, values.shape[1])
        j, b0, b1, b2, b3 = _weights((ln_ratio[n] - r0) / dr, values.shape[2])
        a, b = (a0, a1, a2, a3), (b0, b1, b2, b3)
        total = 0.0
        for k in range(4):
            for m in range(4):
                total += a[k] * b[m] * values[2, min(max(i + k, 0), last_i), min(max(j + m, 0), last_j)]
        out[n] = np.exp(total)
    return out


@njit(cache=True)
def chamber_pressure(
    table: Grid, mass: float, volume: float, ln_ratio: float, guess: float
) -> tuple[float, float, float]:
    """p, R T and gamma of a chamber of ``volume`` [m^3] holding ``mass`` [kg]: p V = m R T(p), by fixed-point steps.

    R T hardly depends on p, so that each step gains one and a half digits.
    """
    p = guess
    rt = gamma = 0.0
    for _ in range(25):
        rt, gamma = gas_at(table, np.log(p), ln_ratio)
        new = mass * rt / volume
        if abs(new - p) < 1e-12 * p:
            p = new
            break
        p = new
    return p, rt, gamma
