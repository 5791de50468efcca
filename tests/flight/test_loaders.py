"""Engine files by the rules of the programs that load them (tests/flight/loaders.py says which, and which not)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.flight import loaders

from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.motor import Motor, Points, points_of

MOTOR = Motor("HF 5; spare", 0.1281, 1.2345, 8.944, 21.5, "the team")


def dense() -> st.SearchStrategy[Points]:
    """Curves of loggers of 0.5 Hz to 20 kHz, and 1 N and more throughout."""
    size = st.shared(st.integers(4, 300), key="size")
    steps = arrays(np.float64, size, elements=st.floats(5e-5, 2.0))
    thrust = arrays(np.float64, size, elements=st.floats(1.0, 1e4))
    curves = st.tuples(steps.map(np.cumsum), thrust).filter(lambda c: np.ptp(c[0]) > 0.1)
    return curves.map(lambda c: points_of(*c)).filter(lambda points: points.impulse > 100.0)  # an Isp of a second


@settings(deadline=None, max_examples=60)
@given(dense())
def test_a_rasp_file_is_taken_by_all(points: Points) -> None:
    text = rasp.of_points(MOTOR, points, ["thrust of a test", "± by the day's air"])
    assert loaders.openrocket_eng(text) == []
    assert loaders.thrustcurve_eng(text) == []
    header, curve = loaders.rocketpy_eng(text)
    assert header == ["HF-5-spare", "128.1", "1234.5", "P", "8.9440", "21.5000", "the-team"]
    assert np.trapezoid(*np.array(curve).T[::-1]) == pytest.approx(points.impulse, rel=1e-3)


@settings(deadline=None, max_examples=60)
@given(dense())
def test_a_rocksim_file_is_taken_by_all(points: Points) -> None:
    text = rocksim.text(MOTOR, points, ["a comment"], (0.02, 0.04))
    assert loaders.openrocket_rse(text) == []
    assert loaders.thrustcurve_rse(text) == []


def test_points_of_a_fast_logger_keep_their_distance_and_the_impulse() -> None:
    time = np.arange(0.0, 0.05, 1e-4)
    points = points_of(time, 1000.0 + 500.0 * np.sin(2e3 * time))
    assert np.diff(points.time).min() >= 5e-4
    assert points.impulse == pytest.approx(float(np.trapezoid(1000.0 + 500.0 * np.sin(2e3 * time), time)), rel=1e-6)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (("P", "0"), "not plugged"),
        (("8.9440", "28.9440"), "more propellant"),
        (("the-team", "the team"), "8 fields"),
    ],
)
def test_the_rules_find_what_breaks_them(spoil: tuple[str, str], said: str) -> None:
    text = rasp.of_points(MOTOR, points_of(np.linspace(0.0, 5.0, 50), np.full(50, 100.0)))
    assert said in loaders.openrocket_eng(text.replace(f" {spoil[0]}", f" {spoil[1]}", 1))[0]


def test_a_delay_of_zero_would_fire_a_charge() -> None:
    text = rocksim.text(MOTOR, points_of(np.linspace(0.0, 5.0, 50), np.full(50, 100.0)))
    assert loaders.openrocket_rse(text.replace('delays="P"', 'delays="0"')) == ["not plugged: 0"]


def test_close_times_are_refused_where_they_are() -> None:
    text = rasp.text(MOTOR, [(1e-3, 5.0), (1.2e-3, 5.0), (1.0, 0.0)])
    assert loaders.thrustcurve_eng(text) == ["times too close"]
