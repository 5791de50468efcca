"""Engine files say what they rest on."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulated.purged import ROCKET, Truth, fired
from tests.flight import loaders

from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.engine_files import Export
from hfanalysis.measured_flight.motor import export
from hfanalysis.measured_flight.product import MeasuredFlight, fly_measured
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.rocket import Geometry
from hfanalysis.record.sections import Tank
from hfanalysis.units import Value

NO_STABILITY = "rocket.geometry.nose is not given"


@cache
def launched() -> MeasuredFlight:
    return fly_measured(fired(Truth(purge=False)).flown(), ROCKET, 20, 1)


def exported(**rocket: object) -> Export:
    stated = fired(Truth(purge=False)).definition
    tank = Tank(Value(16.5e-3), Value(8.35), inner_diameter=Value(0.13))
    changed: TestDefinition = replace(stated, tank=tank, rocket=replace(ROCKET, **rocket))
    return export(launched(), changed, NO_STABILITY)


def test_sizes_that_are_not_stated_are_said_to_be_those_of_tank_and_grain() -> None:
    motor, _, comments = rasp.read(exported().eng)
    assert (motor.diameter, motor.length) == (pytest.approx(0.13), pytest.approx(0.61))
    said = " ".join(comments)
    assert "no casing_length is stated" in said
    assert "no [rocket.geometry] is given" in said
    assert "thrust as measured, from the stand's ambient pressure to the altitude's" in said


def test_a_casing_that_is_stated_is_in_both_files() -> None:
    made = exported(casing_diameter=Value(0.14), casing_length=Value(2.1))
    for motor in (rasp.read(made.eng)[0], rocksim.read(made.rse)[0]):
        assert (motor.diameter, motor.length) == (pytest.approx(0.14), pytest.approx(2.1))
    assert "casing_length" not in made.eng


def test_the_propellant_s_center_is_there_where_tank_and_grain_are() -> None:
    """Tank 1.243 m from 2.1 m on, grain from 3.4 m and the pre-chamber on; counted from the tank's top."""
    made = exported(geometry=Geometry(tank_position=Value(2.1), chamber_position=Value(3.4)))
    _, points, comments, _ = rocksim.read(made.rse)
    assert points.center is not None
    assert points.mass is not None
    pre = 0.218e-3 / (np.pi * 39.497e-3**2)
    tank, grain = 16.5e-3 / (0.25 * np.pi * 0.13**2), 3.4 + pre + 0.305 - 2.1
    low, high = 0.45 * tank, tank
    load = (points.center[0] * (8.35 + 1.594) - 1.594 * grain) / 8.35
    assert low < load < high
    assert points.center[0] < points.center[-1]
    assert any("of tank and grain with what they hold" in line for line in comments)
    assert rocksim.read(exported().rse)[1].center is None


def test_burn_time_and_average_are_the_designation_s_under_their_own_names() -> None:
    made = exported()
    time, mean = made.points.by_share(0.05)
    assert f"burn_time_5_percent {time:.3f} s" in made.eng
    assert f"average_thrust_5_percent {mean:.1f} N" in made.rse
    assert f"N{mean:.0f}" in made.eng


def test_the_stand_s_thrust_has_a_file_of_its_own() -> None:
    """Its impulse is that of the stand; along the flight the air is thinner, and the thrust larger."""
    made = exported()
    motor, points, comments = rasp.read(made.static_eng)
    assert motor == rasp.read(made.eng)[0]
    assert points.impulse == pytest.approx(launched().firing.impulse_stand, rel=1e-3)
    assert "as measured on the stand, purge gas included, at an ambient pressure of" in comments[1]
    for text in (made.eng, made.static_eng):
        assert loaders.openrocket_eng(text) == loaders.thrustcurve_eng(text) == []
    assert loaders.openrocket_rse(made.rse) == loaders.thrustcurve_rse(made.rse) == []
