"""An instant found in noise: without bias, and scattering by the deviation that goes with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter
from simulated.stand import noise
from tests.segment.stand import signal

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.segment.breaks import Break, combine, find_break, kink, memory_length
from hfanalysis.segment.refine import refine_kink, refine_knee, refine_step

RATE = 250.0
TIME = np.arange(0.0, 6.0, 1.0 / RATE)
TRIALS = 30
Shape = Callable[[float], Array]


def knee(instant: float) -> Array:
    """A tank's pressure: -2 bar/s with liquid, -8 bar/s without."""
    x = TIME - instant
    return np.asarray(30e5 - 2e5 * x - 6e5 * np.maximum(x, 0.0) + 0.3e5 * x**2)


def froth(instant: float) -> Array:
    """The same, with a slope that turns evenly over 0.35 s."""
    x = TIME - instant
    inside = np.clip(x + 0.175, 0.0, 0.35)
    return np.asarray(30e5 - 2e5 * x - 6e5 * (inside**2 / 0.7 + np.maximum(x - 0.175, 0.0)))


def sag(instant: float) -> Array:
    """A purge line that holds its pressure until nitrogen flows."""
    return np.asarray(40e5 - 6e5 * (1.0 - np.exp(-np.maximum(TIME - instant, 0.0) / 1.5)))


def fall(instant: float) -> Array:
    """A chamber whose pressure drops within milliseconds."""
    x = TIME - instant
    return np.asarray(14e5 - 0.5e5 * x - 8e5 * (1.0 - np.exp(-np.maximum(x, 0.0) / 0.008)))


def found_in_noise(
    shape: Shape, white: float, flicker: float, find: Callable[[Array, Noise, float], Break | None]
) -> tuple[Array, Array]:
    """Errors and stated deviations over random noises and random instants."""
    generator = np.random.default_rng(12)
    errors, stds = [], []
    for _ in range(TRIALS):
        instant = 3.0 + generator.uniform(-0.2, 0.2)
        value = shape(instant) + noise(generator, TIME.size, RATE, white, flicker)
        rough = instant + generator.uniform(-0.08, 0.08)
        found = find(value, Noise(white, flicker, 1.0 / RATE), rough)
        assert found is not None
        errors.append(found.time - instant)
        stds.append(found.std)
    return np.array(errors), np.array(stds)


def at_kink(value: Array, sensor: Noise, rough: float) -> Break | None:
    return refine_kink(signal("p_tank", TIME, value), rough, 0.6, 0.6, 0.15, noise=sensor)


def at_sag(value: Array, sensor: Noise, rough: float) -> Break | None:
    return refine_kink(signal("p_purge", TIME, value), rough, 0.6, 0.6, 0.2, flat=True, noise=sensor)


def at_fall(value: Array, sensor: Noise, rough: float) -> Break | None:
    return refine_step([signal("p_chamber", TIME, value)], rough, 0.4, 0.3, 0.15)


@pytest.mark.parametrize(
    ("shape", "find", "white", "flicker"),
    [
        pytest.param(knee, at_kink, 8e3, 0.0, id="tank knee, white noise"),
        pytest.param(knee, at_kink, 8e3, 1e6, id="tank knee, wandering sensor"),
        pytest.param(sag, at_sag, 8e3, 0.0, id="purge sag, white noise"),
        pytest.param(sag, at_sag, 8e3, 1e6, id="purge sag, wandering sensor"),
        pytest.param(fall, at_fall, 6e4, 0.0, id="chamber fall, white noise"),
        pytest.param(fall, at_fall, 6e4, 1e6, id="chamber fall, wandering sensor"),
    ],
)
def test_an_instant_is_unbiased_and_its_deviation_honest(
    shape: Shape, find: Callable[[Array, Noise, float], Break | None], white: float, flicker: float
) -> None:
    errors, stds = found_in_noise(shape, white, flicker, find)
    z = errors / stds
    assert abs(errors.mean()) < 3.0 * errors.std() / np.sqrt(TRIALS)
    assert 0.6 < np.sqrt(np.mean(z**2)) < 1.5
    assert np.abs(z).max() < 4.0
    assert np.abs(errors).max() < 0.05  # and the start, within 0.08 s, was not already the answer
    assert errors.std() < 0.02


def test_a_rounded_knee_is_dated_at_its_middle_with_its_width_as_doubt() -> None:
    errors, stds = found_in_noise(
        froth, 8e3, 0.0, lambda v, sensor, rough: refine_knee(signal("p_tank", TIME, v), rough, 0.9, 0.9, 0.2, sensor)
    )
    assert abs(errors.mean()) < 0.02
    assert (np.abs(errors) < 2.0 * stds).all()
    assert stds.min() > 0.2 / np.sqrt(12.0)


def test_two_channels_that_break_together_date_it_better_than_one() -> None:
    generator = np.random.default_rng(5)
    alone, together = [], []
    for _ in range(16):
        pair = [signal(n, TIME, fall(3.001) + noise(generator, TIME.size, RATE, 1e5, 0.0)) for n in ("a", "b")]
        one, both = refine_step(pair[:1], 3.0, 0.4, 0.3, 0.1), refine_step(pair, 3.0, 0.4, 0.3, 0.1)
        assert one is not None
        assert both is not None
        assert both.channels == ("a", "b")
        alone.append((one.time - 3.001, one.std))
        together.append((both.time - 3.001, both.std))
    (errors_1, stds_1), (errors_2, stds_2) = np.array(alone).T, np.array(together).T
    assert errors_2.std() < errors_1.std()
    assert stds_2.mean() < 0.9 * stds_1.mean()


def test_profiles_of_several_signals_multiply() -> None:
    grid = np.linspace(-1.0, 1.0, 401)
    one = Break(0.2, 0.1, grid, -0.5 * ((grid - 0.2) / 0.1) ** 2, 0.0, ("a",))
    other = Break(-0.1, 0.2, grid, -0.5 * ((grid + 0.1) / 0.2) ** 2, 0.0, ("b",))
    both = combine([one, other], 1e-4)
    assert both.time == pytest.approx((0.2 / 0.01 - 0.1 / 0.04) / (1 / 0.01 + 1 / 0.04), abs=1e-3)
    assert both.std == pytest.approx((1 / 0.01 + 1 / 0.04) ** -0.5, rel=0.02)
    assert combine([one], 1e-4) is one


def test_a_change_faster_than_the_samples_is_dated_no_better_than_they_lie_apart() -> None:
    step = np.where(TIME < 3.0007, 14e5, 6e5) + noise(np.random.default_rng(3), TIME.size, RATE, 100.0, 0.0)
    found = refine_step([signal("p_chamber", TIME, step)], 3.02, 0.4, 0.3, 0.1)
    assert found is not None
    assert abs(found.time - 3.0007) < 1.0 / RATE
    assert found.std > 0.9 / RATE / np.sqrt(12.0)


def test_without_noise_an_instant_between_samples_is_found_to_a_fraction_of_a_sample() -> None:
    found = refine_kink(signal("p_tank", TIME, knee(3.0007)), 3.02, 0.6, 0.6, 0.15)
    assert found is not None
    assert found.time == pytest.approx(3.0007, abs=0.2 / RATE)


def test_a_window_with_too_few_samples_has_no_instant() -> None:
    assert refine_kink(signal("p_tank", TIME[:100], knee(3.0)[:100]), 3.0, 0.5, 0.5, 0.1) is None
    assert refine_step([signal("p_tank", TIME[:100], knee(3.0)[:100])], 0.0, 0.5, 0.5, 0.1) is None


def test_a_sensor_with_memory_dates_worse_than_its_scatter_says() -> None:
    """The same scatter, but correlated over ten samples: the deviation has to grow."""
    generator = np.random.default_rng(6)
    white = generator.standard_normal(TIME.size)
    slow = np.convolve(generator.standard_normal(TIME.size + 19), np.ones(20), "valid")
    slow /= slow.std()
    grid = np.linspace(2.95, 3.05, 81)
    part = (TIME > 2.4) & (TIME < 3.6)
    stds = []
    for scatter in (white, slow):
        window = signal("p_tank", TIME[part], (knee(3.0) + 8e3 * scatter)[part])
        stds.append(find_break(window, grid, [kink()]).std)
    assert stds[1] > 2.0 * stds[0]


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.8, 0.9])
def test_the_length_of_a_noises_memory(memory: float) -> None:
    """(1 + r) / (1 - r) samples for a noise that keeps the part r from one sample to the next."""
    generator = np.random.default_rng(7)
    lengths = []
    for _ in range(20):
        lengths.append(memory_length(lfilter([1.0], [1.0, -memory], generator.standard_normal(4000))))
    assert np.mean(lengths) == pytest.approx((1.0 + memory) / (1.0 - memory), rel=0.15)


def test_a_constant_has_no_memory() -> None:
    assert memory_length(np.zeros(100)) == 1.0
    assert memory_length(np.zeros(3)) == 1.0
