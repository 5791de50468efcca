"""A chart hides nothing: extremes stay, gaps stay, slow logs stay as they are."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.charts.envelope import envelope


@given(st.integers(0, 99_999), st.floats(10.0, 1e6))
def test_a_single_spike_survives(where: int, height: float) -> None:
    time = np.linspace(0.0, 10.0, 100_000)
    values = np.zeros(time.size)
    values[where] = height
    assert np.nanmax(envelope(time, values, 0.0, 10.0).high) == height


def test_a_chart_has_at_most_two_thousand_points_a_channel() -> None:
    data = envelope(np.linspace(0.0, 10.0, 10**6), np.ones(10**6), 0.0, 10.0)
    assert 3 * data.time.size <= 2000


def test_the_mean_lies_between_the_extremes() -> None:
    rng = np.random.default_rng(0)
    data = envelope(np.linspace(0.0, 10.0, 30_000), rng.normal(size=30_000), 0.0, 10.0)
    assert ((data.low <= data.mean) & (data.mean <= data.high)).all()


def test_a_gap_in_the_samples_is_a_gap_in_the_line() -> None:
    time = np.linspace(0.0, 10.0, 30_000)
    kept = (time < 4.0) | (time > 6.0)
    data = envelope(time[kept], time[kept], 0.0, 10.0)
    assert np.isnan(data.mean[(data.time > 4.1) & (data.time < 5.9)]).all()
    slow = np.array([0.0, 0.1, 0.2, 5.0, 5.1])
    assert np.isnan(envelope(slow, slow, 0.0, 10.0).mean).sum() == 1


def test_a_slow_log_keeps_its_own_points() -> None:
    time = np.linspace(0.0, 10.0, 300)
    assert np.array_equal(envelope(time, time**2, 0.0, 10.0).mean, time**2)
