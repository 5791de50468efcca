"""The tank's reduction in compiled form, for any number of inputs at once: see :mod:`hfanalysis.calibrate.blowdown`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.calibrate.choked_vapor import VAPOR_M, coefficient_of, exponent_of
from hfanalysis.compiled import compiled, inner, law
from hfanalysis.engine import equations as eq
from hfanalysis.engine.blowdown import march
from hfanalysis.engine.equations import TANK, Equations
from hfanalysis.engine.injector import mass_flow
from hfanalysis.engine.tank import compressibility
from hfanalysis.roots import root_between, root_near
from hfanalysis.thermo.saturation import (
    LN_PRESSURE,
    LN_VAPOR_CP,
    LN_VAPOR_CV,
    LN_VAPOR_VOLUME,
    VAPOR_GRUENEISEN,
    evaluate,
    saturation_temperature,
)

EXPONENTS = (0.05, 6.0)
"""Between which m [-] is looked for; no gas expands outside. Evidence: test_refusals.py: a tank that empties faster
than any exponent lets it has none."""

VAPOR_STEPS = 60
"""Steps of the tank alone over the vapor phase: a second of smooth course, what is measured as means over them."""

ROOT = 1e-7
"""To what m [-] is found; its standard deviation is some 1e-2 (docs/calibration.md). Evidence: HF4 and HF5: 0.01 to
0.02."""

NEAR = 0.05
"""Of m [-], within which it is looked for around a guess first. Source: by choice, for speed: some of its standard
deviations; beyond it the whole range is looked through."""

SETTLING = 2.0
"""K_loss is taken from this many t_feed on. Evidence: at t_feed itself, where the line has 98 % of its pressure, it
still fills."""

WARM = 280.0
"""Where the search for a saturation temperature begins [K]; any will do."""


class Record(NamedTuple):
    """What was measured, each (n,), SI: density of the saturated liquid and its slope by pressure, pressures before and
    behind the injector, the feed loss, and the integrals of the last two over time from the first sample on."""

    time: Array
    density: Array
    density_slope: Array
    run: Array
    chamber: Array
    loss: Array
    loss_total: Array
    chamber_total: Array


class Fluid(NamedTuple):
    """Saturated nitrous oxide: its table, and between which temperatures [K] and pressures [Pa] it holds."""

    table: tuple[Array, float, float, float]
    coldest: float
    warmest: float
    lowest: float
    highest: float


class Vapor(NamedTuple):
    """The tank alone from the end of the liquid on: its equations, the states that move, and where they start.

    ``beside`` [Pa]: its pressure there less the nitrous oxide's own.
    """

    equations: Equations
    moving: Integers
    state: Array
    beside: float


(I_MASS, I_VOLUME, I_AREA, I_T_FEED, I_T_V, I_T_END, I_P_V, I_P_END, I_DISCHARGE, I_LOSS, I_EXPONENT) = range(11)
"""What is put in, in the order of the fields of Inputs."""

(C_I, M, Z, K_LOSS, LOSS_LIQUID, LOSS_VAPOR, VAPOR_MASS, VAPOR_MASS_END, TEMPERATURE_V, M_CHOKED, VAPOR_C_D) = range(11)
"""What comes out, in the order of the fields of Reduction."""

S_TANK, S_RUN, S_CHAMBER = range(3)
"""Errors of the pressures, in the order of the fields of Shift."""


Shot = tuple[Equations, Integers, Array, Array, Array, Array, float, float]


@inner
def _beyond_end(m: float, given: Shot) -> float:
    """The pressure [Pa] that the tank comes to beyond that which it came to; of a tank that runs empty, the first."""
    equations, moving, state, time, chamber, loss, first, end = given
    state[eq.EXPONENT] = m
    reached = march(equations, moving, state, time, chamber, loss, True)[1][-1, eq.O_TANK_PRESSURE]
    return float((reached if np.isfinite(reached) else first) - end)


_exponent = law(root_near(law(root_between(_beyond_end))))


@compiled
def reduced(record: Record, fluid: Fluid, vapor: Vapor, inputs: Array, shifts: Array) -> Array:
    """Reductions (k, 11) with the ``inputs`` (k, 11) [SI] and the pressures off by ``shifts`` (k, 3) [Pa].

    m is looked for about that of the first, and then anywhere.
    """
    out = np.empty((inputs.shape[0], VAPOR_C_D + 1))
    for k in range(inputs.shape[0]):
        for i in range(out.shape[1]):
            out[k, i] = np.nan
        _reduce(record, fluid, vapor, inputs[k], shifts[k], out[0], out[k])
    return out


@inner
def _reduce(
    record: Record, fluid: Fluid, vapor: Vapor, x: Array, shift: Array, about: Array, out: Array
) -> None:  # fmt: skip
    p_v = x[I_P_V] + shift[S_TANK]
    t_v = temperature_at(fluid, p_v)
    mass = x[I_VOLUME] * vapor_density(fluid, t_v)
    integral, products, squares, loss_mean = liquid_sums(record, x, shift)
    C_i = (x[I_MASS] - mass) / (x[I_AREA] * integral) if integral > 0.0 else np.nan
    C_i = x[I_DISCHARGE] if np.isfinite(x[I_DISCHARGE]) else C_i
    area = C_i * x[I_AREA]
    factor = products / (2.0 * area**2 * squares) if squares > 0.0 else np.nan
    out[C_I], out[LOSS_LIQUID], out[VAPOR_MASS], out[TEMPERATURE_V] = C_i, loss_mean, mass, t_v
    out[K_LOSS] = x[I_LOSS] if np.isfinite(x[I_LOSS]) else factor
    out[Z] = compressibility(p_v, x[I_VOLUME], mass, t_v)
    guess, choked, needed = about[M], about[M_CHOKED], about[VAPOR_C_D]
    out[M] = x[I_EXPONENT]
    if not x[I_T_END] > x[I_T_V]:
        return
    out[LOSS_VAPOR] = _loss_vapor(record, x, shift) if area > 0.0 else np.nan
    time = np.empty(VAPOR_STEPS + 1)
    for i in range(time.size):
        time[i] = x[I_T_V] + i * (x[I_T_END] - x[I_T_V]) / VAPOR_STEPS
    loss = means(record.time, record.loss_total, time, shift[S_TANK] - shift[S_RUN])
    chamber = means(record.time, record.chamber_total, time, shift[S_CHAMBER])
    if area > 0.0:
        out[M], out[VAPOR_MASS_END] = vapor_exponent(fluid, vapor, x, shift[S_TANK], area, time, loss, chamber, guess)
    if C_i > 0.0:
        gamma, end = isentropic_exponent(fluid, t_v), x[I_P_END] + shift[S_TANK]
        measured = (time, loss, chamber, x[I_VOLUME], x[I_AREA], p_v, mass, end, gamma, False)
        out[M_CHOKED] = exponent_of(measured, C_i, choked)
        out[VAPOR_C_D] = coefficient_of(measured, VAPOR_M, needed)


@compiled
def vapor_exponent(
    fluid: Fluid, vapor: Vapor, x: Array, shift: float, area: float, time: Array, loss: Array, chamber: Array,
    guess: float,
) -> tuple[float, float]:  # fmt: skip
    """m at which the tank alone reaches its pressure at the end, and its nitrous oxide there [kg]; NaN: there is none.

    ``x`` (11,) the inputs, ``shift`` [Pa] the error of the tank's pressure, ``area`` of the injector, effective [m^2];
    feed ``loss`` and ``chamber`` pressure [Pa] at ``time`` [s], each (n,); ``guess``: about which m is looked for.
    """
    state, pressure = vapor.state.copy(), x[I_P_V] + shift - vapor.beside
    warm = temperature_at(fluid, pressure)
    mass = x[I_VOLUME] * vapor_density(fluid, warm)
    state[eq.TANK], state[eq.TEMPERATURE] = mass, warm
    state[eq.COMPRESSIBILITY] = compressibility(pressure, x[I_VOLUME], mass, warm)
    vapor.equations.c[eq.VOLUME], vapor.equations.c[eq.AREA] = x[I_VOLUME], area
    given = (vapor.equations, vapor.moving, state, time, chamber, loss, x[I_P_V], x[I_P_END] + shift)
    m = x[I_EXPONENT]
    if not np.isfinite(m):
        m = _exponent(given, EXPONENTS[0], EXPONENTS[1], ROOT, guess, NEAR)
    if not np.isfinite(m):
        return np.nan, np.nan
    state[eq.EXPONENT] = m
    return m, march(vapor.equations, vapor.moving, state, time, chamber, loss, True)[0][-1, TANK]


@inner
def temperature_at(fluid: Fluid, pressure: float) -> float:
    """Of saturation [K] at a ``pressure`` [Pa]; NaN outside the range."""
    if not (fluid.lowest <= pressure and pressure <= fluid.highest):
        return np.nan
    table, start, step, critical = fluid.table
    return float(
        saturation_temperature(table, start, step, critical, pressure, WARM, fluid.coldest, fluid.warmest)
    )  # fmt: skip


@inner
def _row(fluid: Fluid, row: int, temperature: float) -> float:
    table, start, step, critical = fluid.table
    held = fluid.coldest - 1e-9 <= temperature and temperature <= fluid.warmest + 1e-9
    return float(evaluate(table, start, step, critical, row, temperature)[0]) if held else np.nan


@inner
def vapor_density(fluid: Fluid, temperature: float) -> float:
    """Of the saturated vapor [kg/m^3] at a ``temperature`` [K]; NaN outside the range."""
    return float(np.exp(-_row(fluid, LN_VAPOR_VOLUME, temperature)))


@inner
def isentropic_exponent(fluid: Fluid, temperature: float) -> float:
    """As :meth:`hfanalysis.thermo.saturation.Saturation.isentropic_exponent`, at one ``temperature`` [K]."""
    cv, cp = np.exp(_row(fluid, LN_VAPOR_CV, temperature)), np.exp(_row(fluid, LN_VAPOR_CP, temperature))
    volume = np.exp(_row(fluid, LN_VAPOR_VOLUME, temperature))
    pressure = np.exp(_row(fluid, LN_PRESSURE, temperature))
    by_heat = _row(fluid, VAPOR_GRUENEISEN, temperature) ** 2 * cv * temperature
    return float(cp / (cp - cv) * by_heat / (pressure * volume))


@compiled
def means(time: Array, total: Array, at: Array, more: float) -> Array:
    """Means over the cells about increasing times ``at`` (k,) [s] of what has the integral ``total`` (n,) over ``time``
    (n,) [s], each and ``more``.

    By plain loops: what of numpy numba brings along for them loads a library of linear algebra besides.
    """
    out, k, edge, before = np.empty(at.size), 0, at[0], 0.0
    for i in range(at.size + 1):
        end = at[0] if i == 0 else at[-1] if i == at.size else 0.5 * (at[i - 1] + at[i])
        while k < time.size - 2 and time[k + 1] <= end:
            k += 1
        part = min(max((end - time[k]) / (time[k + 1] - time[k]), 0.0), 1.0)
        whole = total[k] + part * (total[k + 1] - total[k])
        if i > 0:
            out[i - 1] = (whole - before) / (end - edge) + more
        edge, before = end, whole
    return out


@inner
def _loss_vapor(record: Record, x: Array, shift: Array) -> float:
    """Mean of the feed loss [Pa] from t_v to the end of the vapor phase; NaN without a sample there."""
    total, count = 0.0, 0
    for i in range(record.time.size):
        if x[I_T_V] <= record.time[i] and record.time[i] < x[I_T_END]:
            total += record.loss[i]
            count += 1
    return total / count + shift[S_TANK] - shift[S_RUN] if count else np.nan


@inner
def liquid_sums(record: Record, x: Array, shift: Array) -> tuple[float, float, float, float]:
    """Integral of sqrt(2 rho dp) to t_v; sums of loss * dp and dp * dp from SETTLING on, mean loss from t_feed to t_v.

    Of the ``record`` with the inputs ``x`` (11,) [SI] and pressures off by ``shift`` (3,) [Pa].
    """
    time, t_feed, t_v = record.time, x[I_T_FEED], x[I_T_V]
    steady = min(SETTLING * t_feed, 0.5 * (t_feed + t_v))
    integral = products = squares = losses = before_time = before = 0.0
    count = 0
    for i in range(time.size):
        density = record.density[i] + shift[S_TANK] * record.density_slope[i]
        drop = record.run[i] - record.chamber[i] + (shift[S_RUN] - shift[S_CHAMBER])
        loss = record.loss[i] + (shift[S_TANK] - shift[S_RUN])
        flow = mass_flow(1.0, density, drop)
        if i == 0:
            before = flow
        if time[i] >= t_v:
            step = time[i] - before_time
            part = (t_v - before_time) / step if step > 0.0 else 0.0
            integral += before * (t_v - before_time) if part < 1.0 else 0.5 * (before + flow) * step
            before_time = t_v
            break
        integral += 0.5 * (before + flow) * (time[i] - before_time)
        before_time, before = time[i], flow
        if time[i] >= steady and drop > 0.0:
            # both losses go with mdot^2 / rho = 2 (C A)^2 (p_run - p_c): least squares of the loss on that
            products += loss * drop
            squares += drop * drop
        if time[i] >= t_feed:
            losses += loss
            count += 1
    integral += before * max(t_v - before_time, 0.0)
    return integral, products, squares, losses / max(count, 1)
