"""C_i, K_loss, Z and m from the measured pressures: the report's tank calibration (chapter 4.2) in compiled form.

C_i is that of which the flow, integrated from the opening to t_v, leaves just the saturated vapour at the tank pressure
of t_v:

    C_i = (m_o - V rho_v(T_v)) / integral of N_i A_i sqrt(2 rho_l (p_run - p_c)) dt

which is the report's iteration on C_i in closed form. m is found by shooting the vapour phase to the pressure at
t_purge.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hfanalysis.calibrate.measured_pressures import Histories
from hfanalysis.compiled import compiled
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT
from hfanalysis.thermo.saturation import Saturation

Array = NDArray[np.float64]

EXPONENTS = np.geomspace(0.05, 6.0, 49)
"""Grid on which the root in m is bracketed; no gas expands outside it."""

COARSE = 4
"""Points of that grid that a first scan steps over."""

ROOT = 1e-10
"""To what m is found."""

Phase = tuple[Array, Array, Array, float, float, float, float, float, float]
"""What :func:`_vapor_end` takes, but for m."""

SETTLING = 2.0
"""K_loss is taken from this many t_feed on: at t_feed itself the line still fills by the last 2 %."""


@dataclass(frozen=True)
class Inputs:
    """Everything the reduction takes besides the pressures; SI units.

    ``mass``: oxidizer loaded [kg]; ``volume``: tank and line [m^3]; ``area``: all injector holes [m^2]; ``t_feed``,
    ``t_v``, ``t_end``: line full, liquid gone, end of the pure vapour phase [s] (NaN: there is none); ``p_v``,
    ``p_end``: tank pressure at the last two [Pa].
    """

    mass: float
    volume: float
    area: float
    t_feed: float
    t_v: float
    t_end: float
    p_v: float
    p_end: float


@dataclass(frozen=True)
class Shift:
    """Errors added to the pressures [Pa]: of p_tank, and of p_run and p_c in the liquid and in the vapour phase."""

    tank: float = 0.0
    run: float = 0.0
    chamber: float = 0.0


@dataclass(frozen=True)
class Tables:
    """Per-sample quantities that all repetitions share: density of the saturated liquid and its slope by pressure."""

    time: Array
    density: Array
    density_slope: Array
    run: Array
    chamber: Array
    loss: Array

    @classmethod
    def of(cls, histories: Histories, saturation: Saturation) -> Tables:
        """From the measured pressures."""
        t = histories.tank_temperature(saturation)
        volume, slope = saturation.liquid_volume(t)
        by_pressure = -slope / volume**2 / saturation.pressure_slope(t)
        loss = histories.tank - histories.run
        arrays = (1.0 / volume, by_pressure, histories.run, histories.chamber, loss)
        return cls(histories.time, *(np.ascontiguousarray(a) for a in arrays))


@dataclass(frozen=True)
class Reduction:
    """Result: C_i [-], m [-], Z [-], K_loss [1/m^4], mean losses [Pa], vapour mass at t_v [kg]; NaN: there is none."""

    C_i: float
    m: float
    Z: float
    K_loss: float
    loss_liquid: float
    loss_vapor: float
    vapor_mass: float
    vapor_mass_end: float
    temperature_v: float


class Vapor(Protocol):
    """Another model of the vapour phase than the report's."""

    def shoot(self, inputs: Inputs, shift: Shift, area: float) -> tuple[float, float]:
        """m and the mass at the end [kg], NaN where there is none; ``area``: effective, of the injector [m^2]."""


def reduce(
    tables: Tables, saturation: Saturation, inputs: Inputs, shift: Shift = Shift(), vapor_phase: Vapor | None = None
) -> Reduction:
    """One reduction with the given inputs and shifted pressures; m of the report's vapour, or of ``vapor_phase``."""
    p_v = inputs.p_v + shift.tank
    t_v = float(saturation.temperature(p_v))
    vapor = inputs.volume * float(saturation.vapor_density(t_v))
    flow_integral, loss_sum, square_sum, loss_mean = _liquid_sums(
        tables.time,
        tables.density + shift.tank * tables.density_slope,
        tables.run - tables.chamber + (shift.run - shift.chamber),
        tables.loss + (shift.tank - shift.run),
        inputs.t_feed,
        min(SETTLING * inputs.t_feed, 0.5 * (inputs.t_feed + inputs.t_v)),
        inputs.t_v,
    )
    C_i = (inputs.mass - vapor) / (inputs.area * flow_integral) if flow_integral > 0.0 else np.nan
    area = C_i * inputs.area
    factor = loss_sum / (2.0 * area**2 * square_sum) if square_sum > 0.0 else np.nan
    z = p_v * inputs.volume / (vapor * SPECIFIC_GAS_CONSTANT * t_v)
    loss = tables.loss + (shift.tank - shift.run)
    chamber = tables.chamber + shift.chamber
    m, end_mass, loss_vapor = _shoot(
        tables.time,
        loss,
        chamber,
        inputs.t_v,
        inputs.t_end,
        p_v,
        inputs.p_end + shift.tank,
        vapor,
        inputs.volume,
        area,
        EXPONENTS,
    )
    if vapor_phase is not None:
        m, end_mass = vapor_phase.shoot(inputs, shift, area)
    return Reduction(C_i, m, z, factor, loss_mean, loss_vapor, vapor, end_mass, t_v)


@compiled
def _liquid_sums(
    time: Array, density: Array, drop: Array, loss: Array, t_feed: float, t_steady: float, t_v: float
) -> tuple[float, float, float, float]:
    """Integral of sqrt(2 rho dp) to t_v; sums of loss * dp and dp * dp from t_steady, mean loss from t_feed to t_v."""
    integral = 0.0
    products = squares = losses = 0.0
    count = 0
    before_time, before = 0.0, _specific_flow(density[0], drop[0])
    for i in range(time.size):
        flow = _specific_flow(density[i], drop[i])
        if time[i] >= t_v:
            step = time[i] - before_time
            part = (t_v - before_time) / step if step > 0.0 else 0.0
            integral += before * (t_v - before_time) if part < 1.0 else 0.5 * (before + flow) * step
            before_time = t_v
            break
        integral += 0.5 * (before + flow) * (time[i] - before_time)
        before_time, before = time[i], flow
        if time[i] >= t_steady and drop[i] > 0.0:
            # both losses go with mdot^2 / rho = 2 (C A)^2 (p_run - p_c): least squares of the loss on that
            products += loss[i] * drop[i]
            squares += drop[i] * drop[i]
        if time[i] >= t_feed:
            losses += loss[i]
            count += 1
    integral += before * max(t_v - before_time, 0.0)
    return integral, products, squares, losses / max(count, 1)


@compiled
def _specific_flow(density: float, drop: float) -> float:
    return np.sqrt(2.0 * density * drop) if drop > 0.0 else 0.0


@compiled
def _vapor_end(
    time: Array,
    loss: Array,
    chamber: Array,
    t_v: float,
    t_end: float,
    p_v: float,
    mass: float,
    volume: float,
    area: float,
    m: float,
) -> float:
    """Vapour mass at t_end [kg] for a polytropic exponent m (report, eq. 3.11 with measured p_loss and p_c)."""
    left = mass
    t = t_v
    i = min(int(np.searchsorted(time, t_v)), time.size - 1)
    while t < t_end and i < time.size:
        step = min(time[i], t_end) - t
        back = loss[i] + chamber[i]
        w1 = _vapor_flow(p_v * (left / mass) ** m - back, left / volume, area)
        middle = max(left - 0.5 * step * w1, 1e-6 * mass)
        w2 = _vapor_flow(p_v * (middle / mass) ** m - back, middle / volume, area)
        left = max(left - step * w2, 1e-6 * mass)
        t = min(time[i], t_end)
        i += 1
    return left


@compiled
def _vapor_flow(drop: float, density: float, area: float) -> float:
    return area * np.sqrt(2.0 * density * drop) if drop > 0.0 else 0.0


@compiled
def _shoot(
    time: Array,
    loss: Array,
    chamber: Array,
    t_v: float,
    t_end: float,
    p_v: float,
    p_end: float,
    mass: float,
    volume: float,
    area: float,
    exponents: Array,
) -> tuple[float, float, float]:
    """m at which the model reaches p_end at t_end; the vapour mass there; the mean loss over the phase. NaN: none."""
    if not (t_end > t_v and area > 0.0 and mass > 0.0):
        return np.nan, np.nan, np.nan
    total, count = 0.0, 0
    for i in range(time.size):
        if t_v <= time[i] < t_end:
            total += loss[i]
            count += 1
    mean_loss = total / count if count > 0 else np.nan
    args = time, loss, chamber, t_v, t_end, p_v, mass, volume, area
    low, high = _bracket(args, p_end, exponents, 0, exponents.size - 1, COARSE)
    if low < 0:
        low, high = 0, exponents.size - 1  # a root that the coarse scan stepped over
    low, high = _bracket(args, p_end, exponents, low, high, 1)
    if low < 0:
        return np.nan, np.nan, mean_loss
    m = _root(args, p_end, exponents[low], exponents[high])
    return m, _vapor_end(*args, m), mean_loss


@compiled
def _excess(args: Phase, p_end: float, m: float) -> float:
    """Pressure at t_end over the measured [Pa]."""
    return float(args[5] * (_vapor_end(*args, m) / args[6]) ** m - p_end)


@compiled
def _bracket(args: Phase, p_end: float, exponents: Array, first: int, last: int, stride: int) -> tuple[int, int]:
    """The first interval of so many points of the grid across which the excess turns negative; -1: none."""
    k, before = first, _excess(args, p_end, exponents[first])
    while k < last:
        following = min(k + stride, last)
        excess = _excess(args, p_end, exponents[following])
        if before > 0.0 >= excess:
            return k, following
        k, before = following, excess
    return -1, -1


@compiled
def _root(args: Phase, p_end: float, low: float, high: float) -> float:
    """Root of the excess in a bracket: false position, the end that stays halved in weight (Illinois)."""
    at_low, at_high = _excess(args, p_end, low), _excess(args, p_end, high)
    for _ in range(60):
        m = high - at_high * (high - low) / (at_high - at_low)
        moved, excess = abs(m - high), _excess(args, p_end, m)
        if excess * at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        high, at_high = m, excess
        if moved < ROOT or excess == 0.0:
            break
    return high
