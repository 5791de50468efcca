"""The sensors of a stand from test to test: whose zero or gain drifts, and in which test one was off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot

from hfanalysis.campaign.family import left_the_family
from hfanalysis.campaign.trends import STEADY, by_chance
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import Course, Reading, SensorRow, TestRow
from hfanalysis.products.ingest import Ingest
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition

CELL = "m_tank"


def readings_of(
    definition: TestDefinition, ingest: Ingest | None, calibration: Calibration | None
) -> dict[str, Reading]:
    """What a test says of its sensors, by channel, with the serial numbers that are stated: zeros [SI] that were taken,
    and the gain [-] of the tank's cell where the load is stated."""
    zeros = {
        name: Quantity(found.zero, found.unit, found.zero_std)
        for name, found in (ingest.channels if ingest else {}).items()
        if found.zero_std is not None
    }
    gain = _gain(definition, calibration)
    serial = {name: spec.sensor for name, spec in definition.channels.items()}
    return {
        name: Reading(sensor=serial.get(name), zero=zeros.get(name), gain=gain if name == CELL else None)
        for name in dict.fromkeys([*zeros, *([CELL] if gain else [])])
    }


def _gain(definition: TestDefinition, calibration: Calibration | None) -> Quantity | None:
    """The load that the tank's cell showed at rest over the one that was stated."""
    stated = definition.tank.oxidizer_mass if definition.tank else None
    cell = calibration.rest.load_cell_mass if calibration and calibration.rest else None
    if stated is None or cell is None or not cell.value or not cell.std:
        return None
    gain = cell.value / stated.value
    by_load = definition.known_std("tank.oxidizer_mass") / stated.value
    return Quantity(gain, "", gain * hypot(cell.std / cell.value, by_load))


def sensors_of(rows: Mapping[str, TestRow]) -> dict[str, SensorRow]:
    """The sensors of a stand's tests that were in two of them at least; another serial number is another sensor."""
    by_sensor: dict[str, dict[str, tuple[str, Reading]]] = {}
    for test in sorted(rows, key=lambda test: (rows[test].date or "", test)):
        for channel, reading in rows[test].sensors.items():
            by_sensor.setdefault(reading.sensor or channel, {})[test] = (channel, reading)
    return {sensor: _row(found) for sensor, found in sorted(by_sensor.items()) if len(found) > 1}


def _row(found: Mapping[str, tuple[str, Reading]]) -> SensorRow:
    zeros = {test: reading.zero for test, (_, reading) in found.items() if reading.zero}
    gains = {test: reading.gain for test, (_, reading) in found.items() if reading.gain}
    channel = list(found.values())[-1][0]
    return SensorRow(channel=channel, zero=_course(zeros), gain=_course(gains))


def _course(by_test: dict[str, Quantity]) -> Course | None:
    if len(by_test) < 2:
        return None
    tests, values = list(by_test), [quantity.value or 0.0 for quantity in by_test.values()]
    beyond = tuple(tests[i] for i in left_the_family(values))
    return Course(by_test=by_test, drifts=by_chance(range(len(values)), values), left=beyond)


def courses(sensors: Mapping[str, SensorRow]) -> Iterator[tuple[str, str, Course]]:
    """Every course of the sensors, with the sensor's name and with what it is of, "zero" or "gain"."""
    for name, row in sensors.items():
        yield from ((name, what, found) for what in ("zero", "gain") if (found := getattr(row, what)) is not None)


def drifts(course: Course) -> bool:
    """Whether a number rises or falls too steadily for chance."""
    return course.drifts is not None and course.drifts < STEADY
