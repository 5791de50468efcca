"""Clocks that do not run are put right where their stamps show how, and it is said; a lone wild stamp is left."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.record.clock_repair import repaired

RNG = np.random.default_rng(11)


def times(count: int, rate: float, jitter: float) -> Array:
    """Instants [s] of a logger, as whole microseconds."""
    return np.round(np.cumsum(RNG.normal(1.0, jitter, count).clip(0.2)) / rate, 6)


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize("rate", [8.6, 50.0, 1000.0])
@pytest.mark.parametrize(
    ("unit", "turn", "signed"),
    [(1e3, 2.0**16, False), (1e3, 2.0**16, True), (1e6, 2.0**32, False), (1e3, 2.0**32, True), (1.0, 60.0, False),
     (1.0, 3600.0, False), (1e3, 2.0**32 / 1e3, False), (1e3, 60e3, False)],
)  # fmt: skip
def test_a_counter_that_wraps_is_counted_on(unit: float, turn: float, signed: bool, rate: float, jitter: float) -> None:
    time = times(int(30 * rate), rate, jitter)
    shown = (time - time[-1] / 2 + turn / unit / 2) * unit if signed else (time - time[-1] / 2) * unit + turn
    low = -turn / 2 if signed else 0.0
    counter = (np.floor(shown) if unit > 1.0 else shown) + (turn / 2 if signed else 0.0)
    wrapped = np.mod(counter, turn) + low
    assert (np.diff(wrapped) < 0.0).sum() == 1
    run = repaired(wrapped)
    np.testing.assert_allclose(np.diff(run.time) / unit, np.diff(time), atol=1.01 / unit if unit > 1 else 1e-9)
    assert "begins anew" in run.notes[0]


def test_rows_that_run_backwards_are_reversed() -> None:
    time = times(400, 50.0, 0.1)
    run = repaired(time[::-1])
    np.testing.assert_array_equal(run.time, time)
    np.testing.assert_array_equal(run.order, np.arange(400)[::-1])


@pytest.mark.parametrize("jitter", [0.0, 0.1])
@pytest.mark.parametrize("reach", [2, 8])
def test_rows_out_of_order_are_sorted(reach: int, jitter: float) -> None:
    time = times(600, 50.0, jitter)
    order = np.argsort(np.arange(600) + RNG.uniform(0.0, reach, 600), kind="stable")
    run = repaired(time[order])
    np.testing.assert_array_equal(run.time, time)
    assert run.order is not None
    np.testing.assert_array_equal(order[run.order], np.arange(600))


@pytest.mark.parametrize("back", [0.3, 0.5, 7.0, 1e4])
def test_a_clock_that_is_set_back_or_restarts_goes_on(back: float) -> None:
    time = times(800, 50.0, 0.0)
    shown = time + 1e4
    shown[500:] -= back
    run = repaired(shown)
    np.testing.assert_allclose(np.diff(run.time), np.diff(time), atol=1e-6)
    assert "after row 500" in run.notes[0]
    assert "right only if the logger did not pause" in run.notes[0]


def test_an_excursion_that_comes_back_is_left_for_its_flags() -> None:
    time = times(400, 50.0, 0.0)
    time[200:210] -= 1.0
    run = repaired(time)
    np.testing.assert_array_equal(run.time, time)
    assert not run.notes


@pytest.mark.parametrize("wild", [1e3, -1e3, 0.08, -0.083])
@pytest.mark.parametrize("count", [1, 3])
def test_a_few_wild_stamps_are_left_for_their_flags(wild: float, count: int) -> None:
    time = times(400, 50.0, 0.0)
    time[200 : 200 + count] += wild
    run = repaired(time)
    np.testing.assert_array_equal(run.time, time)
    assert run.order is None


def test_stamps_that_run_are_as_they_were() -> None:
    time = np.repeat(times(200, 20.0, 0.3), 2)
    assert repaired(time).time is time
