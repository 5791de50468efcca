"""Closures of the effects, each exactly neutral at strength zero; docs/blind.md says where they come from."""

from __future__ import annotations

from math import pi

import numpy as np
from numba import njit
from numpy.typing import NDArray

from . import combustion, nitrous
from . import slots as s

Array = NDArray[np.float64]

BAR = 1e5


@njit(cache=True)
def heat_in(
    c: Array, e: Array, t: float, wet: float, wall: float, temperature: float, liquid: bool
) -> tuple[float, float]:
    """Heat into the tank [W]: from blankets; from the wall, by convection or boiling (power 1.25 of the difference)."""
    blanket = 0.0
    if e[s.HEAT] != 0.0:
        # blankets were on before: the layer between has warmed in part, the rest comes with a lag, and all of it fades
        blanket = e[s.HEAT] * (1.0 - 0.7 * np.exp(-t / e[s.HEAT_LAG])) * np.exp(-((t / e[s.HEAT_FADE]) ** 1.5))
    conducted = 0.0
    if e[s.WALL] != 0.0:
        d = wall - temperature
        share = 0.15 + 0.85 * wet if liquid else 0.15
        conducted = e[s.WALL] * share * d * (abs(d) / 5.0) ** 0.25
    return blanket, conducted


@njit(cache=True)
def injector_factor(
    e: Array, t: float, liquid: bool, p_run: float, p_c: float, density: float, critical: float
) -> float:
    """Flow over that of the incompressible orifice at the same p_run and p_c."""
    f = 1.0
    drop = max(p_run - p_c, 0.0)
    if liquid:
        if e[s.TWO_PHASE] != 0.0:
            ratio = 2.0 * density * drop / (critical * critical)
            f *= (1.0 + e[s.TWO_PHASE] * ratio * ratio) ** -0.25
        if e[s.FLIP] != 0.0 and t >= e[s.FLIP_START]:
            f *= 1.0 - e[s.FLIP] * (1.0 - np.exp(-(t - e[s.FLIP_START]) / 0.02))
    elif e[s.VAPOR_CHOKING] != 0.0:
        x = drop / max(p_run, 1.0)
        most = 0.9 * 0.72
        inside = min(x, most)
        valve = (1.0 - inside / (3.0 * most)) * np.sqrt(inside / max(x, 1e-12))
        f *= 1.0 + e[s.VAPOR_CHOKING] * (valve - 1.0)
    if e[s.CHUGGING] != 0.0:
        up = 1.0 / (1.0 + np.exp(-(t - e[s.CHUGGING_START]) / 0.15))
        down = 1.0 / (1.0 + np.exp((t - e[s.CHUGGING_END]) / 0.3))
        a = e[s.CHUGGING] * up * down
        f *= 1.0 + a * np.sin(2.0 * pi * e[s.CHUGGING_FREQUENCY] * t) - 0.25 * a * a
    return max(f, 0.02)


@njit(cache=True)
def feed_factor(e: Array, t: float, liquid: bool, p_run: float, p_t: float) -> float:
    """K_loss over its base value."""
    f = 1.0
    if e[s.VALVE] > 0.0 and t < e[s.VALVE]:
        opened = max(t / e[s.VALVE], 0.03)
        f += 3.0 * (1.0 / (opened * opened) - 1.0)
    if e[s.FLASHING] != 0.0 and liquid:
        f += e[s.FLASHING] * 10.0 * max(p_t - p_run, 0.0) / p_t
    return f


@njit(cache=True)
def regression_factor(e: Array, t: float, p_c: float, flux: float, port: float, c: Array) -> float:
    """Regression over a G^n."""
    f = 1.0
    if e[s.PRESSURE_BURNING] != 0.0:
        p = e[s.REFERENCE_PRESSURE]
        f += e[s.PRESSURE_BURNING] * np.tanh((p_c - p) / p)
    if e[s.ENTRAINMENT] != 0.0:
        melt = 1.0 - np.exp(-t / e[s.ENTRAINMENT_LAG])
        f += e[s.ENTRAINMENT] * melt * (max(flux, 0.0) / 300.0) ** 1.3 * c[s.PORT] / port
    if e[s.SHIFT] != 0.0:
        a = 1.0 / (1.0 + np.exp(-(t - e[s.SHIFT_START]) / 0.02))
        f += e[s.SHIFT] * a / (1.0 + np.exp((t - e[s.SHIFT_END]) / 0.02))
    return max(f, 0.05)


@njit(cache=True)
def burning_share(e: Array, port: float, outer: float, advance: float) -> float:
    """Share of the port's perimeter that still has fuel, mean over a step in which the port advances."""
    if e[s.SLIVER] > 0.0:
        return float(1.0 / (1.0 + np.exp(min((port + 0.5 * advance - outer) / (0.55 * e[s.SLIVER]), 60.0))))
    if port + advance <= outer:
        return 1.0
    return max(outer - port, 0.0) / advance if advance > 0.0 else 0.0


@njit(cache=True)
def hot_gas(
    table: Array, e: Array, enthalpy: float, share: float, p: float, ratio: float, flow: float, area: float, t: float
) -> tuple[float, float, float]:
    """R T [J/kg], gamma, and the power [W] that is missing against equilibrium."""
    rt, gamma = combustion.gas(table, enthalpy, share, p, ratio)
    lost = 0.0
    heat = gamma / (gamma - 1.0)
    if e[s.EFFICIENCY] != 0.0:
        eta = 1.0 - e[s.EFFICIENCY] * (1.0 + 0.2 * np.tanh(np.log(ratio / 6.0)))
        lost += (1.0 - eta * eta) * rt
    if e[s.CHAMBER_HEAT] != 0.0:
        q = e[s.CHAMBER_HEAT] * (max(p, 0.0) / (10.0 * BAR)) ** 0.8 * area / np.sqrt(1.0 + t / e[s.CHAMBER_HEAT_FADE])
        lost += min(q / (heat * max(flow, 0.02)), 0.5 * rt)
    return rt - lost, gamma, lost * heat * flow


@njit(cache=True)
def critical_flux(tab: Array, temperature: float, pressure: float, density: float) -> float:
    """Leung's (1986) critical mass flux [kg/(m^2 s)] of a saturated liquid: omega method, fitted eta_c."""
    h = nitrous.saturated(tab, nitrous.H_V, temperature) - nitrous.saturated(tab, nitrous.H_L, temperature)
    v = 1.0 / nitrous.saturated(tab, nitrous.RHO_V, temperature) - 1.0 / density
    c_p = nitrous.saturated(tab, nitrous.H_L, temperature + 0.5) - nitrous.saturated(
        tab, nitrous.H_L, temperature - 0.5
    )
    omega = max(density * c_p * temperature * pressure * (v / h) ** 2, 0.5)
    l = np.log(omega)  # noqa: E741
    eta = 0.55 + 0.217 * l - 0.046 * l * l + 0.004 * l**3
    return float(eta / np.sqrt(omega) * np.sqrt(pressure * density))
