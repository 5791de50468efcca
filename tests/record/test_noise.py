"""A sensor's noise: white and wandering, measured at rest, and what it does to means, slopes and differences."""

from __future__ import annotations

import numpy as np
import pytest
from simulated.stand import noise
from tests.segment.stand import signal

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise, pool
from hfanalysis.record.signals import sample_noise

RATE, WHITE, FLICKER = 200.0, 1500.0, 4.0e5
TRIALS = 600
TIME = np.arange(0.0, 6.0, 1.0 / RATE)
SENSOR = Noise(WHITE, FLICKER, 1.0 / RATE)


@pytest.fixture(scope="module")
def trials() -> Array:
    generator = np.random.default_rng(4)
    return np.array([noise(generator, TIME.size, RATE, WHITE, FLICKER) for _ in range(TRIALS)])


def weights_of(*intervals: tuple[float, float, float]) -> Array:
    """Weights of means over [start, end), each times a factor."""
    out = np.zeros(TIME.size)
    for start, end, factor in intervals:
        part = (start - 1e-9 <= TIME) & (end - 1e-9 > TIME)
        out[part] += factor / part.sum()
    return out


SLOPE = (TIME - TIME.mean()) / np.sum((TIME - TIME.mean()) ** 2)
CURVATURE = np.linalg.pinv(np.vander(TIME - TIME.mean(), 3))[0]


def measured(rate: float, white: float, flicker: float) -> list[Noise]:
    generator = np.random.default_rng(8)
    time = np.arange(0.0, 20.0, 1.0 / rate)
    found = []
    for _ in range(25):
        quiet = signal("p_tank", time, 50e5 + noise(generator, time.size, rate, white, flicker))
        found.append(Noise.of(quiet, quiet))
    return found


@pytest.mark.parametrize("rate", [200.0, 1000.0])
@pytest.mark.parametrize("flicker", [0.0, 4.0e5, 4.0e6])
def test_white_noise_and_wander_are_told_apart_at_rest(rate: float, flicker: float) -> None:
    found = measured(rate, WHITE, flicker)
    as_fast_as_a_sample = 1.39 * flicker  # integral of A/f times (16/6) sin^4(pi f/f_s): what second differences see
    assert np.mean([n.white for n in found]) == pytest.approx(np.sqrt(WHITE**2 + as_fast_as_a_sample), rel=0.03)
    assert np.mean([n.flicker for n in found]) == pytest.approx(flicker, rel=0.2, abs=2e-3 * WHITE**2)


def test_a_short_quiet_time_rather_finds_too_much_wander_than_too_little() -> None:
    generator = np.random.default_rng(2)
    time = np.arange(0.0, 0.5, 1.0 / RATE)
    found = []
    for _ in range(200):
        quiet = signal("p_tank", time, noise(generator, time.size, RATE, WHITE, FLICKER))
        found.append(Noise.of(quiet, quiet).flicker)
    assert FLICKER < np.mean(found) < 2.5 * FLICKER


def test_too_few_quiet_samples_leave_the_signals_own_noise() -> None:
    time = np.arange(0.0, 2.0, 0.01)
    whole = signal("p_tank", time, noise(np.random.default_rng(1), time.size, 100.0, WHITE, 0.0))
    found = Noise.of(whole, whole.between(0.0, 0.1))
    assert found.white == whole.noise
    assert found.flicker == 0.0


@pytest.mark.parametrize("first", [(0.0, 1.0), (0.5, 0.6), (0.0, 3.0)])
@pytest.mark.parametrize("second", [(3.0, 5.0), (4.0, 6.0)])
def test_means_over_two_intervals_differ_by_what_is_said(
    trials: Array, first: tuple[float, float], second: tuple[float, float]
) -> None:
    differences = trials @ weights_of((*first, 1.0), (*second, -1.0))
    assert SENSOR.difference_std(first, second) == pytest.approx(differences.std(), rel=0.1)


@pytest.mark.parametrize(
    "weights",
    [
        pytest.param(weights_of((0.0, 1.0, 1.0), (3.0, 5.0, -1.0)), id="a difference of means"),
        pytest.param(SLOPE, id="a slope"),
        pytest.param(CURVATURE, id="a curvature"),
    ],
)
def test_a_weighted_sum_scatters_by_what_is_said(trials: Array, weights: Array) -> None:
    assert SENSOR.std_of(weights, TIME) == pytest.approx((trials @ weights).std(), rel=0.1)


def test_averaging_beats_white_noise_but_hardly_the_wander() -> None:
    white, wander = Noise(WHITE, 0.0, 1.0 / RATE), Noise(0.0, FLICKER, 1.0 / RATE)
    for noise_, gain in ((white, 10.0), (wander, 1.0)):
        short = noise_.difference_std((0.0, 0.02), (2.0, 2.02))
        long = noise_.difference_std((0.0, 2.0), (200.0, 202.0))
        assert short / long == pytest.approx(gain, rel=0.35)


def test_block_means_carry_less_white_noise_and_the_same_wander(trials: Array) -> None:
    blocks = trials.reshape(TRIALS, -1, 20).mean(axis=2)
    time = TIME.reshape(-1, 20).mean(axis=1)
    weights = (time - time.mean()) / np.sum((time - time.mean()) ** 2)
    assert SENSOR.std_of(weights, time) == pytest.approx((blocks @ weights).std(), rel=0.1)


def test_readings_apart_have_the_wander_in_common(trials: Array) -> None:
    """Two changes, one inside the other in time: their covariance comes from the wander alone."""
    early = weights_of((0.0, 0.5, -1.0), (2.0, 2.5, 1.0))
    late = weights_of((1.0, 1.5, -1.0), (3.0, 3.5, 1.0))
    a, b = trials @ early, trials @ late
    found = float(np.cov(a, b)[0, 1])
    expected = SENSOR.common(early, TIME, late, TIME)
    assert expected != 0.0
    assert found == pytest.approx(expected, abs=3.0 * a.std() * b.std() / np.sqrt(TRIALS))


def test_like_sensors_lend_each_other_half_of_their_wander() -> None:
    shared = pool({"p_tank": Noise(1.0, 2.0, 0.01), "p_run": Noise(3.0, 6.0, 0.01)})
    assert (shared["p_tank"].flicker, shared["p_run"].flicker) == (3.0, 5.0)
    assert (shared["p_tank"].white, shared["p_run"].white) == (1.0, 3.0)
    assert pool({}) == {}


def test_the_noise_of_a_sample_does_not_see_slow_changes_or_single_spikes() -> None:
    time = np.arange(0.0, 10.0, 0.001)
    value = WHITE * np.random.default_rng(3).standard_normal(time.size) + 1e5 * np.sin(time)
    value[::500] += 50.0 * WHITE
    assert sample_noise(value) == pytest.approx(WHITE, rel=0.03)


def test_a_slow_loggers_short_rest_shows_the_wander_as_well() -> None:
    """Sixty samples: too few for the usual blocks, and a wander of nothing made every interval too narrow."""
    found = []
    for seed in range(40):
        rest = signal("p_tank", 0.05 * np.arange(60), noise(np.random.default_rng(seed), 60, 20.0, 0.5, 1.0))
        found.append(Noise.of(rest, rest).flicker)
    assert 0.5 < np.mean(found) < 2.5
