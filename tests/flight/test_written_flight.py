"""What a flight's table and a simulator's script say, worked out by hand."""

from __future__ import annotations

import ast
from dataclasses import replace
from functools import cache
from math import pi, radians
from typing import Any

import numpy as np
import pytest
from simulated.engines import maelstrom

from hfanalysis.engine.unsteady import burn
from hfanalysis.flight.ascent import Ascent
from hfanalysis.flight.motor import Motor, Points
from hfanalysis.flight.rocketpy_script import Scripted, script
from hfanalysis.flight.summary import FlightSpread, quantities
from hfanalysis.rocket.aerodynamics import Fins, Nose, Shape, Tail
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.simulation import flown
from hfanalysis.thermo import atmosphere

DROGUE, MAIN = Parachute(1.55, 1.17), Parachute(2.20, 10.5, 457.0)
ROCKET = Vehicle(52.5, 0.529, 19478e-6, radians(6.0), 1402.0)
SHAPE = Shape(0.16, Nose("von_karman", 0.5), 2.5, Fins(4, 0.25, 0.05, 0.12, 0.2, 2.9), Tail(0.2, 0.1, 3.0))


@cache
def ascent() -> Ascent:
    return flown.ascend(maelstrom(), burn(maelstrom()), 6.05)


def test_the_way_down_is_weight_against_drag() -> None:
    """Under a canopy the rocket falls at the speed at which both are equal; as the main opens they are not."""
    found = {n: q.value for n, q in quantities(ROCKET, ascent(), 6.05, (DROGUE, MAIN)).items()}
    weight = 52.5 * 9.80665 * (6_371_000.0 / (6_371_000.0 + 1_402.0)) ** 2
    drag_areas = [1.55 * 1.17 + 0.529 * 19478e-6, 2.20 * 10.5 + 0.529 * 19478e-6]
    slow = [
        np.sqrt(2.0 * weight / (atmosphere.density(h) * a)) for h, a in zip((1_859.0, 1_402.0), drag_areas, strict=True)
    ]
    assert found["terminal_velocity_drogue"] == pytest.approx(slow[0], rel=0.01)
    assert found["terminal_velocity_main"] == pytest.approx(slow[1], rel=0.01)
    pull = 0.5 * atmosphere.density(1_859.0) * drag_areas[1] * slow[0] ** 2
    assert found["main_deployment_acceleration"] == pytest.approx((pull - weight) / 52.5, rel=0.03)


def test_a_quantity_has_the_deviation_of_the_drawn_flights() -> None:
    found = quantities(ROCKET, ascent(), 6.05, "no parachutes", {"apogee": FlightSpread(80.0, (2900.0, 3200.0))})
    assert (found["apogee"].std, found["apogee"].ci95) == (80.0, (2900.0, 3200.0))
    assert found["peak_velocity"].std is None


def stated(title: str = "a title", **change: Any) -> dict[str, Any]:
    """What the script states, by name."""
    time = np.array([0.0, 1.0, 2.0])
    points = Points(time, np.array([10.0, 2000.0, 0.0]), np.array([8.0, 4.0, 0.0]), np.full(3, 0.5))
    whole = Scripted(
        ROCKET, Motor("M", 0.13, 1.2, 8.0, 20.0, "us"), points, SHAPE, (DROGUE, MAIN), 6.05, 12.0, 60.0, 1.5, 0.038
    )
    tree = ast.parse(script(replace(whole, **change), title))
    found = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            try:
                found[node.targets[0].id] = ast.literal_eval(node.value)
            except ValueError:
                continue
    return found


@pytest.mark.parametrize("title", ['""" + exit() + """', "''' + exit() + '''", "{0.__class__}", "\\", "a\nexit()"])
def test_a_title_is_text_in_the_script_and_nothing_else(title: str) -> None:
    plain, hostile = stated(), stated(title)
    assert hostile.pop("TITLE") == title
    assert plain.pop("TITLE")
    assert hostile == plain


def test_a_script_states_the_rocket_as_it_is() -> None:
    """A solid cylinder's roll inertia is m r^2 / 2; RocketPy counts places from the tail."""
    found = stated()
    radius = np.sqrt(19478e-6 / pi)
    assert found["RADIUS"] == pytest.approx(radius)
    assert found["ROLL_INERTIA"] == pytest.approx(0.5 * 52.5 * radius**2)
    assert found["MOTOR_RADIUS"] == pytest.approx(0.065)
    assert found["INCLINATION"] == pytest.approx(84.0)
    assert [(c["name"], c["cd_s"], c["trigger"]) for c in found["PARACHUTES"]] == [
        ("drogue", pytest.approx(1.55 * 1.17), "apogee"),
        ("main", pytest.approx(2.20 * 10.5), 457.0),
    ]
    length = 0.5 + 2.5 + 0.2
    outside = found["SHAPE"]
    assert outside["nose"]["position"] == pytest.approx(length)
    assert outside["fins"]["position"] == pytest.approx(length - 2.9)
    assert (outside["tail"]["top_radius"], outside["tail"]["bottom_radius"]) == (0.08, 0.05)
    assert outside["tail"]["position"] == pytest.approx(0.2)


def test_a_rail_that_nobody_states_is_one_of_five_meters() -> None:
    """As long as those of student competitions at least; shorter ones would let the rocket turn in the wind."""
    assert stated()["RAIL_LENGTH"] == 6.05
    assert 4.0 <= stated(rail_length=None)["RAIL_LENGTH"] <= 6.0
