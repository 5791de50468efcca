"""Does the valve open at once?"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.inference.logged import seen

from hfanalysis.inference.unknowns.slow_valve import SlowValve
from hfanalysis.record.signals import Signal

STEP, LEVEL = 1e-3, 35e5


def line(course: np.ndarray, step: float = STEP, noise: float = 3e3) -> dict[str, Signal]:
    """A run line's pressure that rises by a course from 0 to 1."""
    rng, time = np.random.default_rng(4), times(step)
    values = 1e5 + LEVEL * (course - 0.05 * np.maximum(time, 0.0)) + noise * rng.standard_normal(time.size)
    return {"p_run": Signal("p_run", time, values, noise, step)}


def times(step: float = STEP) -> np.ndarray:
    return np.arange(-2.0, 3.0, step)


def gradual(seconds: float, step: float = STEP) -> np.ndarray:
    """The pressure behind a valve whose area grows in proportion to time and whose loss is 0.4 of the line's level."""
    share = np.clip(times(step) / seconds, 1e-9, 1.0)
    return 1.4 / (1.0 + 0.4 / share**2)


@given(st.floats(0.03, 0.4))
def test_a_slow_valve_is_seen_with_its_time(seconds: float) -> None:
    found = seen(SlowValve, line(gradual(seconds)))
    assert found is not None
    assert found.seconds == pytest.approx(seconds, rel=0.3)  # by the rise alone, whatever the valve
    assert found.log_evidence > 20.0


@pytest.mark.parametrize("leap", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("time_constant", [5e-3, 0.05])
def test_a_line_that_leaps_and_creeps_up_is_not_a_slow_valve(leap: float, time_constant: float) -> None:
    """As behind a valve that opens at once, with the chamber's pressure, or with a line that fills."""
    time = times()
    course = np.where(time > 0.0, 1.0 - (1.0 - leap) * np.exp(-np.maximum(time, 0.0) / time_constant), 0.0)
    assert seen(SlowValve, line(course)) is None


def test_a_leap_in_a_hole_of_the_log_is_not_a_slow_valve() -> None:
    whole = line(np.where(times() > 0.0, 1.0, 0.0))["p_run"]
    kept = ~((times() > -0.015) & (times() < 0.015))
    assert seen(SlowValve, {"p_run": Signal("p_run", times()[kept], whole.value[kept], 3e3, STEP)}) is None


def test_a_wild_sample_is_no_opening() -> None:
    signals = line(np.where(times() > 0.0, 1.0, 0.0))
    values = signals["p_run"].value.copy()
    values[np.searchsorted(times(), -0.01)] += 0.1 * LEVEL
    assert seen(SlowValve, {"p_run": Signal("p_run", times(), values, 3e3, STEP)}) is None


def test_a_slow_or_noisy_log_does_not_tell() -> None:
    assert seen(SlowValve, line(gradual(0.2, 0.01), step=0.01)) is None
    assert seen(SlowValve, line(gradual(0.2), noise=0.05 * LEVEL)) is None
    assert seen(SlowValve, {}) is None
