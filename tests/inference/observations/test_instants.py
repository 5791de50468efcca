"""What a channel may differ by where the opening or the end of the liquid was seen a little early or late."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.segment.stand import signal

from hfanalysis.inference.observations.blocks import Blocks, centered, stamp_error
from hfanalysis.inference.observations.covariance import LEAST_SHIFT, VALVE_TIME, of_the_model
from hfanalysis.inference.observations.frame import EVENT_STD, Frame

FALL, KNEE, END = 3e5, 5.0, 8.0
"""Pressure that the tank loses in a second [Pa/s], when its liquid is gone, and when the test ends [s]."""

FILLING, FULL = 0.05, 20e5
"""Time constant [s] with which a chamber fills, and its pressure then [Pa]."""

OPENING, LIQUID_END = 0, 1
"""Columns of what a channel may differ by."""


def _blocks(name: str, time: NDArray[np.float64], value: NDArray[np.float64]) -> Blocks:
    """Blocks of one point each, all of them good."""
    ones = np.ones(time.size, dtype=np.int64)
    return Blocks(signal(name, time, value), time, value, np.arange(time.size), ones, value, ones > 0, 0.0 * time)


def _frame(time: NDArray[np.float64], liquid_end: float, opening: float) -> Frame:
    """The frame of a flow whose opening and end of the liquid were seen to so many seconds."""
    still, ends = np.zeros(time.size, dtype=bool), {"chamber": END, "tank": END}
    changes = {"t_v": (KNEE, liquid_end)}
    return Frame(time, still, np.zeros(time.size), 0, changes, 0.03, 0.0, ends, opening=opening)


@pytest.mark.parametrize(("seen", "shift"), [(4e-4, LEAST_SHIFT), (3e-3, 3e-3), (2e-2, 2e-2)])
def test_a_channel_is_as_unsure_as_the_knee_was_seen_and_no_more(seen: float, shift: float) -> None:
    """By how much more than that a model's liquid may end elsewhere is a matter of the instant, which has EVENT_STD."""
    time = np.arange(0.05, END, 0.1)
    blocks = _blocks("p_tank", time, 50e5 - FALL * time)
    moved = np.abs(of_the_model(blocks, _frame(time, seen, 0.0))[:, LIQUID_END])
    before = time < KNEE
    assert moved.max() == pytest.approx(FALL * shift, rel=0.02)
    assert moved[before][0] < 0.1 * moved.max()  # a run is stretched from the opening on
    assert moved[~before] == pytest.approx(FALL * shift)
    assert LEAST_SHIFT < EVENT_STD


@pytest.mark.parametrize(("seen", "shift"), [(4e-4, VALVE_TIME), (3e-2, 3e-2)])
def test_a_chamber_that_fills_is_as_unsure_as_the_opening(seen: float, shift: float) -> None:
    """However well it was seen, a valve takes its time. It is what a shift of all times would make of it: early almost
    all of that, and nothing from the knee on."""
    time = np.arange(0.04, END, 0.02)
    moved = of_the_model(_blocks("p_chamber", time, FULL * -np.expm1(-time / FILLING)), _frame(time, 4e-4, seen))
    by_shift = shift * FULL / FILLING * np.exp(-time / FILLING)
    early = time < 0.3
    assert moved[early, OPENING] == pytest.approx(by_shift[early], rel=0.1, abs=0.01 * by_shift[0])
    assert (moved[time >= KNEE, OPENING] == 0.0).all()


def test_a_block_with_one_sample_is_carried_to_its_middle() -> None:
    """A chamber that fills with 40 bar/s read at 50 Hz by a clock that jitters: means are those of the middles, within
    what is stated of them."""
    rng, speed = np.random.default_rng(4), 4e6
    time = np.sort(0.02 * np.arange(100.0) + 0.005 + rng.uniform(-4e-3, 4e-3, 100))
    centers, late = 0.02 * np.arange(100.0) + 0.01, 2e-3
    read = signal("p_chamber", time, speed * (time + late * rng.standard_normal(100)))
    at = np.searchsorted(time, np.append(centers - 0.01, centers[-1] + 0.01))
    samples = np.diff(at)
    means = np.array([read.value[a:b].mean() if b > a else 0.0 for a, b in pairwise(at)])
    moved, unsure = centered(read, centers, means, samples, at)
    there = samples > 0
    plain, carried = ((values - speed * centers)[there] for values in (means, moved))
    assert np.sqrt(np.mean(plain**2)) > 1.5 * np.sqrt(np.mean(carried**2))
    assert 0.4 < np.mean((carried / unsure[there]) ** 2) < 2.5


def test_a_clock_without_jitter_is_sure_of_its_stamps() -> None:
    assert stamp_error(signal("p_tank", np.arange(0.0, 1.0, 1e-3), np.arange(1000.0))) < 1e-9


def test_steps_of_a_converter_are_noise_where_a_reading_stands_on_one_count() -> None:
    time = np.arange(0.0, 5.0, 0.02)
    coarse, fine = (signal("p_tank", time, v) for v in (np.round(np.sin(time) / 0.3) * 0.3, np.sin(time)))
    assert coarse.resolution == pytest.approx(0.3)
    assert fine.resolution == 0.0
