"""The thrust that flies is the thrust that is reported: one zero, one drift, and how well they are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.heated_cell import EMPTY, heated, quenched
from tests.segment.stand import Trial, definition, segments_of

from hfanalysis.measured_flight.thrust import MeasuredThrust, measured_thrust
from hfanalysis.performance.load_cell import ANY_COURSE, UNSEEN_DRIFT
from hfanalysis.performance.measured import measured
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog


@pytest.fixture(scope="module")
def burn() -> Trial:
    return quenched()


def phases(test: Trial) -> Segments:
    return segments_of(test, t_end=Quantity(EMPTY, "s", 0.01))


def flown(test: Trial, log: TestLog) -> MeasuredThrust:
    return measured_thrust(log, phases(test), definition(test.stand))


def impulse(thrust: MeasuredThrust) -> float:
    return float(np.trapezoid(thrust.thrust, thrust.time))


@pytest.mark.parametrize("size", [300.0, -200.0])
def test_a_cell_s_drift_adds_nothing_to_the_flight(burn: Trial, size: float) -> None:
    """Left in, it would add half of itself over the burn."""
    still = impulse(flown(burn, heated(burn, 0.0)))
    drifted = flown(burn, heated(burn, size))
    assert impulse(drifted) == pytest.approx(still, abs=0.1 * abs(0.5 * size * EMPTY))
    assert drifted.bias_std == pytest.approx(np.hypot(1.0, ANY_COURSE * size), rel=0.15)
    assert any("drift taken off" in note for note in drifted.notes)


def test_flight_and_performance_have_the_same_impulse(burn: Trial) -> None:
    log, stated = heated(burn, 300.0), definition(burn.stand)
    reported = measured(log, phases(burn), stated, None)["total_impulse"]
    found = flown(burn, log)
    assert impulse(found) == pytest.approx(reported.value, rel=1e-4)
    parts = (found.gain_std * impulse(found), found.bias_std * EMPTY, 0.5 * found.drift_std * EMPTY)
    assert np.linalg.norm(parts) == pytest.approx(reported.std, rel=1e-3)


def test_a_drift_too_small_to_be_taken_off_counts_as_uncertain(burn: Trial) -> None:
    found = flown(burn, heated(burn, 10.0))
    assert found.drift_std == pytest.approx(10.0, rel=0.15)
    assert found.bias_std == pytest.approx(np.hypot(1.0, ANY_COURSE * 10.0), rel=0.15)


def test_a_drift_that_nothing_shows_is_a_share_of_the_peak(burn: Trial) -> None:
    log = heated(burn, 300.0)
    blind = replace(log, channels={**log.channels, "p_chamber": replace(log["p_chamber"], zero_std=None)})
    found = flown(burn, blind)
    assert found.drift_std == pytest.approx(UNSEEN_DRIFT * found.thrust.max(), rel=0.01)
    assert not any("drift" in note for note in found.notes)
