"""Do thrust and chamber pressure share a clock?"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.inference.logged import seen

from hfanalysis.effects.chamber_tap_lag import lagged
from hfanalysis.inference.unknowns.late_channel import CLEAR, SHORTEST_DELAY, LateChannel
from hfanalysis.record.signals import Signal

STEP = 1e-3


def start(delay: float = 0.0, lag: float = 0.0, step: float = STEP, noise: float = 0.01) -> dict[str, Signal]:
    """Pressure and thrust of an engine that starts within 60 ms; thrust is ``delay`` late, the pressure lags."""
    rng, time = np.random.default_rng(2), np.arange(-2.0, 3.0, step)

    def risen(at: np.ndarray) -> np.ndarray:
        # the smallest thrust is none: a nozzle of constant coefficient, less the ambient pressure
        return np.where(at > 0.0, 1.0 - np.exp(-np.maximum(at, 0.0) / 0.06) - 0.05 * np.maximum(at, 0.0), 0.0)

    pressure = lagged(time, 1e5 + 20e5 * risen(time), np.full(time.size, lag)) + 20e5 * noise * rng.standard_normal(
        time.size
    )
    thrust = 3000.0 * (risen(time - delay) + noise * rng.standard_normal(time.size))
    return {"p_chamber": _signal("p_chamber", time, pressure), "thrust": _signal("thrust", time, thrust)}


def _signal(name: str, time: np.ndarray, values: np.ndarray) -> Signal:
    return Signal(name, time, values, 0.0, float(time[1] - time[0]))


@given(st.floats(0.03, 0.15))
def test_a_late_thrust_is_seen_to_a_few_milliseconds(delay: float) -> None:
    found = seen(LateChannel, start(delay))
    assert found is not None
    assert found.seconds == pytest.approx(delay, abs=2e-3)
    assert found.log_evidence > 0.5 * 25.0 * np.log(CLEAR)


@pytest.mark.parametrize("lag", [0.0, 0.015, 0.05])
def test_one_clock_is_one_clock_however_slow_the_tap(lag: float) -> None:
    assert seen(LateChannel, start(lag=lag)) is None


def test_an_early_thrust_is_not_called_late() -> None:
    assert seen(LateChannel, start(delay=-0.04)) is None


def test_a_slow_log_does_not_tell() -> None:
    assert seen(LateChannel, start(delay=0.1, step=0.05)) is None


def test_it_takes_both_channels() -> None:
    signals = start(0.05)
    assert seen(LateChannel, {"thrust": signals["thrust"]}) is None
    assert seen(LateChannel, {}) is None


def test_noise_alone_is_no_delay() -> None:
    assert seen(LateChannel, start(noise=30.0)) is None
    assert SHORTEST_DELAY > 4.0 * STEP
