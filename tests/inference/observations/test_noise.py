"""The slow noise of sensors and the oscillation of the burn: found from what they do to a record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter
from simulated.stand import noise
from tests.segment.stand import signal

from hfanalysis.inference.observations.oscillation import oscillation
from hfanalysis.inference.observations.wander import TIMES, Wander, wander_of

Array = NDArray[np.float64]

RATE, BLOCK = 250.0, 0.02
SEEDS = range(5)


def forgetful(seed: int, quiet: float, tau: float = 0.1) -> Wander:
    """The wander found of a sensor of unit size that forgets in ``tau`` [s], from a quiet time of so many seconds."""
    rng = np.random.default_rng(seed)
    kept = np.exp(-1.0 / (RATE * tau))
    own = lfilter([np.sqrt(1.0 - kept**2)], [1.0, -kept], rng.standard_normal(_times(quiet).size + 500))[500:]
    return found(own, rng, quiet)


def wandering(seed: int, quiet: float) -> Wander:
    """The wander found of a sensor with 1/f noise of unit size between 20 s and a block."""
    rng = np.random.default_rng(seed)
    return found(noise(rng, _times(quiet).size, RATE, 0.0, 1.0 / np.log(20.0 / BLOCK)), rng, quiet)


def found(slow: Array, rng: np.random.Generator, quiet: float) -> Wander:
    value = 30.0 + slow + 0.1 * rng.standard_normal(slow.size)
    return wander_of(signal("p_tank", _times(quiet), value), BLOCK)


def _times(quiet: float) -> Array:
    return np.arange(-quiet, 0.5, 1.0 / RATE)


def over_seconds(wander: Wander) -> float:
    """Standard deviation of the difference between two means over two seconds, side by side."""
    time = np.arange(0.0, 4.0, BLOCK)
    weights = np.where(time < 2.0, 1.0, -1.0) / 100.0
    return float(np.sqrt(weights @ wander.covariance(time) @ weights))


def slow(wander: Wander) -> float:
    """Variance of what takes seconds."""
    return float(wander.variances[TIMES > 1.0].sum())


def test_what_a_sensor_forgets_is_no_slow_noise() -> None:
    short, long = ([slow(of(seed, 25.0)) for seed in SEEDS] for of in (forgetful, wandering))
    assert max(short) < min(long)
    assert np.median(long) > 2.0 * np.median(short)


def test_the_longer_the_quiet_time_the_less_is_feared() -> None:
    """A short record cannot exclude slow noise; a longer one of the same sensor does."""
    sizes = [float(np.median([slow(forgetful(seed, quiet)) for seed in SEEDS])) for quiet in (4.0, 10.0, 25.0)]
    assert sizes[0] > sizes[1] > sizes[2]
    assert sizes[0] > 4.0 * sizes[2]


FORGETFUL = (forgetful, np.sqrt(2.0 * 2.0 * 0.1 / 2.0))
"""And its truth: of an AR(1) process a mean over T has the variance 2 tau / T."""

WANDERING = (wandering, np.sqrt(4.0 * np.log(2.0) / np.log(20.0 / BLOCK)))
"""And its truth: twice Allan's variance of 1/f noise."""


@pytest.mark.parametrize(("of", "truth"), [FORGETFUL, WANDERING])
def test_slow_noise_is_not_taken_for_too_small(of: Callable[[int, float], Wander], truth: float) -> None:
    found = float(np.median([over_seconds(of(seed, 12.0)) for seed in SEEDS]))
    assert truth < found < 2.0 * truth


@pytest.mark.parametrize("quiet", [4.0, 12.0, 50.0])
def test_the_size_of_slow_noise_is_as_unsure_as_is_said(quiet: float) -> None:
    """Over both kinds of sensors, the log of its amplitude over seconds."""
    off = [np.log(over_seconds(of(seed, quiet)) / truth) for of, truth in (FORGETFUL, WANDERING) for seed in range(12)]
    said = forgetful(0, quiet).unsure
    assert 0.5 * said < float(np.sqrt(np.mean(np.square(off)))) < 1.7 * said


def test_white_noise_is_no_wander() -> None:
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        only = found(np.zeros(_times(6.0).size), rng, 6.0)
        assert only.white == pytest.approx(0.1 / np.sqrt(RATE * BLOCK), rel=0.3)
        assert over_seconds(only) < 0.1 / np.sqrt(RATE * BLOCK)


def test_covariance_falls_with_the_time_between() -> None:
    covariance = wandering(0, 6.0).covariance(np.arange(0.0, 5.0, 0.1))
    assert (np.diff(covariance[0]) < 0.0).all()
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_wide_means_vary_as_the_means_of_what_is_in_them() -> None:
    """A rest of half a second beside blocks of hundredths: the same process, averaged."""
    wander = wandering(0, 6.0)
    inside = np.arange(-1.2, -0.2, 0.001) + 0.0005
    burning = np.array([0.01, 0.4, 3.0])
    fine = wander.covariance(np.concatenate([inside, burning]))
    halves = np.zeros((5, inside.size + 3))
    halves[0, :500], halves[1, 500:1000], halves[2:, -3:] = 1.0 / 500, 1.0 / 500, np.eye(3)
    wide = wander.covariance(np.array([-0.95, -0.45, *burning]), np.array([0.5, 0.5, 0.0, 0.0, 0.0]))
    assert wide == pytest.approx(halves @ fine @ halves.T, rel=2e-3)
    assert wide[0, 0] < 0.9 * wide[2, 2]


def test_a_sensor_that_stands_still_does_not_wander() -> None:
    still = wander_of(signal("p_tank", _times(6.0), np.full(_times(6.0).size, 101_325.0)), BLOCK)
    assert still.white == 0.0
    assert not still.variances.any()


def test_a_short_quiet_time_is_still_judged() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(-0.9, 0.5, 1.0 / RATE)
    short = wander_of(signal("p_tank", time, 0.3 * rng.standard_normal(time.size)), BLOCK)
    assert short.white == pytest.approx(0.3 / np.sqrt(RATE * BLOCK), rel=0.3)


BLOCKS, SENSOR = 400, 0.3
"""Blocks of a burn, and each sensor's own noise."""

VARIANCE = 0.98**2
"""Of the first channel's oscillation at the start; the second's is twice as large."""


def shaken(seed: int, sign: float = 1.0) -> tuple[dict[str, Array], Array]:
    """Two channels with a common oscillation about a smooth course, and how strong it is."""
    rng = np.random.default_rng(seed)
    time = BLOCK * np.arange(BLOCKS)
    level = np.exp(-time / 8.0)
    common = np.sqrt(2.0 * VARIANCE) * np.cos(2 * np.pi * 11.3 * time + np.cumsum(0.3 * rng.standard_normal(BLOCKS)))
    course = 300.0 * np.exp(-time / 5.0)
    one = course + level * common + SENSOR * rng.standard_normal(BLOCKS)
    two = 2.0 * course + sign * 2.0 * level * common + SENSOR * rng.standard_normal(BLOCKS)
    return {"p_chamber": one, "thrust": two}, level


def covariances(seed: int, sign: float = 1.0, gap: slice | None = None) -> dict[tuple[str, str], Array]:
    blocks, level = shaken(seed, sign)
    usable = np.ones(BLOCKS, dtype=bool)
    if gap is not None:
        usable[gap] = False
        blocks = {name: np.where(usable, values, 1e6) for name, values in blocks.items()}
    return oscillation(blocks, level, usable, {"p_chamber": SENSOR, "thrust": SENSOR})


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_channels_that_oscillate_together_are_known_to(sign: float) -> None:
    found = [covariances(seed, sign) for seed in SEEDS]
    own, other, both = (
        float(np.mean([each[pair][0, 0] for each in found]))
        for pair in (("p_chamber", "p_chamber"), ("thrust", "thrust"), ("p_chamber", "thrust"))
    )
    # each channel's own is not taken for less than it is, and no more for common to both than is
    assert VARIANCE < own < 1.2 * VARIANCE
    assert 4.0 * VARIANCE < other < 1.2 * 4.0 * VARIANCE
    assert 0.8 * 2.0 * VARIANCE < sign * both < 2.0 * VARIANCE


def test_the_oscillation_changes_sign_from_block_to_block() -> None:
    found = np.mean([covariances(seed)["p_chamber", "p_chamber"][0, :12] for seed in SEEDS], axis=0)
    lag = np.arange(1, 5)
    expected = np.cos(2 * np.pi * 11.3 * BLOCK * lag) * np.exp(-0.045 * lag)
    assert (np.sign(found[lag]) == np.sign(expected)).all()
    assert np.abs(found[1:5]).max() < found[0]


def test_it_grows_with_the_level() -> None:
    matrix = covariances(0)["thrust", "thrust"]
    level = shaken(0)[1]
    assert matrix.diagonal() / matrix[0, 0] == pytest.approx(level**2, rel=1e-9)
    assert matrix == pytest.approx(matrix.T)


def test_gaps_are_no_oscillation() -> None:
    whole, holed = (covariances(3, gap=g)["p_chamber", "p_chamber"][0, 0] for g in (None, slice(150, 160)))
    assert holed == pytest.approx(whole, rel=0.25)


def of_samples(seed: int, every: Array) -> Array:
    """Covariance (blocks, blocks) of the chamber's oscillation where only some blocks hold a sample."""
    blocks, level = shaken(seed)
    usable = np.zeros(BLOCKS, dtype=bool)
    usable[every] = True
    empty = {name: np.where(usable, values, 0.0) for name, values in blocks.items()}
    spacing = BLOCKS / every.size
    sensors = {"p_chamber": SENSOR, "thrust": SENSOR}
    return oscillation(empty, level, usable, sensors, spacing)["p_chamber", "p_chamber"]


@pytest.mark.parametrize("clock", ["25 Hz", "50 Hz with jitter"])
def test_the_oscillation_is_measured_in_a_slow_log(clock: str) -> None:
    rng = np.random.default_rng(8)
    stamps = np.arange(BLOCKS) + rng.uniform(-0.7, 0.7, BLOCKS) + 0.5
    every = np.arange(0, BLOCKS, 2) if clock == "25 Hz" else np.unique(stamps.astype(int).clip(0, BLOCKS - 1))
    assert every.size < 0.9 * BLOCKS
    found = [of_samples(seed, every) for seed in SEEDS]
    assert 0.8 * VARIANCE < np.mean([each[0, 0] for each in found]) < 1.25 * VARIANCE
    # by the time between, not by the number of samples between: correlated as blocks are that far apart
    known = np.mean([covariances(seed)["p_chamber", "p_chamber"] for seed in SEEDS], axis=0)
    assert np.sign(np.mean([each[0, 4] for each in found])) == np.sign(known[0, 4])


def test_channels_of_their_own_have_little_in_common() -> None:
    rng = np.random.default_rng(5)
    apart = {name: size * rng.standard_normal(BLOCKS) for name, size in (("p_chamber", 1.0), ("thrust", 2.0))}
    found = oscillation(apart, np.ones(BLOCKS), np.ones(BLOCKS, dtype=bool), {"p_chamber": 0.1, "thrust": 0.1})
    assert abs(found["p_chamber", "thrust"][0, 0]) < 0.1


def test_half_a_second_of_quiet_that_shows_no_wander_is_no_sign_of_none() -> None:
    """A sensor that wanders at 2 kHz: what its half second of quiet says of seconds is within what it says it knows."""
    rate, of = 2000.0, []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        time = np.arange(-0.5, 0.5, 1.0 / rate)
        slow = noise(rng, time.size, rate, 0.0, 1.0 / np.log(20.0 / BLOCK))
        of.append(wander_of(signal("p_purge", time, 30.0 + slow + 0.5 * rng.standard_normal(time.size)), BLOCK))
    off = np.log([over_seconds(wander) / WANDERING[1] for wander in of])
    assert all(wander.variances.all() for wander in of)
    assert float(np.sqrt(np.mean(np.square(off)))) < 1.7 * of[0].unsure
