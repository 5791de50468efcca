"""tank_free: the tank model alone from t_feed on, with only the chamber pressure measured in (report, 4.2.3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.blowdown import FeedSystem, blow_down
from hfanalysis.engine.tank import split
from hfanalysis.errors import AbsentError
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.validate.residuals import Residual, phases_of

Array = NDArray[np.float64]

LONGEST = 60.0
"""Seconds after the opening up to which the model is compared."""

SMOOTHING = 0.2
"""Seconds of the tank pressure through which a straight line gives the pressure that the run starts from."""


def run_tank_free(
    log: TestLog, segments: Segments, calibration: Mapping[str, Any], definition: TestDefinition
) -> Residual:
    """Measured and modelled tank pressure from t_feed on.

    ``calibration`` is the content of calibration.json. Raises AbsentError where C_i, and with it the model, cannot be
    had. Where m is not identified the run ends with the liquid.
    """
    area = _effective_area(calibration, definition)
    saturation = saturation_of(definition.model.properties)
    origin = segments.t_open.value or 0.0
    tank = Signal.of(log["p_tank"]).shifted(origin)
    start = segments.time("t_feed") or 0.0
    part = tank.between(start, LONGEST)
    if part.time.size < 8:
        raise AbsentError("too few good samples of p_tank after t_feed")
    assert definition.tank is not None
    assert definition.tank.volume is not None
    feed = FeedSystem(definition.tank.volume.value, area, *_feed_loss(calibration, definition))
    chamber = _chamber(log, segments, definition, part.time)
    mass, temperature = _start(saturation, tank, feed, calibration, segments, start)
    exponent = calibration["m"]["value"]
    run = blow_down(saturation, feed, mass, temperature, part.time, chamber, exponent or 1.0)
    keep = np.ones(part.time.size, dtype=bool)
    notes: tuple[str, ...] = ()
    if exponent is None:
        keep = ~(part.time > run.t_v)
        notes = ("m is not identified: the tank-alone run ends with the liquid",)
    phase = phases_of(part.time, start, segments.time("t_v"), segments.time("t_purge"))
    noise = np.full(part.time.size, tank.noise)
    time, measured, model, scatter = (c[keep] for c in (part.time, part.value, run.pressure, noise))
    return Residual("p_tank", "Pa", time, measured, model, scatter, phase[keep], notes)


def _effective_area(calibration: Mapping[str, Any], definition: TestDefinition) -> float:
    discharge = calibration["C_i"]
    if discharge["value"] is None:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: C_i is missing ({discharge['reason']})")
    if discharge["value"] <= 0.0:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: C_i is not positive ({discharge['why']})")
    assert definition.injector is not None
    assert definition.injector.area is not None
    return float(discharge["value"]) * definition.injector.area.value


def _feed_loss(calibration: Mapping[str, Any], definition: TestDefinition) -> tuple[float, tuple[float, float] | None]:
    """K_loss; under the report's conventions its constant losses by phase instead."""
    if definition.model.conventions == "report":
        liquid = calibration["p_loss_liquid"]["value"] or 0.0
        vapor = calibration["p_loss_vapor"]["value"]
        return 0.0, (liquid, vapor if vapor is not None else liquid)
    return max(calibration["K_loss"]["value"] or 0.0, 0.0), None


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
    head = tank.between(start, start + SMOOTHING + 8.0 * tank.step)
    pressure = (
        float(np.polyfit(head.time - start, head.value, 1)[1]) if head.time.size > 3 else tank.mean(start, np.inf)
    )
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
