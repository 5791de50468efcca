"""What flowed, as far as the log and the calibration tell: oxidizer, fuel, mixture, and the gas that they make.

Until the liquid is gone the oxidizer's flow is the injector equation on the measured pressures; after that it is the
tank alone, without nitrogen. The fuel's flow is r = a G^n on that, which for a given flow has a closed form.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression, effective_area, loss_factor
from hfanalysis.engine.grain import opened, oxidizer_flux
from hfanalysis.engine.injector import mass_flows
from hfanalysis.engine.nozzle import expand_along
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError
from hfanalysis.performance.tank_alone import TankRun
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.nitrous import saturation as saturation_of

HISTORY_STEP = 0.02
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
        """Oxidizer over fuel flow [-], (n,) at ``time``."""
        burning = (self.fuel > LEAST_FLOW) & (self.oxidizer > LEAST_FLOW)
        return np.where(burning, self.oxidizer / np.where(burning, self.fuel, 1.0), np.nan)

    @property
    def total(self) -> Array:
        """Through the nozzle, the chamber's filling apart [kg/s], (n,)."""
        return self.oxidizer + self.fuel


@dataclass(frozen=True)
class Oxidizer:
    """All that passes the injector, and the nitrogen in it [kg/s], (n,) each at ``time`` [s after the opening]."""

    time: Array
    flow: Array
    nitrogen: Array

    @property
    def oxidizer(self) -> Array:
        """[kg/s], (n,)."""
        return self.flow - self.nitrogen


def oxidizer_flow(
    log: TestLog, segments: Segments, calibration: TankConstants, definition: TestDefinition, alone: TankRun,
    time: Array,
) -> Array:  # fmt: skip
    """[kg/s], (n,), at given times (n,) [s]: from the measured pressures while there is liquid, then from the tank
    alone.

    The injector's flow is that of the report, eq. 3.2.
    """
    origin = segments.t_open.value or 0.0
    tank = Signal.of(log["p_tank"]).shifted(origin).reduced(HISTORY_STEP).at(time)
    chamber = np.full(time.size, definition.ambient_pressure.value)
    if "p_chamber" in log:
        chamber = Signal.of(log["p_chamber"]).shifted(origin).reduced(HISTORY_STEP).at(time)
    source = saturation_of(definition.model.properties)
    density = source.liquid_density(source.temperature(np.clip(tank, *source.pressure_range)))
    area = effective_area(definition, calibration)
    if "p_run" in log:
        drop = Signal.of(log["p_run"]).shifted(origin).reduced(HISTORY_STEP).at(time) - chamber
    else:  # line and injector as the model has them: both lose with the square of the flow over the density
        drop = (tank - chamber) / (1.0 + 2.0 * loss_factor(calibration) * area**2)
    flow = mass_flows(area, density, drop)
    flow = flow * np.interp(time, alone.measured.time, alone.factor)
    later = np.interp(time, alone.measured.time, alone.flow, right=0.0)
    t_v = segments.time("t_v")
    found = flow if t_v is None else np.where(time < t_v, flow, later)
    return np.asarray(np.where(time < 0.0, 0.0, found))


def whole(time: Array, flow: Array, end: float) -> None:
    """Raise AbsentError where a flow (n,) [kg/s] at ``time`` (n,) [s] is not known from the opening to the burn's
    ``end`` [s]."""
    if time.size < 2:
        raise AbsentError(f"the log has no samples before the burn's end at {end:.2f} s")
    lost = np.flatnonzero(~np.isfinite(flow) & (time >= 0.0) & (time <= end))
    if lost.size:
        raise AbsentError(
            f"the tank's model cannot be run beyond {time[lost[0]]:.2f} s, and the burn goes on to {end:.2f} s: what "
            "passes the injector then is not known"
        )


def burn_fuel(engine: Engine, law: Regression, time: Array, oxidizer: Array, factor: Array | float = 1.0) -> Flows:
    """The fuel that this oxidizer flow [kg/s], (n,) at ``time`` [s], burns, at ``factor`` [-] times the rate of the
    law.

    r = a G^n, integrated in closed form for a given flow (report, 4.3.1).
    """
    steps = np.diff(time, prepend=time[0])
    flowing = oxidizer > 0.0
    summed = np.cumsum(factor * steps * np.where(flowing, oxidizer, 1.0) ** law.n * flowing)
    port = np.minimum(opened(engine.port_radius, law.a, law.n, pi**-law.n * summed), engine.outer_radius)
    burning = (port < engine.outer_radius) & (oxidizer > 0.0)
    flux = oxidizer_flux(np.maximum(oxidizer, 0.0), port)
    rate = np.where(burning, factor * law.a * np.where(burning, flux, 1.0) ** law.n, 0.0)
    return Flows(time, oxidizer, engine.grain.ring(port) * rate, rate, port)


@dataclass(frozen=True)
class NozzleFlow:
    """The nozzle on a given chamber pressure: ideal flow [kg/s], thrust [N], and the gas's R T [J/kg] and gamma."""

    flow: Array
    thrust: Array
    heat: Array
    gamma: Array


def nozzle_along(
    engine: Engine, pressure: Array, of_ratio: Array, ambient: float, throat_factor: Array | float = 1.0
) -> NozzleFlow:
    """What the nozzle does with gas of this mixture ``of_ratio`` [-] at this ``pressure`` [Pa], both (n,), into
    ``ambient`` [Pa].

    ``throat_factor`` [-]: of the throat's area. NaN where there is no mixture (report, eq. 3.37 to 3.43).
    """
    enthalpy = engine.oxidizer_enthalpy
    assert enthalpy is not None
    found = expand_along(
        engine.combustion.kernel, pressure, of_ratio, enthalpy, engine.throat_area * np.asarray(throat_factor),
        engine.exit_area, ambient,
    )  # fmt: skip
    return NozzleFlow(*found)
