"""What a stretch of a signal holds does not hang on the last digits of its times."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.record.signals import Signal

ORIGINS = (0.0, 1.0 / 3.0, 0.1 + 0.2, 1234.567)
"""Log times of the opening, which are no multiples of the step in binary digits."""


def ramp(origin: float) -> Signal:
    """Samples of a steep ramp every millisecond, counted from an origin: a sample more or less in a mean shows."""
    time = origin + np.arange(2000) * 1e-3
    return Signal("p_tank", time, 1e5 * np.arange(2000.0) ** 2, 1.0, 1e-3).shifted(origin)


@pytest.mark.parametrize("origin", ORIGINS)
def test_a_sample_on_the_edge_of_a_running_mean_counts(origin: float) -> None:
    assert ramp(origin).smooth(0.1) == pytest.approx(ramp(0.0).smooth(0.1), rel=1e-12)


@pytest.mark.parametrize("origin", ORIGINS)
def test_blocks_hold_as_many_samples_wherever_times_are_counted_from(origin: float) -> None:
    blocks = ramp(origin).reduced(0.002)
    assert blocks.time.size == 1000
    assert blocks.value == pytest.approx(ramp(0.0).value.reshape(-1, 2).mean(axis=1), rel=1e-12)


@pytest.mark.parametrize("origin", ORIGINS)
def test_a_stretch_holds_the_sample_at_its_start_and_not_the_one_at_its_end(origin: float) -> None:
    part = ramp(origin).between(0.3, 0.7)
    assert part.value.tolist() == ramp(0.0).value[300:700].tolist()


@pytest.mark.parametrize("origin", ORIGINS)
def test_a_hole_beside_a_single_sample_is_bridged_from_it(origin: float) -> None:
    time = np.concatenate([np.arange(0.0, 1.0, 0.01), [1.5], np.arange(2.0, 3.0, 0.01)])
    values = np.where(time < 1.25, 1.0, np.where(time < 1.75, 2.0, 3.0))
    bridged = Signal("thrust", origin + time, values, 0.01, 0.01).shifted(origin).bridged()
    assert np.isfinite(bridged.value).all()
    assert bridged.at(np.array([1.245, 1.75])) == pytest.approx([1.5, 2.5])


def test_between_two_samples_a_mean_is_their_line() -> None:
    """A logger of 2 Hz has none within a tenth of a second of most instants."""
    sparse = Signal("p_tank", np.arange(0.0, 4.0, 0.5), 2.0 * np.arange(0.0, 4.0, 0.5), 0.0, 0.5)
    assert sparse.around(1.25, 0.1) == pytest.approx(2.5)
    assert ramp(0.0).around(0.5, 0.1) == ramp(0.0).mean(0.4, 0.6)
