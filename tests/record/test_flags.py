"""Bad samples are flagged; what a live engine does is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from hfanalysis.record import flag_kernels
from hfanalysis.record.flags import flag_impossible, flag_readings
from hfanalysis.record.log import Flag

Floats = NDArray[np.float64]
N = 6000


def firing(rng: np.random.Generator, noise: float = 0.1) -> Floats:
    """A chamber pressure [bar] at 1 kHz: ambient, up within 2 ms, a decaying burn, a fast end."""
    t = np.arange(N) / 1000.0
    burning = np.clip((t - 1.0) / 0.002, 0.0, 1.0) * (t < 4.0)
    return 1.0 + burning * (14.0 - 1.5 * (t - 1.0)) + rng.normal(scale=noise, size=N)


def flagged(values: Floats, flag: Flag, dimension: str = "pressure") -> list[int]:
    return np.flatnonzero(flag_readings(values, dimension) & flag).tolist()


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def test_a_clean_firing_carries_no_flag(rng: np.random.Generator) -> None:
    assert not flag_readings(firing(rng), "pressure").any()


@pytest.mark.parametrize("length", [1, 2, 3])
@pytest.mark.parametrize("height", [6.0, -9.0])
def test_one_to_three_outlying_samples_are_a_spike(rng: np.random.Generator, length: int, height: float) -> None:
    values = firing(rng)
    values[2500 : 2500 + length] += height
    assert flagged(values, Flag.SPIKE) == list(range(2500, 2500 + length))


def test_a_sharp_pulse_of_many_samples_is_no_spike(rng: np.random.Generator) -> None:
    values = firing(rng)
    values[2500:2512] += 6.0
    assert flagged(values, Flag.SPIKE) == []


@pytest.mark.parametrize("frequency", [20.0, 120.0, 333.0, 450.0])
def test_oscillation_is_no_spike(rng: np.random.Generator, frequency: float) -> None:
    t = np.arange(N) / 1000.0
    values = firing(rng) + 3.0 * np.sin(2 * np.pi * frequency * t) * ((t > 1.0) & (t < 4.0))
    assert flagged(values, Flag.SPIKE) == []


def test_regular_pulses_are_a_signal_not_spikes(rng: np.random.Generator) -> None:
    values = firing(rng)
    values[1500:3500:7] += 6.0
    assert flagged(values, Flag.SPIKE) == []


def test_a_step_with_overshoot_is_no_spike() -> None:
    values = np.concatenate([np.full(50, 1.0), [16.0, 15.0], np.full(50, 14.0)])
    values += np.random.default_rng(1).normal(scale=0.02, size=len(values))
    assert flagged(values, Flag.SPIKE) == []


def test_a_stalled_logger_is_stuck(rng: np.random.Generator) -> None:
    values = firing(rng)
    values[2000:2100] = values[2000]
    assert flagged(values, Flag.STUCK) == list(range(2000, 2100))


def test_a_quantised_quiet_channel_is_not_stuck(rng: np.random.Generator) -> None:
    slow = 20.0 + np.cumsum(rng.normal(scale=0.004, size=N))
    assert not flag_readings(np.round(slow, 1), "temperature").any()


def test_an_idle_channel_before_and_after_a_firing_is_not_stuck(rng: np.random.Generator) -> None:
    values = np.where(np.arange(N) // 1000 % 5 == 0, 0.0, firing(rng))
    assert flagged(values, Flag.STUCK) == []


def test_a_slow_sensor_in_a_fast_log_is_not_stuck(rng: np.random.Generator) -> None:
    values = np.repeat(rng.normal(loc=8.0, size=N // 50), 50)
    assert not flag_readings(values, "mass").any()


def test_a_clipped_plateau_is_saturated(rng: np.random.Generator) -> None:
    values = np.minimum(firing(rng, noise=0.02), 12.0)
    found = flagged(values, Flag.SATURATED)
    assert found == np.flatnonzero(values == 12.0).tolist()
    assert len(found) > 1000
    assert flagged(values, Flag.STUCK) == []


@pytest.mark.parametrize("level", [0.0, 999.0, -10.0])
def test_an_exact_level_apart_from_all_else_is_no_reading(rng: np.random.Generator, level: float) -> None:
    values = 60.0 + rng.normal(scale=0.1, size=N)
    lost = [100, 101, 102, 2000, 2001, 4000]
    values[lost] = level
    assert flagged(values, Flag.DROPOUT) == lost


def test_an_open_thermocouple_drops_out_throughout() -> None:
    assert (flag_readings(np.full(100, 999.0), "temperature") == Flag.DROPOUT).all()


def test_zeros_of_a_quantised_cell_at_rest_are_readings(rng: np.random.Generator) -> None:
    values = np.round(1000.0 * (firing(rng) > 5.0) + rng.normal(scale=0.7, size=N))
    assert flagged(values, Flag.DROPOUT, "force") == []


def test_a_valve_may_stand_still() -> None:
    assert not flag_readings(np.repeat([0.0, 1.0, 0.0], 1000), "dimensionless").any()


def test_noise_alone_is_never_flagged() -> None:
    values = np.random.default_rng(3).normal(size=300_000)
    assert not flag_readings(values, "pressure").any()


@pytest.mark.parametrize("count", [2, 5, 255, 256, 257, 1000])
def test_noise_is_measured_block_by_block(rng: np.random.Generator, count: int) -> None:
    noise = flag_kernels.local_noise(rng.normal(scale=np.where(np.arange(count) < 256, 1.0, 5.0)))
    assert len(noise) == -(-count // 256)
    if count == 1000:
        np.testing.assert_allclose(noise, [1.0, 5.0, 5.0, 5.0], rtol=0.4)


@pytest.mark.parametrize("dimension", ["force", "mass", "pressure", "temperature"])
def test_what_no_sensor_can_read_is_no_reading(dimension: str) -> None:
    values = np.array([300.0, 1e200, 301.0, -1e200, 302.0])
    flags = np.zeros(5, dtype=np.uint8)
    flag_impossible(values, dimension, flags)
    assert (flags != 0).tolist() == [False, True, False, True, False]
