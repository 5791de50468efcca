"""What of a channel fluctuates."""

from __future__ import annotations

import numpy as np
import pytest
from tests.inference.oscillations.made import MEAN, clock, noise, signal, wave

from hfanalysis.inference.oscillations.fluctuation import LOWEST, fluctuation


def test_an_oscillation_stays_and_the_course_goes() -> None:
    time = clock(200.0, 4.0)
    found = fluctuation(signal(time, wave(time, 0.02, LOWEST)), 0.0, 4.0)
    assert found is not None
    assert np.sqrt(found.variance) / MEAN == pytest.approx(0.02, rel=0.03)
    still = fluctuation(signal(time), 0.0, 4.0)
    assert still is not None
    assert np.sqrt(still.variance) / MEAN < 1e-4


def test_single_wild_samples_are_no_range() -> None:
    time = clock(1000.0, 4.0)
    rough = noise(time, 0.01)
    calm = fluctuation(signal(time, rough), 0.0, 4.0)
    rough[2500] += MEAN
    wild = fluctuation(signal(time, rough), 0.0, 4.0)
    assert calm is not None
    assert wild is not None
    assert calm.peak_to_peak / MEAN == pytest.approx(2.0 * 2.576 * 0.01, rel=0.05)
    assert wild.peak_to_peak == pytest.approx(calm.peak_to_peak, rel=0.02)


def test_too_few_samples_are_none() -> None:
    time = clock(5.0, 4.0)
    assert fluctuation(signal(time), 0.0, 4.0) is None
    assert fluctuation(signal(clock(100.0, 4.0)), 3.0, 12.0) is None
