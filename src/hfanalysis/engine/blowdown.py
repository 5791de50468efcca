"""The tank alone, emptied through feed line and injector against a given chamber pressure.

Fixed steps of the classical Runge-Kutta method: the tank's time scales are seconds, a step is milliseconds, and the end
of the liquid is located inside its step by the secant rule, so that no step straddles the change of equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import exprel

from hfanalysis.compiled import compiled
from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, liquid_mass, temperature_rate
from hfanalysis.thermo.saturation import LIQUID_VOLUME, LN_PRESSURE, Array, Saturation, evaluate

Table = tuple[Array, float, float, float]


@dataclass(frozen=True)
class FeedSystem:
    """Tank volume [m^3], effective injector area C_i N_i A_i [m^2], and the feed loss.

    The loss is K_loss mdot^2 / rho with ``loss_factor`` [1/m^4], or, where ``constant_losses`` is given, the report's
    constant pressure losses (liquid phase, vapour phase) [Pa].
    """

    volume: float
    area: float
    loss_factor: float = 0.0
    constant_losses: tuple[float, float] | None = None

    @property
    def kernel_arguments(self) -> tuple[float, float, float, float, float, bool]:
        """What the compiled right-hand side reads."""
        liquid, vapor = self.constant_losses or (0.0, 0.0)
        return (self.volume, self.area, self.loss_factor, liquid, vapor, self.constant_losses is not None)


@dataclass(frozen=True)
class Blowdown:
    """Histories on the requested times: pressure [Pa], total mass [kg], temperature [K], flow [kg/s].

    ``t_v`` is when the liquid ran out (NaN: not within the times).
    """

    time: Array
    pressure: Array
    mass: Array
    temperature: Array
    flow: Array
    t_v: float


def blow_down(
    saturation: Saturation,
    feed: FeedSystem,
    mass: float,
    temperature: float,
    time: Array,
    chamber_pressure: Array,
    polytropic_exponent: float,
    heat: float = 0.0,
) -> Blowdown:
    """Empty a saturated tank (report, eq. 3.1 to 3.17) from ``mass`` [kg] and ``temperature`` [K].

    ``time`` [s] is increasing, ``chamber_pressure`` [Pa] is given at these times and taken linear between them. After
    the liquid is gone p = p_v (M/M_v)^m with Z held. ``heat`` [W] goes into the saturated tank.
    """
    t = np.ascontiguousarray(time, dtype=np.float64)
    p_c = np.ascontiguousarray(chamber_pressure, dtype=np.float64)
    out, t_v = _blow_down(
        saturation.kernel_table, feed.kernel_arguments, mass, temperature, t, p_c, polytropic_exponent, heat
    )
    return Blowdown(t, out[0], out[1], out[2], out[3], t_v)


@compiled
def _liquid_flow(table: Table, feed: tuple[float, float, float, float, float, bool], t_k: float, p_c: float) -> float:
    _, area, factor, loss, _, constant = feed
    pressure = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0])
    density = 1.0 / evaluate(*table, LIQUID_VOLUME, t_k)[0]
    if constant:
        return mass_flow(area, density, pressure - loss - p_c)
    return mass_flow_with_feed(area, factor, density, pressure - p_c)


@compiled
def _vapor_flow(
    feed: tuple[float, float, float, float, float, bool], mass: float, pressure: float, p_c: float
) -> float:
    volume, area, factor, _, loss, constant = feed
    if constant:
        return mass_flow(area, mass / volume, pressure - loss - p_c)
    return mass_flow_with_feed(area, factor, mass / volume, pressure - p_c)


@compiled
def _liquid_step(
    table: Table,
    feed: tuple[float, float, float, float, float, bool],
    mass: float,
    t_k: float,
    h: float,
    p0: float,
    p1: float,
    heat: float,
) -> tuple[float, float]:
    """One Runge-Kutta step of (M, T); p0 and p1 are the chamber pressures at its ends."""
    middle = 0.5 * (p0 + p1)
    w1 = _liquid_flow(table, feed, t_k, p0)
    r1 = temperature_rate(table, feed[0], mass, t_k, w1, heat)
    w2 = _liquid_flow(table, feed, t_k + 0.5 * h * r1, middle)
    r2 = temperature_rate(table, feed[0], mass - 0.5 * h * w1, t_k + 0.5 * h * r1, w2, heat)
    w3 = _liquid_flow(table, feed, t_k + 0.5 * h * r2, middle)
    r3 = temperature_rate(table, feed[0], mass - 0.5 * h * w2, t_k + 0.5 * h * r2, w3, heat)
    w4 = _liquid_flow(table, feed, t_k + h * r3, p1)
    r4 = temperature_rate(table, feed[0], mass - h * w3, t_k + h * r3, w4, heat)
    mass -= h * (w1 + 2.0 * w2 + 2.0 * w3 + w4) / 6.0
    return mass, t_k + h * (r1 + 2.0 * r2 + 2.0 * r3 + r4) / 6.0


@compiled
def _vapor_step(
    feed: tuple[float, float, float, float, float, bool],
    mass: float,
    m_v: float,
    p_v: float,
    exponent: float,
    h: float,
    p0: float,
    p1: float,
) -> float:
    """One Runge-Kutta step of the vapour's mass along p = p_v (M/M_v)^m."""
    middle = 0.5 * (p0 + p1)
    w1 = _vapor_flow(feed, mass, p_v * (mass / m_v) ** exponent, p0)
    m2 = mass - 0.5 * h * w1
    w2 = _vapor_flow(feed, m2, p_v * (m2 / m_v) ** exponent, middle)
    m3 = mass - 0.5 * h * w2
    w3 = _vapor_flow(feed, m3, p_v * (m3 / m_v) ** exponent, middle)
    m4 = mass - h * w3
    w4 = _vapor_flow(feed, m4, p_v * (m4 / m_v) ** exponent, p1)
    return mass - h * (w1 + 2.0 * w2 + 2.0 * w3 + w4) / 6.0


@compiled
def _blow_down(
    table: Table,
    feed: tuple[float, float, float, float, float, bool],
    mass: float,
    t_k: float,
    time: Array,
    p_c: Array,
    exponent: float,
    heat: float,
) -> tuple[Array, float]:
    volume = feed[0]
    out = np.full((4, time.size), np.nan)
    t_v = np.nan
    m_v = p_v = t_empty = 0.0
    liquid = liquid_mass(table, volume, mass, t_k)
    if liquid <= 0.0:
        t_v, m_v, t_empty = time[0], mass, t_k
        p_v = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0])
    for i in range(time.size):
        if i > 0:
            h, p0, p1 = time[i] - time[i - 1], p_c[i - 1], p_c[i]
            if liquid > 0.0:
                new_mass, new_t = _liquid_step(table, feed, mass, t_k, h, p0, p1, heat)
                new_liquid = liquid_mass(table, volume, new_mass, new_t)
                if new_liquid <= 0.0:
                    part = liquid / (liquid - new_liquid)
                    middle = p0 + part * (p1 - p0)
                    mass, t_k = _liquid_step(table, feed, mass, t_k, part * h, p0, middle, heat)
                    t_v, m_v, t_empty = time[i - 1] + part * h, mass, t_k
                    p_v = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0])
                    mass = _vapor_step(feed, mass, m_v, p_v, exponent, (1.0 - part) * h, middle, p1)
                else:
                    mass, t_k = new_mass, new_t
                liquid = new_liquid
            else:
                mass = _vapor_step(feed, mass, m_v, p_v, exponent, h, p0, p1)
        if liquid > 0.0:
            out[0, i] = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0])
            out[2, i] = t_k
            out[3, i] = _liquid_flow(table, feed, t_k, p_c[i])
        else:
            out[0, i] = p_v * (mass / m_v) ** exponent
            out[2, i] = t_empty * (mass / m_v) ** (exponent - 1.0)
            out[3, i] = _vapor_flow(feed, mass, out[0, i], p_c[i])
        out[1, i] = mass
    return out, t_v


def implied_heat(
    saturation: Saturation, exponent: float, mass_start: float, mass_end: float, temperature: float, z: float
) -> float:
    """Heat [J] that a polytropic vapour blowdown needs from outside (negative: must give away).

    From ``mass_start`` to ``mass_end`` [kg], beginning with saturated vapour at ``temperature`` [K]: the integral of
    (m_s - m) p V/G over -d ln M, p V = Z R T_v M_v (M/M_v)^m, with that vapour's isentropic exponent m_s and
    Grueneisen's G (as :mod:`hfanalysis.engine.closure`). The polytropic law itself does not conserve energy.
    """
    held = z * SPECIFIC_GAS_CONSTANT * temperature * mass_start
    too_small = float(saturation.isentropic_exponent(temperature)) - exponent
    less = float(np.log(mass_end / mass_start))
    leaves = -less * float(exprel(exponent * less))
    return float(held * too_small / float(saturation.grueneisen(temperature)) * leaves)
