"""The load cell's errors: one model, for a thrust at a moment and for an impulse."""

from __future__ import annotations

import datetime

import numpy as np
import pytest

from hfanalysis.inference.budget import total
from hfanalysis.performance.load_cell import ANY_COURSE, GAIN, UNSEEN_DRIFT, CellError, cell_error
from hfanalysis.performance.thrust import Thrust
from hfanalysis.record.log import Channel
from hfanalysis.record.signals import Signal

TIME = np.arange(-2.0, 12.0, 0.01)


def cell(error: float = 0.0, since: float = np.nan, accuracy: float = 1.0, **about: float) -> CellError:
    """Of a cell that shows 2 kN for 10 s, and 5 N after it."""
    values = np.where((TIME > 0.0) & (TIME < 10.0), 2000.0, 0.0) + 5.0 * (TIME > 10.0)
    channel = Channel("thrust", "N", TIME, values, np.zeros(TIME.size, np.uint8), accuracy, True, "", **about)  # type: ignore[arg-type]
    signal = Signal.of(channel)
    return cell_error(channel, Thrust(signal, error, since), signal.between(0.0, 10.0).value)


def test_a_step_at_any_moment_scatters_by_the_course() -> None:
    """A drift of 60 N, all at once at a moment drawn from the burn, against the line that is taken off."""
    at = np.random.default_rng(1).uniform(size=20_000)
    off = 60.0 * (1.0 - at) - 30.0  # in the mean over the burn
    assert cell(error=60.0, zero_std=0.0).course == pytest.approx(np.std(off), rel=0.02)


def test_impulse_and_thrust_have_the_same_errors() -> None:
    found = CellError(0.01, 3.0, 20.0, 8.0)
    assert total(found.of_impulse(16e3, 10.0)) == pytest.approx(np.linalg.norm([160.0, 30.0, 200.0, 40.0]))
    assert total(found.at(2000.0, 1.0)) == pytest.approx(np.linalg.norm([20.0, 3.0, 20.0, 8.0]))
    assert total(found.at(2000.0, 0.0)) == pytest.approx(np.linalg.norm([20.0, 3.0, 20.0]))


def test_a_drift_that_nothing_shows_is_a_share_of_the_peak() -> None:
    unseen = cell(zero_std=0.5)
    assert (unseen.course, unseen.left) == (0.0, pytest.approx(UNSEEN_DRIFT * 2000.0))
    seen = cell(error=60.0, since=10.1, zero_std=0.5)
    assert (seen.zero, seen.left) == (0.5, pytest.approx(5.0))


def test_what_health_doubts_of_the_zero_counts_once_as_drift() -> None:
    """The zero's deviation holds the doubt already."""
    found = cell(error=60.0, zero_std=float(np.hypot(0.5, 20.0)), accuracy=float(np.hypot(1.0, 20.0)), doubt=20.0)
    assert found.zero == pytest.approx(0.5)
    assert found.course == pytest.approx(max(20.0, ANY_COURSE * 60.0))
    assert found.gain == GAIN


def test_a_cell_that_nobody_calibrated_in_place_is_known_to_one_per_cent() -> None:
    """As forces of no stated accuracy are taken to be; one that was, to a quarter of that (ASTM E74, class A)."""
    assert cell(zero_std=0.5).gain == pytest.approx(0.01)
    assert cell(zero_std=0.5, accuracy=200.0).gain > 0.02
    day = datetime.date(2026, 5, 1)
    channel = Channel("thrust", "N", TIME, np.full(TIME.size, 2000.0), np.zeros(TIME.size, np.uint8), 1.0, True, "")
    thrust = Thrust(Signal.of(channel), 0.0, np.nan)
    assert cell_error(channel, thrust, channel.values, day, day).gain == pytest.approx(0.0025)
