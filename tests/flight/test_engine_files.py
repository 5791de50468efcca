"""Engine files keep the rules of the simulators that read them, and their impulse, whatever the curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.motor import Motor, Points, as_written, left_by_thrust, points_of, problems

MOTOR = Motor("HF 5; spare", 0.1281, 1.2345, 8.944, 21.5, "the team")


def curves() -> st.SearchStrategy[tuple[np.ndarray, np.ndarray]]:
    """Times from anywhere on, 10 ms to 2 s apart, and thrust up to 10 kN with noise below zero."""
    size = st.shared(st.integers(2, 400), key="size")
    steps = arrays(np.float64, size, elements=st.floats(0.01, 2.0))
    thrust = arrays(np.float64, size, elements=st.floats(-50.0, 1e4))
    return st.tuples(steps.map(np.cumsum), thrust).filter(lambda c: np.maximum(c[1], 0.0).mean() > 0.2)


def impulse(curve: tuple[np.ndarray, np.ndarray]) -> float:
    return float(np.trapezoid(np.maximum(curve[1], 0.0), curve[0]))


def loaded(points: Points) -> Points:
    """With a mass that falls and a center that moves back."""
    left = 8.944 * left_by_thrust(points)
    return Points(points.time, points.thrust, left, np.linspace(0.5, 0.7, points.time.size))


def test_the_burn_time_of_a_share_is_between_its_crossings() -> None:
    """Up from 0 in a second, 100 N for two, down in ten: above 5 N from 0.05 s to 12.5 s."""
    points = Points(np.array([0.0, 1.0, 3.0, 13.0]), np.array([0.0, 100.0, 100.0, 0.0]))
    time, mean = points.by_share(0.05)
    assert time == pytest.approx(12.5 - 0.05)
    assert mean == pytest.approx((0.95 * 52.5 + 200.0 + 9.5 * 52.5) / time)


@settings(deadline=None, max_examples=60)
@given(curves())
def test_a_curve_of_any_shape_keeps_rules_and_impulse(curve: tuple[np.ndarray, np.ndarray]) -> None:
    points = as_written(points_of(*curve))
    assert problems(points) == []
    assert points.impulse == pytest.approx(impulse(curve), rel=1e-3)


@settings(deadline=None, max_examples=40)
@given(curves())
def test_a_rasp_file_comes_back_as_it_was_written(curve: tuple[np.ndarray, np.ndarray]) -> None:
    first = rasp.of_points(MOTOR, points_of(*curve), ["thrust of a test", ""])
    motor, points, comments = rasp.read(first)
    assert rasp.of_points(motor, points, comments) == first
    assert problems(points) == []
    assert points.time[0] > 0.0
    assert points.impulse == pytest.approx(impulse(curve), rel=1e-3)


@settings(deadline=None, max_examples=40)
@given(curves(), st.booleans())
def test_a_rocksim_file_comes_back_as_it_was_written(curve: tuple[np.ndarray, np.ndarray], weighed: bool) -> None:
    points = loaded(points_of(*curve)) if weighed else points_of(*curve)
    first = rocksim.text(MOTOR, points, ["thrust < 10 kN & rising", "a 'second' line"], (0.0233, 0.0381))
    motor, again, comments, radii = rocksim.read(first)
    assert rocksim.text(motor, again, comments, radii) == first
    assert problems(again) == []
    assert again.impulse == pytest.approx(impulse(curve), rel=1e-3)
    assert (again.mass is not None) == weighed


def test_the_header_carries_masses_and_sizes() -> None:
    points = points_of(np.linspace(0.0, 5.0, 400), np.full(400, 1000.0))
    motor = rasp.read(rasp.of_points(MOTOR, points))[0]
    assert motor.name == "HF-5-spare"
    assert (motor.diameter, motor.length) == pytest.approx((0.1281, 1.2345), abs=5e-5)
    assert (motor.propellant_mass, motor.total_mass) == (8.944, 21.5)
    assert rocksim.read(rocksim.text(MOTOR, points))[0] == MOTOR


def test_mass_and_center_of_gravity_are_carried_over_time() -> None:
    time = np.linspace(0.0, 5.0, 400)
    points = points_of(time, 1000.0 - 100.0 * time, 9.0 - time, 0.5 + 0.05 * time)
    read = rocksim.read(rocksim.text(MOTOR, points))[1]
    assert read.mass is not None
    assert read.center is not None
    assert np.interp(2.5, read.time, read.mass) == pytest.approx(6.5, abs=1e-3)
    assert np.interp(2.5, read.time, read.center) == pytest.approx(0.625, abs=1e-4)


def test_a_smooth_curve_is_thinned() -> None:
    time = np.linspace(0.0, 10.0, 20_000)
    points = points_of(time, 3000.0 * np.exp(-0.3 * time))
    assert points.time.size <= 203
    assert points.impulse == pytest.approx(float(np.trapezoid(3000.0 * np.exp(-0.3 * time), time)), rel=1e-9)


@pytest.mark.parametrize(
    ("time", "thrust", "said"),
    [
        ([0.0, 1.0, 2.0], [5.0, 5.0, 0.0], "5 N at t = 0"),
        ([0.1, 1.0, 1.0], [5.0, 5.0, 0.0], "do not increase"),
        ([0.1, 1.0, 2.0], [5.0, 5.0, 1.0], "last thrust of 1 N"),
        ([0.1, 1.0, 2.0], [5.0, -5.0, 0.0], "negative thrust"),
        ([0.1, 1.0, 2.0], [0.0, 0.0, 0.0], "no thrust"),
        ([0.1, 1.0, np.nan], [5.0, 1.0, 0.0], "not finite"),
        ([0.1], [5.0], "fewer than two"),
    ],
)
def test_what_breaks_a_rule_is_named(time: list[float], thrust: list[float], said: str) -> None:
    points = Points(np.array(time), np.array(thrust))
    assert said in "; ".join(problems(points))
    with pytest.raises(ValueError, match=said):
        rocksim.text(MOTOR, points)


def test_negative_and_growing_masses_are_named() -> None:
    time, thrust = np.array([0.0, 1.0, 2.0]), np.array([0.0, 5.0, 0.0])
    assert "negative mass" in problems(Points(time, thrust, np.array([1.0, 0.5, -0.1])))[0]
    assert "grows" in problems(Points(time, thrust, np.array([1.0, 1.5, 0.1])))[0]


def test_no_thrust_makes_no_file() -> None:
    with pytest.raises(ValueError, match="without thrust"):
        points_of(np.array([0.0, 1.0, 2.0]), np.array([-1.0, 0.0, -3.0]))


def test_a_file_of_another_maker_is_read_as_it_stands() -> None:
    content = (
        "; a comment\n\nX100 106.0 560.0 0-3-6 0.73 1.16 A B\n0.0 2.1\n0.05,252.0\n 2.0\t0.0\n;\nX200 1 1 0 1 1 C\n"
    )
    motor, points, comments = rasp.read(content)
    assert motor == Motor("X100", pytest.approx(0.106), pytest.approx(0.56), 0.73, 1.16, "A B")
    assert points.time.tolist() == [0.0, 0.05, 2.0]
    assert comments == ("a comment",)
    assert problems(points) == ["a thrust of 2.1 N at t = 0"]


@pytest.mark.parametrize(
    "content", ["", "; only words\n", "X 1 2\n0.1 5\n", "X 1 2 0 3 4 M\n0.1 much\n", "X 1 2 0 3 4 M\n"]
)
def test_what_is_no_rasp_file_is_refused(content: str) -> None:
    with pytest.raises(ValueError, match=r"line \d|no motor"):
        rasp.read(content)


@pytest.mark.parametrize(
    "content",
    ["", "<engine", "<a/>", "<l><engine code='X' dia='1' len='1' propWt='1' initWt='1'/></l>",
     "<l><engine><data><eng-data t='x' f='1'/></data></engine></l>"],
)  # fmt: skip
def test_what_is_no_rocksim_file_is_refused(content: str) -> None:
    with pytest.raises(ValueError, match=r"XML|<engine>|eng-data|number"):
        rocksim.read(content)
