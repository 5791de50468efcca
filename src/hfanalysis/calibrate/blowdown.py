"""C_i, K_loss, Z and m from the measured pressures: the report's tank calibration (chapter 4.2) in compiled form.

C_i is that of which the flow, integrated from the opening to t_v, leaves just the saturated vapor at the tank pressure
of t_v:

    C_i = (m_o - V rho_v(T_v)) / integral of N_i A_i sqrt(2 rho_l (p_run - p_c)) dt

which is the report's iteration on C_i in closed form. m is found by shooting the tank alone over the vapor phase
to the pressure at t_purge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from hfanalysis.arrays import Array
from hfanalysis.calibrate.choked_vapor import VAPOR_M, Expansion
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.compiled import compiled
from hfanalysis.engine.blowdown import TankAlone, TankRun, tank_alone
from hfanalysis.engine.equations import TANK
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.injector import mass_flow
from hfanalysis.engine.tank import compressibility
from hfanalysis.thermo.saturation import Saturation

EXPONENTS = (0.05, 6.0)
"""Between which m [-] is looked for; no gas expands outside. Evidence: test_refusals.py: a tank that empties faster
than any exponent lets it has none."""

VAPOR_STEPS = 60
"""Steps of the tank alone over the vapor phase: a second of smooth course, what is measured as means over them."""

ROOT = 1e-7
"""To what m [-] is found; its standard deviation is some 1e-2 (docs/calibration.md). Evidence: HF4 and HF5: 0.01 to
0.02."""

NO_ANSWER = (np.nan, np.nan)
"""Of a vapor phase that is none."""

SETTLING = 2.0
"""K_loss is taken from this many t_feed on. Evidence: at t_feed itself, where the line has 98 % of its pressure, it
still fills."""


@dataclass(frozen=True)
class Inputs:
    """Everything the reduction takes besides the pressures; SI units.

    ``mass``: oxidizer loaded [kg]; ``volume``: tank and line [m^3]; ``area``: all injector holes [m^2]; ``t_feed``,
    ``t_v``, ``t_end``: line full, liquid gone, end of the pure vapor phase [s] (NaN: there is none); ``p_v``,
    ``p_end``: tank pressure at the last two [Pa]. ``C_i`` [-], ``K_loss`` [1/m^4] and ``m`` [-] are held where they are
    given (NaN: found).
    """

    mass: float
    volume: float
    area: float
    t_feed: float
    t_v: float
    t_end: float
    p_v: float
    p_end: float
    C_i: float = np.nan
    K_loss: float = np.nan
    m: float = np.nan


@dataclass(frozen=True)
class Shift:
    """Errors added to the pressures [Pa]: of p_tank, and of p_run and p_c in the liquid and in the vapor phase."""

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
    def of(cls, histories: MeasuredPressures, saturation: Saturation) -> Tables:
        """From the measured pressures."""
        t = histories.tank_temperature(saturation)
        volume, slope = saturation.liquid_volume(t)
        by_pressure = -slope / volume**2 / saturation.pressure_slope(t)
        loss = histories.tank - histories.run
        arrays = (1.0 / volume, by_pressure, histories.run, histories.chamber, loss)
        return cls(histories.time, *(np.ascontiguousarray(a) for a in arrays))

    @cached_property
    def _totals(self) -> list[Array]:
        step = np.diff(self.time)
        return [np.append(0.0, np.cumsum(0.5 * step * (x[1:] + x[:-1]))) for x in (self.loss, self.chamber)]

    def behind(self, at: Array) -> list[Array]:
        """Feed loss and chamber pressure [Pa], each (k,), at increasing times (k,) [s]: means over the cells about
        them.
        """
        edges = np.concatenate([at[:1], 0.5 * (at[1:] + at[:-1]), at[-1:]])
        return [np.diff(np.interp(edges, self.time, total)) / np.diff(edges) for total in self._totals]


@dataclass(frozen=True)
class Reduction:
    """Result: C_i [-], m [-], Z [-], K_loss [1/m^4], mean losses [Pa], vapor mass at t_v [kg]; NaN: there is none.

    Of vapor that chokes: ``m_choked`` at C_d = C_i, ``vapor_C_d`` at an m in the middle of what vapor has.
    """

    C_i: float
    m: float
    Z: float
    K_loss: float
    loss_liquid: float
    loss_vapor: float
    vapor_mass: float
    vapor_mass_end: float
    temperature_v: float
    m_choked: float
    vapor_C_d: float


@dataclass(frozen=True)
class VaporPhase:
    """How m is shot along the vapor phase: the ``tank`` alone from t_v on, the feed loss and p_c as measured.

    What effects leave in it at t_v: its pressure less that of saturation, ``beside`` [Pa], ``nitrogen`` [kg], and
    their ``own`` states.
    """

    tank: TankAlone
    beside: float = 0.0
    nitrogen: float = 0.0
    own: Array | None = None

    @classmethod
    def plain(cls, saturation: Saturation, inputs: Inputs) -> VaporPhase:
        """Without effects."""
        warm = float(saturation.temperature(inputs.p_v))
        return cls(tank_alone(saturation, FeedSystem(inputs.volume, inputs.area), inputs.mass, warm, 1.0))

    def shoot(self, tables: Tables, inputs: Inputs, shift: Shift, area: float) -> tuple[float, float]:
        """m at which the model reaches p_end at t_end, and the tank's nitrous oxide there [kg]; NaN: there is none.

        ``area``: effective, of the injector [m^2].
        """
        if not (inputs.t_end > inputs.t_v and area > 0.0):
            return inputs.m, np.nan
        tank, time = self._start(inputs, shift, area), np.linspace(inputs.t_v, inputs.t_end, VAPOR_STEPS + 1)
        loss, chamber = tables.behind(time)
        loss, chamber = loss + shift.tank - shift.run, chamber + shift.chamber

        def end(m: float) -> TankRun:
            return tank.at(vapor_exponent=m).run(time, chamber, loss, vapor=True)

        def miss(m: float) -> float:
            reached = float(end(m).pressure[-1])
            # a tank whose pressure hardly falls may run empty
            return (reached if np.isfinite(reached) else inputs.p_v) - inputs.p_end - shift.tank

        if np.isfinite(inputs.m):
            return inputs.m, float(end(inputs.m).states[-1, TANK])
        try:
            m = float(brentq(miss, *EXPONENTS, xtol=ROOT))
        except ValueError:  # the pressure falls too far, or not far enough, with any
            return np.nan, np.nan
        return m, float(end(m).states[-1, TANK])

    def _start(self, inputs: Inputs, shift: Shift, area: float) -> TankAlone:
        """The tank at t_v: saturated vapor at the pressure that is the nitrous oxide's own."""
        saturation, pressure = self.tank.engine.saturation, inputs.p_v + shift.tank - self.beside
        temperature = float(saturation.temperature(pressure))
        mass = inputs.volume * float(saturation.vapor_density(temperature))
        z = compressibility(pressure, inputs.volume, mass, temperature)
        return self.tank.with_feed(inputs.volume, area).at(
            tank_mass=mass, tank_temperature=temperature, tank_nitrogen=self.nitrogen, vapor_compressibility=z,
            own=self.own,
        )  # fmt: skip


def reduce(
    tables: Tables, saturation: Saturation, inputs: Inputs, shift: Shift = Shift(), phase: VaporPhase | None = None
) -> Reduction:
    """One reduction with the given inputs and shifted pressures; m along ``phase`` (default: without effects)."""
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
    C_i = inputs.C_i if np.isfinite(inputs.C_i) else C_i
    area = C_i * inputs.area
    factor = loss_sum / (2.0 * area**2 * square_sum) if square_sum > 0.0 else np.nan
    factor = inputs.K_loss if np.isfinite(inputs.K_loss) else factor
    z = compressibility(p_v, inputs.volume, vapor, t_v)
    m, end_mass = (phase or VaporPhase.plain(saturation, inputs)).shoot(tables, inputs, shift, area)
    dry = (tables.time >= inputs.t_v) & (tables.time < inputs.t_end)
    loss_vapor = float(tables.loss[dry].mean()) + shift.tank - shift.run if dry.any() and area > 0.0 else np.nan
    choked = expansion(tables, saturation, inputs, shift)
    m_choked, vapor_C_d = (choked.exponent(C_i), choked.coefficient(VAPOR_M)) if choked and C_i > 0.0 else NO_ANSWER
    return Reduction(C_i, m, z, factor, loss_mean, loss_vapor, vapor, end_mass, t_v, m_choked, vapor_C_d)


def expansion(tables: Tables, saturation: Saturation, inputs: Inputs, shift: Shift = Shift()) -> Expansion | None:
    """The vapor phase as measured, of nitrous oxide alone; None where there is none."""
    if not inputs.t_end > inputs.t_v:
        return None
    pressure, time = inputs.p_v + shift.tank, np.linspace(inputs.t_v, inputs.t_end, VAPOR_STEPS + 1)
    warm = float(saturation.temperature(pressure))
    mass, gamma = inputs.volume * float(saturation.vapor_density(warm)), float(saturation.isentropic_exponent(warm))
    loss, chamber = tables.behind(time)
    return Expansion(
        time, loss + shift.tank - shift.run, chamber + shift.chamber, inputs.volume, inputs.area, pressure, mass,
        inputs.p_end + shift.tank, gamma,
    )  # fmt: skip


@compiled
def _liquid_sums(
    time: Array, density: Array, drop: Array, loss: Array, t_feed: float, t_steady: float, t_v: float
) -> tuple[float, float, float, float]:
    """Integral of sqrt(2 rho dp) to t_v; sums of loss * dp and dp * dp from t_steady, mean loss from t_feed to t_v."""
    integral = 0.0
    products = squares = losses = 0.0
    count = 0
    before_time, before = 0.0, mass_flow(1.0, density[0], drop[0])
    for i in range(time.size):
        flow = mass_flow(1.0, density[i], drop[i])
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
