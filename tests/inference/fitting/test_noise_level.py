"""How large the slow noise of a sensor is, as an unknown of every hypothesis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.inference import made

from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.noise_level import FARTHEST_FACTOR, louder_or_quieter
from hfanalysis.inference.observations.noise import MOST_SHARE, SlowNoise
from hfanalysis.inference.observations.observed import Observed

Array = NDArray[np.float64]

N, PARAMETERS, UNSURE = 150, 3, 0.4
TIME = np.linspace(0.0, 10.0, N)
SLOW = np.exp(-np.abs(TIME[:, None] - TIME[None, :]))
WHITENING = np.linalg.inv(np.linalg.cholesky(0.5 * np.eye(N) + SLOW))
SLOPES = 3.0 * WHITENING @ np.stack([np.ones(N), TIME, TIME**2], axis=1)


def slow_noise() -> SlowNoise:
    shares, patterns = np.linalg.eigh(WHITENING @ SLOW @ WHITENING.T)
    return SlowNoise(patterns, shares[None, :], np.array([UNSURE]))


def read_with(factor: float, seed: int) -> Array:
    """Whitened readings of a model that is right, by a sensor whose slow noise is larger by a factor."""
    rng = np.random.default_rng(seed)
    true = 0.5 * np.eye(N) + factor**2 * SLOW
    return WHITENING @ np.linalg.cholesky(true) @ rng.standard_normal(N) + SLOPES @ rng.standard_normal(PARAMETERS)


def fitted(data: Array) -> tuple[Array, Array]:
    """The residual at the most probable parameters, and these."""
    x = -np.linalg.solve(SLOPES.T @ SLOPES + np.eye(PARAMETERS), SLOPES.T @ data)
    return data + SLOPES @ x, x


def exact(data: Array) -> float:
    """The gain in log evidence, integrated over the factor on a fine grid with dense covariances."""
    logs = np.linspace(-FARTHEST_FACTOR, FARTHEST_FACTOR, 241)
    slow = WHITENING @ SLOW @ WHITENING.T
    evidences = []
    for log_factor in (*logs, 0.0):
        covariance = np.eye(N) + (np.exp(2.0 * log_factor) - 1.0) * slow + SLOPES @ SLOPES.T
        misfit = float(data @ np.linalg.solve(covariance, data))
        evidences.append(-0.5 * (float(np.linalg.slogdet(covariance)[1]) + misfit))
    weights = np.exp(-0.5 * (logs / UNSURE) ** 2) / (UNSURE * np.sqrt(2.0 * np.pi)) * (logs[1] - logs[0])
    of_factors = np.array(evidences[:-1]) - evidences[-1]
    return float(np.log(np.sum(weights * np.exp(of_factors))))


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_gain_is_that_of_an_integral_over_the_factor(factor: float, seed: int) -> None:
    data = read_with(factor, seed)
    residual, x = fitted(data)
    assert louder_or_quieter(residual, SLOPES, x, slow_noise()) == pytest.approx(exact(data), abs=0.3)


def test_a_sensor_that_is_quieter_than_thought_speaks_for_what_explains_its_reading() -> None:
    """The same departure beside noise of the size that was thought, and beside less."""
    departure = 2.0 * WHITENING @ np.sin(TIME)
    apart = []
    for factor in (1.0, 0.3):
        data = read_with(factor, 5)
        explained, x = fitted(data)
        open_, there = fitted(data + departure)
        gains = [louder_or_quieter(r, SLOPES, at, slow_noise()) for r, at in ((explained, x), (open_, there))]
        plain = 0.5 * (open_ @ open_ + there @ there - explained @ explained - x @ x)
        apart.append((float(plain), float(plain) + gains[0] - gains[1]))
    assert apart[1][1] > apart[1][0] + 3.0
    assert abs(apart[0][1] - apart[0][0]) < 3.0


@given(some.integers(0, 10_000), some.floats(1.0, 300.0))
def test_a_fit_that_has_not_come_to_its_end_gains_no_more_than_what_is_left_there(seed: int, off: float) -> None:
    """Its slopes hold for a step; a factor cannot pay for more than all that is left open after it."""
    data = read_with(1.0, seed)
    residual, x = fitted(data)
    left = 0.5 * float(residual @ residual + x @ x)
    away = off * np.random.default_rng(seed).standard_normal(PARAMETERS)
    gain = louder_or_quieter(residual + SLOPES @ away, SLOPES, x + away, slow_noise())
    assert gain == pytest.approx(louder_or_quieter(residual, SLOPES, x, slow_noise()), abs=1e-3 * off)
    assert gain < left


def with_slow_noise(test: Observed) -> Observed:
    """The same with slow noise in each channel besides."""
    channels = []
    for c in test.channels:
        lag = np.abs(c.time[:, None] - c.time[None, :])
        slow = (0.5 * made.NOISE[c.name]) ** 2 * np.exp(-lag / 2.0)
        channels.append(replace(c, covariance=c.covariance + slow, slow=slow))
    return replace(test, channels=tuple(channels))


@pytest.mark.parametrize("common", [False, True])
def test_the_shares_of_the_patterns_are_those_of_the_channels_slow_noise(common: bool) -> None:
    test = with_slow_noise(made.observed(common=common))
    found = test.slow_noise
    assert found.patterns.T @ found.patterns == pytest.approx(np.eye(found.shares.shape[1]), abs=1e-9)
    at = 0
    for i, c in enumerate(test.channels):
        rows = np.zeros((found.patterns.shape[0], c.time.size))
        rows[at : at + c.time.size] = np.linalg.cholesky(c.slow + 1e-9 * np.diag(c.slow.diagonal()))
        at += c.time.size
        spread = found.patterns.T @ test.whiten(rows)
        assert found.shares[i] == pytest.approx(np.sum(spread**2, axis=1), rel=1e-3, abs=1e-6)
    assert 0.3 < found.shares.sum(axis=0).max() <= MOST_SHARE


def test_without_slow_noise_nothing_changes() -> None:
    test = made.observed()
    done = fit(made.hypothesis(), test)
    assert louder_or_quieter(done.residual, done.slopes, done.x, test.slow_noise) == 0.0
    quiet = with_slow_noise(test).with_white_noise()
    assert quiet.slow_noise.shares.size == 0


def test_blocks_that_are_left_out_take_their_slow_noise_with_them() -> None:
    test = with_slow_noise(made.observed())
    left_out = {c.name: np.arange(c.time.size) % 3 == 0 for c in test.channels}
    for c in test.without(left_out).channels:
        assert c.slow is not None
        assert c.slow.shape == c.covariance.shape
