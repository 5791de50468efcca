"""Lines: where they are found, where none is, and how well they are measured."""

from __future__ import annotations

import numpy as np
import pytest
from tests.inference.oscillations.made import MEAN, clock, noise, signal, wave

from hfanalysis.arrays import Array
from hfanalysis.inference.oscillations.fluctuation import Fluctuation, fluctuation
from hfanalysis.inference.oscillations.lines import lines
from hfanalysis.inference.oscillations.paths import detectable
from hfanalysis.inference.oscillations.spectrum import spectra


def fluctuating(time: Array, *parts: Array, end: float = 4.0) -> Fluctuation:
    found = fluctuation(signal(time, *parts), 0.0, end)
    assert found is not None
    return found


def test_the_floor_follows_noise_through_a_filter() -> None:
    time = clock(500.0, 8.0)
    color = 0.9
    looked = spectra(fluctuating(time, noise(time, 0.01, color), end=8.0))
    for found in looked:
        shape = 1.0 / (1.0 + color**2 - 2.0 * color * np.cos(2.0 * np.pi * found.frequency / 500.0))
        true = (0.01 * MEAN) ** 2 * (1.0 - color**2) * 2.0 / 500.0 * shape
        assert np.median(found.floor / true) == pytest.approx(1.0, abs=0.06)
        assert np.abs(np.log(found.floor / true)).max() < 0.7


def test_where_there_is_none_none_is_found() -> None:
    for seed in range(12):
        time = clock((50.0, 200.0, 800.0)[seed % 3], 4.0, jitter=0.5, seed=seed)
        assert not lines(fluctuating(time, noise(time, 0.02, (0.0, 0.9)[seed % 2], seed)))


@pytest.mark.parametrize(
    ("rate", "frequency", "slope", "share"),
    [(50.0, 21.0, 0.0, 0.03), (100.0, 30.0, -1.5, 0.02), (1000.0, 7.3, 0.0, 0.02), (1000.0, 190.0, 2.0, 0.005)],
)
def test_a_line_is_measured(rate: float, frequency: float, slope: float, share: float) -> None:
    time = clock(rate, 4.0, jitter=0.4)
    (found,) = lines(fluctuating(time, noise(time, 0.01), wave(time, share, frequency, slope)))
    middle = frequency + 2.0 * slope
    assert abs(found.frequency - middle) < found.reach < 0.3 + 2.5 * abs(slope)
    assert abs(found.rms / MEAN - share) < max(4.0 * found.rms_std / MEAN, 0.05 * share)
    assert found.start < 0.6
    assert found.end > 3.4
    assert found.course == "steady"


def test_two_lines_are_two_and_a_strong_one_has_no_sidelobes() -> None:
    time = clock(500.0, 4.0)
    both = fluctuating(time, noise(time, 0.003), wave(time, 0.1, 40.0), wave(time, 0.01, 61.0))
    assert [round(line.frequency) for line in lines(both)] == [40, 61]


def test_the_limit_is_where_lines_begin_to_be_found() -> None:
    time = clock(200.0, 4.0)
    rough = noise(time, 0.02)
    found = fluctuating(time, rough)
    limit = detectable(spectra(found), 33.0) / MEAN
    assert lines(fluctuating(time, rough, wave(time, 1.4 * limit, 33.0)))
    assert not lines(fluctuating(time, rough, wave(time, 0.5 * limit, 33.0)))
    assert detectable(spectra(found), 150.0) == np.inf


def test_it_is_seen_from_when_to_when_and_that_it_grows() -> None:
    time = clock(200.0, 6.0)
    later = wave(time, 0.03, 25.0) * (time > 2.5)
    (found,) = lines(fluctuating(time, noise(time, 0.005), later, end=6.0))
    assert found.start == pytest.approx(2.5, abs=0.5)
    assert found.end == pytest.approx(6.0, abs=0.5)
    grows = wave(time, 0.01, 25.0) * np.exp(0.4 * time)
    (found,) = lines(fluctuating(time, noise(time, 0.005), grows, end=6.0))
    assert found.course == "grows"
    assert found.trend == pytest.approx(0.4 * (found.end - found.start), rel=0.25)
