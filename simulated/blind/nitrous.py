"""Saturated nitrous oxide from CoolProp (Lemmon and Span 2006), as monotone cubics in temperature.

The cubics (PCHIP through nodes half a kelvin apart) are sampled on a fine uniform grid, on which compiled code
interpolates linearly: an error of about 1e-8, relative.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .cache import kept

Array = NDArray[np.float64]

LOWEST, HIGHEST, NODE_STEP, STEP = 183.0, 309.0, 0.5, 0.02
"""Temperatures [K]."""

P, RHO_L, RHO_V, U_L, U_V, H_L, H_V, GRUENEISEN = range(8)
"""Rows [Pa, kg/m^3, J/kg]; the last is (dp/du)_rho / rho [-] of the saturated vapour."""

FORMATION_GAS = 82.05e6 / 44.0128
"""Enthalpy of formation of the ideal gas at 298.15 K [J/kg]."""


def _row(temperature: float) -> list[float]:
    from CoolProp import CoolProp as cp

    def get(what: str, quality: float) -> float:
        return float(cp.PropsSI(what, "T", temperature, "Q", quality, "NitrousOxide"))

    rho, u = get("D", 1), get("U", 1)
    # along the isochore, on the superheated side of saturation
    up = [float(cp.PropsSI("P", "D", rho, "U", u + du, "NitrousOxide")) for du in (200.0, 400.0)]
    slope = (up[1] - up[0]) / 200.0
    return [get("P", 0), get("D", 0), rho, get("U", 0), u, get("H", 0), get("H", 1), slope / rho]


def _make() -> Array:
    from scipy.interpolate import PchipInterpolator

    nodes = np.arange(LOWEST, HIGHEST + 0.5 * NODE_STEP, NODE_STEP)
    values = np.array([_row(float(t)) for t in nodes]).T
    fine = np.arange(LOWEST, HIGHEST + 0.5 * STEP, STEP)
    smooth = [PchipInterpolator(nodes, np.log(v))(fine) for v in values[[P, RHO_L, RHO_V]]]
    rest = [PchipInterpolator(nodes, v)(fine) for v in values[[U_L, U_V, H_L, H_V, GRUENEISEN]]]
    return np.array([*np.exp(smooth), *rest])


@lru_cache(maxsize=1)
def table() -> Array:
    """Rows as above on the fine grid."""
    return kept("nitrous-1", _make)


@lru_cache(maxsize=1)
def formation_offset() -> float:
    """What to add to CoolProp's enthalpy for the formation scale [J/kg]."""
    from CoolProp import CoolProp as cp

    return FORMATION_GAS - float(cp.PropsSI("H", "T", 298.15, "P", 100.0, "NitrousOxide"))


@njit(cache=True)
def saturated(values: Array, row: int, temperature: float) -> float:
    """One row at a temperature [K]; ends held."""
    x = (temperature - LOWEST) / STEP
    x = min(max(x, 0.0), values.shape[1] - 1.000001)
    i = int(x)
    return float(values[row, i] + (x - i) * (values[row, i + 1] - values[row, i]))


@njit(cache=True)
def internal_energy(values: Array, temperature: float, mass: float, volume: float) -> float:
    """U [J] of liquid and vapour that fill a volume together."""
    v_l, v_v = 1.0 / saturated(values, RHO_L, temperature), 1.0 / saturated(values, RHO_V, temperature)
    x = (volume / mass - v_l) / (v_v - v_l)
    u_l = saturated(values, U_L, temperature)
    return mass * (u_l + x * (saturated(values, U_V, temperature) - u_l))


@njit(cache=True)
def flash(values: Array, energy: float, mass: float, volume: float, guess: float) -> float:
    """Temperature [K] of liquid and vapour in a volume, from internal energy [J] and mass [kg]: secants."""
    t0, t1 = guess, guess - 0.01
    f0 = internal_energy(values, t0, mass, volume) - energy
    f1 = internal_energy(values, t1, mass, volume) - energy
    for _ in range(12):
        if abs(f1) < 1e-7 * abs(energy) * 1e-3 or f1 == f0:
            break
        t2 = t1 - f1 * (t1 - t0) / (f1 - f0)
        t0, f0, t1 = t1, f1, t2
        f1 = internal_energy(values, t1, mass, volume) - energy
    return t1


@njit(cache=True)
def liquid_mass(values: Array, temperature: float, mass: float, volume: float) -> float:
    """Liquid [kg]; negative where there would be more than vapour alone."""
    v_l, v_v = 1.0 / saturated(values, RHO_L, temperature), 1.0 / saturated(values, RHO_V, temperature)
    return mass * (v_v - volume / mass) / (v_v - v_l)
