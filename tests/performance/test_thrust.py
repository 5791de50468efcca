"""The cell's zero after the burn: an engine without chamber pressure has no thrust, whatever the cell reads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.heated_cell import heated, quenched
from tests.segment.stand import Trial, definition, segments_of

from hfanalysis.performance.thrust import thrust_of


@pytest.fixture(scope="module")
def burn() -> Trial:
    """A firing whose chamber is back at ambient pressure 9 s after the opening, logged for 10 s more."""
    return quenched()


@pytest.mark.parametrize("size", [200.0, -150.0])
def test_the_drift_up_to_the_end_of_the_fire_is_taken_off(burn: Trial, size: float) -> None:
    found = thrust_of(heated(burn, size), segments_of(burn), definition(burn.stand))
    assert found.since == pytest.approx(9.0, abs=0.6)
    assert found.error == pytest.approx(size, rel=0.15)
    true = burn.values["thrust"]
    assert np.abs(found.signal.value - true).max() < 0.1 * abs(size)


def test_without_a_zeroed_chamber_gauge_nothing_is_changed(burn: Trial) -> None:
    log = heated(burn, 200.0)
    blind = replace(log, channels={**log.channels, "p_chamber": replace(log["p_chamber"], zero_std=None)})
    found = thrust_of(blind, segments_of(burn), definition(burn.stand))
    np.testing.assert_array_equal(found.signal.value, log["thrust"].values)
    assert np.isnan(found.since)


def test_a_cell_that_reads_next_to_nothing_is_left_alone(burn: Trial) -> None:
    log = heated(burn, 10.0)
    found = thrust_of(log, segments_of(burn), definition(burn.stand))
    np.testing.assert_array_equal(found.signal.value, log["thrust"].values)
