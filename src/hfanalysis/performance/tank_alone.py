"""The tank model alone from t_feed on, with only the chamber pressure measured in (report, 4.2.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import effective_area, exponent, loaded_mass, loss_factor
from hfanalysis.engine.blowdown import TankAlone as Tank
from hfanalysis.engine.blowdown import tank_alone
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import NITROGEN, STATES
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.tank import split
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal, line_at
from hfanalysis.sentences import said, text
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation

LONGEST_COMPARED = 60.0
"""Seconds after the opening up to which the model is compared."""

FILLING_STEPS = 200
"""Steps of the tank from the opening to t_feed, where effects bring states of their own."""


@dataclass(frozen=True)
class TankRun:
    """A run of the tank alone at the times of ``measured`` p_tank; ``chamber`` and ``run_pressure`` [Pa], ``flow``
    through the injector [kg/s], ``mass`` [kg], liquid gone at ``t_v`` [s] (NaN: not).

    ``start`` is where it starts [s after the opening], ``exponent`` the calibrated one of the vapor (None: there is
    none); ``factor``: what effects make of the injector's flow; ``nitrogen``: its share of it.
    """

    measured: Signal
    pressure: Array
    flow: Array
    mass: Array
    t_v: float
    chamber: Array
    start: float
    exponent: float | None
    run_pressure: Array
    factor: Array
    nitrogen: Array


def run_tank_alone(
    log: TestLog,
    segments: Segments,
    calibration: TankConstants,
    definition: TestDefinition,
    constant: bool,
    effects: Sequence[Active] = (),
) -> TankRun:
    """The tank from t_feed on with the measured chamber pressure; ``constant``: losses by phase instead of K_loss.

    Raises AbsentError where C_i, and with it the model, cannot be had.
    """
    area = effective_area(definition, calibration)
    saturation = saturation_of(definition.model.properties)
    tank = Signal.of(log["p_tank"]).shifted(segments.t_open.value or 0.0)
    start = segments.time("t_feed") or 0.0
    part = tank.between(start, LONGEST_COMPARED)
    if part.time.size < 8:
        raise AbsentError("too few good samples of p_tank after t_feed")
    if definition.tank is None or definition.tank.volume is None:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: [tank] volume is not stated")
    feed = FeedSystem(definition.tank.volume.value, area, *_feed_loss(calibration, constant))
    chamber = _chamber(log, segments, definition, part.time)
    mass, temperature = _start(saturation, tank, feed, calibration, segments, start)
    m = calibration.m.value
    acting = [active for active in effects if active.effect.term is not None]
    ambient = definition.ambient_pressure.value
    alone = tank_alone(saturation, feed, mass, temperature, exponent(calibration)[0], ambient, acting)
    if acting:
        alone = _filled(alone, loaded_mass(definition, calibration), log, segments, definition, part)
    run = alone.run(part.time, chamber)
    wet = ~(part.time >= run.t_v)
    liquid = saturation.liquid_density(np.where(wet, run.temperature, temperature))
    factor = run.injector_factor(feed.area, np.where(wet, liquid, run.mass / feed.volume))
    return TankRun(
        part, run.pressure, run.flow, run.mass, run.t_v, chamber, start, m, run.run_pressure, factor,
        run.nitrogen_share,
    )  # fmt: skip


def _filled(
    tank: Tank, loaded: float, log: TestLog, segments: Segments, definition: TestDefinition, part: Signal
) -> Tank:
    """The tank with the states that effects have at t_feed: those of a run from the opening."""
    start, saturation = float(part.time[0]), tank.engine.saturation
    temperature, pressure = tank.engine.temperature, line_at(part, float(part.time[0]))
    ready = tank
    before = np.linspace(0.0, start, FILLING_STEPS + 1)
    for _ in range(2 if start > 0.0 else 0):
        first = tank.at(tank_mass=loaded, tank_temperature=temperature)
        filled = first.run(before, _chamber(log, segments, definition, before))
        beside = float(filled.pressure[-1]) - float(saturation.pressure(filled.temperature[-1]))
        temperature = float(saturation.temperature(min(pressure - beside, 0.9999 * saturation.pressure_range[1])))
        last = filled.states[-1]
        ready = tank.at(tank_temperature=temperature, tank_nitrogen=last[NITROGEN], own=last[len(STATES) :])
    return ready


def _feed_loss(calibration: TankConstants, constant: bool) -> tuple[float, tuple[float, float] | None]:
    """K_loss, or the report's constant losses by phase."""
    if constant:
        liquid = calibration.p_loss_liquid.value or 0.0
        vapor = calibration.p_loss_vapor.value
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
    calibration: TankConstants,
    segments: Segments,
    start: float,
) -> tuple[float, float]:
    """Mass [kg] and temperature [K] at t_feed.

    The temperature is that of the measured pressure; the mass is the loaded one less what the calibrated injector
    passed before.
    """
    pressure = line_at(tank, start)
    temperature = float(saturation.temperature(min(pressure, 0.9999 * saturation.pressure_range[1])))
    mass = calibration.mass_at_t_feed.value
    if mass is None:
        raise AbsentError(f"what is in the tank at t_feed is not known: {calibration.mass_at_t_feed.reason}")
    parts = split(saturation, feed.volume, mass, temperature)
    if min(parts.liquid, parts.vapor) < 0.0:
        side = "do not fit" if parts.vapor < 0.0 else "are less than the vapor of"
        raise AbsentError(
            text(
                "the tank cannot be saturated at {start:.2f} s: {mass:.2f} kg {side} {volume:.1f} L at {pressure}; "
                "there is no tank model to run",
                start=start,
                mass=mass,
                side=side,
                volume=feed.volume * 1e3,
                pressure=said(pressure, "bar", ".1f"),
            )
        )
    return mass, temperature
