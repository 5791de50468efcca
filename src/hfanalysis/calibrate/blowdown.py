"""C_i, K_loss, Z and m from the measured pressures: the report's tank calibration (chapter 4.2) in compiled form.

C_i is that of which the flow, integrated from the opening to t_v, leaves just the saturated vapor at the tank pressure
of t_v:

    C_i = (m_o - V rho_v(T_v)) / integral of N_i A_i sqrt(2 rho_l (p_run - p_c)) dt

which is the report's iteration on C_i in closed form. m is found by shooting the tank alone over the vapor phase
to the pressure at t_purge.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import cached_property

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.choked_vapor import Expansion
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.reducing import VAPOR_STEPS, Fluid, Record, Vapor, means, reduced, vapor_exponent
from hfanalysis.engine.blowdown import GIVEN, HEAT, TankAlone, tank_alone
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.thermo.saturation import Saturation


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
    def record(self) -> Record:
        """As compiled code takes it."""
        step = np.diff(self.time)
        totals = (np.append(0.0, np.cumsum(0.5 * step * (x[1:] + x[:-1]))) for x in (self.loss, self.chamber))
        return Record(
            self.time, self.density, self.density_slope, self.run, self.chamber, self.loss, *totals
        )  # fmt: skip

    def behind(self, at: Array) -> list[Array]:
        """Feed loss and chamber pressure [Pa], each (k,), at increasing times (k,) [s]: means over the cells about
        them.
        """
        return [means(self.time, total, at, 0.0) for total in (self.record.loss_total, self.record.chamber_total)]


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

    def compiled(self) -> Vapor:
        """As compiled code takes it, with constants of its own that it may change."""
        equations = self.tank.equations._replace(c=self.tank.equations.c.copy())
        equations.c[HEAT - len(GIVEN)] = 0.0
        tank = self.tank.at(tank_nitrogen=self.nitrogen, own=self.own)
        return Vapor(equations, tank.moving, tank.state, self.beside)

    def shoot(self, tables: Tables, inputs: Inputs, shift: Shift, area: float) -> tuple[float, float]:
        """m at which the model reaches p_end at t_end, and the tank's nitrous oxide there [kg]; NaN: there is none.

        ``area``: effective, of the injector [m^2].
        """
        if not (inputs.t_end > inputs.t_v and area > 0.0):
            return inputs.m, np.nan
        time = np.linspace(inputs.t_v, inputs.t_end, VAPOR_STEPS + 1)
        loss, chamber = tables.behind(time)
        loss, chamber = loss + shift.tank - shift.run, chamber + shift.chamber
        fluid = fluid_of(self.tank.engine.saturation)
        x = np.array(astuple(inputs))
        return vapor_exponent(fluid, self.compiled(), x, shift.tank, area, time, loss, chamber, np.nan)


def fluid_of(saturation: Saturation) -> Fluid:
    """Saturated nitrous oxide as compiled code takes it."""
    return Fluid(saturation.kernel_table, saturation.t_min, saturation.t_max, *saturation.pressure_range)


def reduce(
    tables: Tables, saturation: Saturation, inputs: Inputs, shift: Shift = Shift(), phase: VaporPhase | None = None
) -> Reduction:
    """One reduction with the given inputs and shifted pressures; m along ``phase`` (default: without effects)."""
    rows = np.array([astuple(inputs)]), np.array([astuple(shift)])
    return Reduction(
        *map(float, reduce_all(tables, saturation, *rows, phase or VaporPhase.plain(saturation, inputs))[0])
    )


def reduce_all(tables: Tables, saturation: Saturation, inputs: Array, shifts: Array, phase: VaporPhase) -> Array:
    """Many reductions (k, 11), each as the fields of :class:`Reduction`: the same as :func:`reduce` one by one.

    ``inputs`` (k, 11) and ``shifts`` (k, 3) [SI]: rows as the fields of :class:`Inputs` and :class:`Shift`.
    """
    return np.asarray(reduced(tables.record, fluid_of(saturation), phase.compiled(), inputs, shifts))


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
