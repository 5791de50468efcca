"""What flowed, as far as the log and the calibration tell: oxidizer, fuel, mixture, and the gas that they make.

Until the liquid is gone the oxidizer's flow is the injector equation on the measured pressures; after that it is the
tank alone, without nitrogen. The fuel's flow is r = a G^n on that, which for a given flow has the closed form
r^(2 n + 1) = r_0^(2 n + 1) + (2 n + 1) a pi^-n integral of mdot^n dt.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.assembly.calibrated import Regression, effective_area
from hfanalysis.compiled import compiled
from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.unsteady import Engine
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.combustion_table import Grid, gas_at
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.validate.tank_free import TankAlone

Array = NDArray[np.float64]

STEP = 0.02
"""[s] of the histories: block means over this time."""

LEAST_FLOW = 1e-4
"""[kg/s] below which there is no mixture to speak of."""


@dataclass(frozen=True)
class Flows:
    """Histories at ``time`` [s after the opening]: flows [kg/s], ``rate`` of regression [m/s], ``port`` radius [m].

    ``of_ratio`` is NaN where either flow is nothing.
    """

    time: Array
    oxidizer: Array
    fuel: Array
    rate: Array
    port: Array

    @property
    def of_ratio(self) -> Array:
        """Oxidizer over fuel."""
        burning = (self.fuel > LEAST_FLOW) & (self.oxidizer > LEAST_FLOW)
        return np.where(burning, self.oxidizer / np.where(burning, self.fuel, 1.0), np.nan)

    @property
    def total(self) -> Array:
        """Through the nozzle, the chamber's filling apart [kg/s]."""
        return self.oxidizer + self.fuel


def oxidizer_flow(
    log: TestLog, segments: Segments, calibration: TankConstants, definition: TestDefinition, alone: TankAlone,
    time: Array,
) -> Array:  # fmt: skip
    """[kg/s] at given times: from the measured pressures while there is liquid, then from the tank alone."""
    origin = segments.t_open.value or 0.0
    tank, run = (Signal.of(log[name]).shifted(origin).reduced(STEP).at(time) for name in ("p_tank", "p_run"))
    chamber = np.full(time.size, definition.ambient_pressure.value)
    if "p_chamber" in log:
        chamber = Signal.of(log["p_chamber"]).shifted(origin).reduced(STEP).at(time)
    source = saturation_of(definition.model.properties)
    density = source.liquid_density(source.temperature(np.clip(tank, *source.pressure_range)))
    flow = effective_area(definition, calibration) * np.sqrt(2.0 * density * np.maximum(run - chamber, 0.0))
    flow = flow * np.interp(time, alone.measured.time, alone.factor)
    later = np.interp(time, alone.measured.time, alone.flow, right=0.0)
    t_v = segments.time("t_v")
    found = flow if t_v is None else np.where(time < t_v, flow, later)
    return np.asarray(np.where(time < 0.0, 0.0, found))


def burn_fuel(engine: Engine, law: Regression, time: Array, oxidizer: Array, factor: Array | float = 1.0) -> Flows:
    """The fuel that this oxidizer flow [kg/s] burns, at ``factor`` times the rate of the law."""
    power = 2.0 * law.n + 1.0
    steps = np.diff(time, prepend=time[0])
    flowing = oxidizer > 0.0
    summed = np.cumsum(factor * steps * np.where(flowing, oxidizer, 1.0) ** law.n * flowing)
    opened = engine.port_radius**power + power * law.a * pi**-law.n * summed
    port = np.minimum(opened ** (1.0 / power), engine.outer_radius)
    burning = (port < engine.outer_radius) & (oxidizer > 0.0)
    flux = np.maximum(oxidizer, 0.0) / (pi * port**2)
    rate = np.where(burning, factor * law.a * np.where(burning, flux, 1.0) ** law.n, 0.0)
    fuel = engine.fuel_density * 2.0 * pi * port * engine.grain_length * rate
    return Flows(time, oxidizer, fuel, rate, port)


@dataclass(frozen=True)
class Nozzle:
    """The nozzle on a given chamber pressure: ideal flow [kg/s], thrust [N], and the gas's R T [J/kg] and gamma."""

    flow: Array
    thrust: Array
    heat: Array
    gamma: Array


def nozzle_along(
    engine: Engine, pressure: Array, of_ratio: Array, ambient: float, throat_factor: Array | float = 1.0
) -> Nozzle:
    """What the nozzle does with gas of this mixture at this pressure [Pa]; NaN where there is no mixture.

    ``throat_factor``: of the throat's area.
    """
    enthalpy = engine.oxidizer_enthalpy
    assert enthalpy is not None
    throat = engine.throat_area * np.broadcast_to(throat_factor, pressure.shape)
    found = _nozzle_along(
        engine.combustion.kernel, np.ascontiguousarray(pressure), np.ascontiguousarray(of_ratio), ambient,
        throat, engine.exit_area, enthalpy,
    )  # fmt: skip
    return Nozzle(*found)


@compiled
def _nozzle_along(
    gas: Grid, pressure: Array, ratio: Array, ambient: float, throat: Array, exit_area: float, enthalpy: float
) -> Array:
    out = np.full((4, pressure.size), np.nan)
    for i in range(pressure.size):
        if not (ratio[i] > 0.0 and pressure[i] > 0.0):
            continue
        heat, gamma = gas_at(gas, np.log(pressure[i]), np.log(ratio[i]), enthalpy, 0.0)
        flow, thrust, _, _, _ = expand(gamma, heat, pressure[i], ambient, throat[i], exit_area)
        out[0, i], out[1, i], out[2, i], out[3, i] = flow, thrust, heat, gamma
    return out


def ideal_characteristic_velocity(heat: Array, gamma: Array) -> Array:
    """c* = sqrt(R T / gamma) ((gamma + 1)/2)^((gamma + 1)/(2 (gamma - 1))) [m/s]; R T [J/kg]."""
    power = 0.5 * (gamma + 1.0) / (gamma - 1.0)
    return np.asarray(np.sqrt(heat / gamma) * (0.5 * (gamma + 1.0)) ** power)
