"""What tank and purge line show without a model: nothing where nothing is missing, and how much where something is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.inference import logged
from tests.segment.stand import channel

from hfanalysis.diagnose.model_free import (
    BAR,
    LEAST_FALL,
    LEAST_FLOW,
    Sign,
    fall_at_opening,
    open_check_valve,
    signs_of,
)
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog

Array = NDArray[np.float64]

CRACKING, SUPPLY = 4.27 * BAR, 38.0 * BAR
PURGED = {"t_purge": Quantity(5.95, "s", 0.05), "t_end": Quantity(10.0, "s", 0.05)}
"""As the tank's pressure falls below SUPPLY - CRACKING; the log goes on until after."""


def tank(plus: Array) -> TestLog:
    return logged.log(plus={"p_tank": plus})


def layer(size: float, lasts: float = 0.3) -> Array:
    """A layer that holds ``size`` [Pa] above the bulk's pressure until the opening, and is gone soon."""
    time, _ = logged.clean()
    return size * np.exp(-np.maximum(time, 0.0) / lasts)


def late(depth: float, lowest: float = 0.3) -> Array:
    """A dip of ``depth`` [Pa] that is deepest some tenths of a second after the opening."""
    time, _ = logged.clean()
    x = np.maximum(time, 0.0) / lowest
    return -depth * x * np.exp(1.0 - x)


def behind_valve(line: Array) -> TestLog:
    """With a purge line."""
    log, (time, _) = logged.log(), logged.clean()
    made = channel("p_purge", time + logged.OPENING, line + 2e3 * np.random.default_rng(1).standard_normal(time.size))
    return TestLog({**log.channels, "p_purge": made})


def test_a_saturated_tank_shows_nothing() -> None:
    assert signs_of(logged.log(), logged.segments()) == []


@given(some.floats(3.0, 20.0), some.floats(0.1, 0.8))
def test_a_layer_is_seen_with_its_size(size: float, lasts: float) -> None:
    found = fall_at_opening(tank(layer(size * BAR, lasts)), logged.segments())
    assert found is not None
    assert found.names == ("tank_stratification", "tank_nonequilibrium")
    assert found.size.value == pytest.approx(-size * BAR, abs=1.0 * BAR)


def test_a_layer_of_a_bar_is_none() -> None:
    assert fall_at_opening(tank(layer(0.5 * LEAST_FALL)), logged.segments()) is None


@given(some.floats(2.5, 8.0), some.floats(0.0, 10.0))
def test_what_falls_too_low_is_vapor_made_late(depth: float, size: float) -> None:
    found = fall_at_opening(tank(layer(size * BAR, 0.1) + late(depth * BAR, 0.5)), logged.segments())
    assert found is not None
    assert found.names == ("tank_nonequilibrium",)
    assert 0.2 < found.end < 1.2
    assert "it comes back, so vapor is made late" in found.text
    assert ("tank_stratification" in found.text) == ("p_tank falls by" in found.text)


def test_a_supercharged_tank_and_one_whose_liquid_does_not_end_are_not_judged() -> None:
    log = tank(layer(8.0 * BAR))
    assert signs_of(log, logged.segments().but(supercharged=True)) == []
    unseen = logged.segments(t_v=Quantity.absent("the log ends before"))
    assert fall_at_opening(log, unseen) is None
    assert fall_at_opening(log, logged.segments(t_purge=Quantity(0.2, "s", 0.05))) is None


def purged(lag: float) -> Sign | None:
    """The sign of a line that stays ``lag`` [Pa] behind the tank's fall at the end, more than its valve takes."""
    _, read = logged.clean()
    pressure = read["p_tank"]
    spent = np.clip((SUPPLY - CRACKING - pressure) / np.ptp(pressure), 0.0, 1.0)
    line = np.minimum(SUPPLY, pressure + CRACKING + lag * spent / spent.max())
    return open_check_valve(behind_valve(line), logged.segments(**PURGED))


def test_a_line_that_follows_the_tank_lets_nothing_in_and_one_that_is_fed_does() -> None:
    assert purged(0.0) is None
    assert purged(0.5 * LEAST_FLOW) is None
    found = purged(2.0 * LEAST_FLOW)
    assert found is not None
    assert (found.names, found.start) == (("n2_purge",), 5.95)
    assert found.size.value == pytest.approx(2.0 * LEAST_FLOW, rel=0.1)


def test_a_line_that_is_shut_off_holds_its_pressure_and_says_nothing() -> None:
    time, _ = logged.clean()
    assert open_check_valve(behind_valve(np.full(time.size, SUPPLY)), logged.segments(**PURGED)) is None
