"""The least of a sum of squares in a box, in few runs of the model."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.calibrate.descent import HELD, least

BOX = (np.full(2, -3.0), np.full(2, 3.0))


class Valley:
    """A bent valley (Rosenbrock's) that leaves something at its end, and how often it was asked."""

    def __init__(self, left: float = 0.0) -> None:
        self.left, self.asked = left, 0

    def __call__(self, x: Array) -> Array:
        self.asked += 1
        return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0], self.left * np.cos(x[0])])


def test_a_bent_valley_is_followed_to_its_end() -> None:
    valley = Valley()
    assert least(valley, np.eye(3), np.array([-1.2, 1.0]), BOX, 1e-7) == pytest.approx(np.ones(2), abs=1e-6)
    assert valley.asked < 120  # far from the valley's floor steps are short


@pytest.mark.parametrize("start", [(0.9, 0.9), (1.1, 1.0)])
def test_where_something_is_left_slopes_that_are_held_move_the_end_by_nothing(start: tuple[float, float]) -> None:
    x = least(Valley(0.5), np.eye(3), np.array(start), BOX, 1e-7)
    slope = 2.0 * (x[0] - 1.0) - 0.25 * np.sin(2.0 * x[0])  # along the floor, where the first residual is nothing
    assert abs(slope) < HELD
    assert x[1] == pytest.approx(x[0] ** 2, abs=1e-6)


def test_a_side_of_the_box_is_followed() -> None:
    low, high = np.full(2, -3.0), np.array([0.5, 3.0])
    assert least(Valley(), np.eye(3), np.zeros(2), (low, high), 1e-6) == pytest.approx([0.5, 0.25], abs=1e-5)


def test_where_there_is_no_model_is_not_gone_to() -> None:
    valley = Valley()
    found = least(lambda x: valley(x) if x[0] < 0.8 else None, np.eye(3), np.zeros(2), BOX, 1e-4)
    assert 0.7 < found[0] < 0.8
    assert least(lambda _: None, np.eye(3), np.ones(2), BOX, 1e-4).tolist() == [1.0, 1.0]
