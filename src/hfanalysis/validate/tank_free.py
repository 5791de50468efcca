"""tank_free: the tank model alone from t_feed on, with only the chamber pressure measured in (report, 4.2.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.calibrate.engine_of_test import effective_area, exponent, loss_factor
from hfanalysis.calibrate.evidence import line_at
from hfanalysis.engine.blowdown import Blowdown, FeedSystem, blow_down
from hfanalysis.engine.tank import split
from hfanalysis.errors import AbsentError
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.validate.residuals import Residual, compared

Array = NDArray[np.float64]

LONGEST = 60.0
"""Seconds after the opening up to which the model is compared."""


@dataclass(frozen=True)
class TankAlone:
    """A run of the tank alone: ``measured`` p_tank, the ``run`` at the same times, its ``chamber`` pressure [Pa].

    ``start`` is where it starts [s after the opening], ``exponent`` the calibrated one of the vapour (None: there is
    none); ``density`` [kg/m^3] of what leaves the tank.
    """

    measured: Signal
    run: Blowdown
    chamber: Array
    feed: FeedSystem
    start: float
    exponent: float | None
    density: Array

    @property
    def run_pressure(self) -> Array:
        """Modelled pressure before the injector: p_c + mdot^2 / (2 rho (C_i N_i A_i)^2) [Pa]."""
        return self.chamber + 0.5 * self.run.flow**2 / (self.density * self.feed.area**2)


def run_tank_alone(
    log: TestLog, segments: Segments, calibration: Mapping[str, Any], definition: TestDefinition, constant: bool
) -> TankAlone:
    """The tank from t_feed on with the measured chamber pressure; ``constant``: losses by phase instead of K_loss.

    ``calibration`` is the content of calibration.json. Raises AbsentError where C_i, and with it the model, cannot be
    had.
    """
    area = effective_area(definition, calibration)
    saturation = saturation_of(definition.model.properties)
    tank = Signal.of(log["p_tank"]).shifted(segments.t_open.value or 0.0)
    start = segments.time("t_feed") or 0.0
    part = tank.between(start, LONGEST)
    if part.time.size < 8:
        raise AbsentError("too few good samples of p_tank after t_feed")
    assert definition.tank is not None
    assert definition.tank.volume is not None
    feed = FeedSystem(definition.tank.volume.value, area, *_feed_loss(calibration, constant))
    chamber = _chamber(log, segments, definition, part.time)
    mass, temperature = _start(saturation, tank, feed, calibration, segments, start)
    m = calibration["m"]["value"]
    run = blow_down(saturation, feed, mass, temperature, part.time, chamber, exponent(calibration)[0])
    wet = ~(part.time >= run.t_v)
    density = np.where(
        wet, saturation.liquid_density(np.where(wet, run.temperature, temperature)), run.mass / feed.volume
    )
    return TankAlone(part, run, chamber, feed, start, m, density)


def run_tank_free(
    log: TestLog, segments: Segments, calibration: Mapping[str, Any], definition: TestDefinition
) -> list[Residual]:
    """Measured and modelled tank and run-line pressure from t_feed on.

    Raises AbsentError where C_i cannot be had. Where m is not identified the run ends with the liquid.
    """
    alone = run_tank_alone(log, segments, calibration, definition, definition.model.conventions == "report")
    time, run = alone.measured.time, alone.run
    keep = np.ones(time.size, dtype=bool)
    notes: tuple[str, ...] = ()
    if alone.exponent is None:
        keep = ~(time > run.t_v)
        notes = ("m is not identified: the tank-alone run ends with the liquid",)
    models = {"p_tank": run.pressure, "p_run": alone.run_pressure}
    return [
        compared(log, segments, name, time[keep], model[keep], notes) for name, model in models.items() if name in log
    ]


def _feed_loss(calibration: Mapping[str, Any], constant: bool) -> tuple[float, tuple[float, float] | None]:
    """K_loss, or the report's constant losses by phase."""
    if constant:
        liquid = calibration["p_loss_liquid"]["value"] or 0.0
        vapor = calibration["p_loss_vapor"]["value"]
        return 0.0, (liquid, vapor if vapor is not None else liquid)
    return loss_factor(calibration), None


def _chamber(log: TestLog, segments: Segments, definition: TestDefinition, time: Array) -> Array:
    channel = log.get("p_chamber")
    if channel is None:
        return np.full(time.size, definition.ambient_pressure.value)
    return Signal.of(channel).shifted(segments.t_open.value or 0.0).at(time)


def _start(
    saturation: Saturation,
    tank: Signal,
    feed: FeedSystem,
    calibration: Mapping[str, Any],
    segments: Segments,
    start: float,
) -> tuple[float, float]:
    """Mass [kg] and temperature [K] at t_feed.

    The temperature is that of the measured pressure; the mass is the loaded one less what the calibrated injector
    passed before.
    """
    pressure = line_at(tank, start)
    temperature = float(saturation.temperature(min(pressure, 0.9999 * saturation.pressure_range[1])))
    mass = float(calibration["mass_at_t_feed"]["value"])
    parts = split(saturation, feed.volume, mass, temperature)
    if min(parts.liquid, parts.vapor) < 0.0:
        side = "do not fit" if parts.vapor < 0.0 else "are less than the vapour of"
        raise AbsentError(
            f"the tank cannot be saturated at {start:.2f} s: {mass:.2f} kg {side} {feed.volume * 1e3:.1f} L at "
            f"{pressure / 1e5:.1f} bar; there is no tank model to run"
        )
    return mass, temperature
