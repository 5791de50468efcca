"""What flight.json says of stability, from margins of flights in gusts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from hfanalysis.flight.margin import margin
from hfanalysis.flight.pitch import COLUMNS, HEIGHT, MARGIN, SPEED, Flights
from hfanalysis.flight.stability import StabilityRuns, checks, product
from hfanalysis.rocket.aerodynamics import Fins, Nose, Shape

SHAPE = Shape(0.16, Nose("von_karman", 0.5), 2.5, Fins(4, 0.25, 0.05, 0.12, 0.2, 2.7))


def stable(mean: float, std: float) -> StabilityRuns:
    """A rocket whose margin at the rail's end differs so from gust to gust."""
    time = np.arange(400)
    paths = np.full((50, time.size, len(COLUMNS)), 0.0)
    paths[:, :, HEIGHT] = time
    paths[:, :, SPEED] = 100.0 + np.minimum(time, 400 - time)
    drawn = np.random.default_rng(9).standard_normal((50, 1))
    paths[:, :, MARGIN] = mean + std * (drawn - drawn.mean()) / drawn.std(ddof=1)
    found = margin(Flights(4.0, paths, np.full(50, 10)))
    assert found is not None
    weighed = SimpleNamespace(center=np.array([1.9, 1.7]))
    return cast(StabilityRuns, SimpleNamespace(outside=SHAPE, balance=weighed, margins=(found,), notes=()))


def test_the_margin_at_the_rails_end_is_as_sure_as_gusts_leave_it() -> None:
    found = product(stable(2.0, 0.15))
    assert found.margin_at_rail_departure.value == pytest.approx(2.0)
    assert found.margin_at_rail_departure.std == pytest.approx(0.15)
    place, loaded = found.center_of_pressure.value, found.center_of_gravity_loaded.value
    assert found.static_margin_on_pad.value == pytest.approx((place - loaded) / 0.16)
    assert (loaded, found.center_of_gravity_empty.value) == (1.9, 1.7)


@pytest.mark.parametrize(
    ("mean", "std", "least", "largest"),
    [
        (2.5, 0.2, "passed", "passed"),
        (1.7, 0.2, "failed", "passed"),  # 1.3 calibers at two deviations, of 1.5
        (1.7, 0.05, "passed", "passed"),
        (5.7, 0.2, "passed", "failed"),  # 6.1 of 6
        (5.7, 0.1, "passed", "passed"),
    ],
)
def test_limits_hold_with_two_deviations(mean: float, std: float, least: str, largest: str) -> None:
    """1.5 to 6 calibers, as competitions ask for."""
    found = checks(stable(mean, std))
    assert (found["least_static_margin"].result, found["largest_static_margin"].result) == (least, largest)
    kept = least == largest == "passed"
    assert product(stable(mean, std)).winds[0].result == ("passed" if kept else "failed")
