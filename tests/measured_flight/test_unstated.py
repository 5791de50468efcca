"""What stands in for what nobody states of a firing, and where drawn flights say nothing."""

from __future__ import annotations

from dataclasses import replace
from datetime import date as date_of

import numpy as np
import pytest
from tests.products.filled import filled
from tests.segment.heated_cell import EMPTY, heated, quenched
from tests.segment.stand import Trial, definition, segments_of

from hfanalysis.flight.ascent import RESULTS
from hfanalysis.flight.summary import ASCENT
from hfanalysis.measured_flight.propellant import exponent_of, propellant
from hfanalysis.measured_flight.thrust import MeasuredThrust, _drift_taken, measured_thrust
from hfanalysis.measured_flight.uncertainty import DrawnFlights
from hfanalysis.performance.thrust import Thrust
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import ChannelSpec
from hfanalysis.record.log import TestLog
from hfanalysis.record.schema import changed
from hfanalysis.record.sections import GrainSection
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value


@pytest.fixture(scope="module")
def burn() -> Trial:
    return quenched()


def flown(test: Trial, log: TestLog) -> MeasuredThrust:
    return measured_thrust(log, segments_of(test, t_end=Quantity(EMPTY, "s", 0.01)), definition(test.stand))


def test_how_far_a_drift_has_come_is_anything_from_nothing_to_all(burn: Trial) -> None:
    """At any moment: the standard deviation of even odds between 0 and its size."""
    drawn = 300.0 * np.random.default_rng(6).uniform(size=20_000)
    assert flown(burn, heated(burn, 300.0)).bias_std == pytest.approx(np.std(drawn), rel=0.15)


def test_a_drift_that_nothing_shows_is_a_hundredth_of_the_peak(burn: Trial) -> None:
    log = heated(burn, 0.0)
    blind = replace(log, channels={**log.channels, "p_chamber": replace(log["p_chamber"], zero_std=None)})
    peak = float(burn.values["thrust"].max())
    assert flown(burn, blind).drift_std == pytest.approx(0.01 * peak, rel=0.02)


@pytest.mark.parametrize(
    ("tested", "calibrated", "gain"),
    [(None, None, 0.01), ((2022, 4, 3), (2022, 1, 10), 0.0025), (None, (2022, 1, 10), 0.0025),
     ((2022, 4, 3), (2020, 1, 10), 0.01)],
)  # fmt: skip
def test_a_gain_is_as_good_as_its_calibration_in_place(
    burn: Trial, tested: tuple[int, int, int] | None, calibrated: tuple[int, int, int] | None, gain: float
) -> None:
    """However accurate the cell itself is, without one the stand may carry a hundredth of the thrust beside it."""
    log, stated = heated(burn, 0.0), definition(burn.stand)
    date = date_of(*tested) if tested else None
    known = ChannelSpec(column="F", unit="N", calibrated=date_of(*calibrated) if calibrated else None, name="thrust")
    stated = changed(stated, test=changed(stated.test, date=date), channels={**stated.channels, "thrust": known})
    exact = replace(log["thrust"], accuracy=0.1)
    found = measured_thrust(replace(log, channels={**log.channels, "thrust": exact}), segments_of(burn), stated)
    assert found.gain_std == gain


@pytest.mark.parametrize(("size", "told"), [(200.0, True), (0.0, False)])
def test_a_drift_is_told_where_it_is_taken_off(burn: Trial, size: float, told: bool) -> None:
    assert any("drift taken off" in note for note in flown(burn, heated(burn, size)).notes) is told


def test_masses_without_a_deviation_are_known_to_a_hundredth(burn: Trial) -> None:
    grain = GrainSection(mass=Value(1.6), length=Value(0.6), density=Value(900.0), outer_radius=Value(40e-3))
    stated = definition(burn.stand, mass=Value(10.0), grain=grain)
    log = heated(burn, 0.0)
    found = propellant(log, segments_of(burn), None, stated, flown(burn, log))
    assert found.loaded_std == pytest.approx(np.hypot(0.1, 0.016))
    assert not found.stated_std


@pytest.mark.parametrize(("n", "used"), [(0.45, 0.45), (1.5, 1.5), (-0.1, 0.5), (2.4, 0.5), (None, 0.5)])
def test_a_calibrated_exponent_is_taken_where_fuels_may_have_it(n: float | None, used: float) -> None:
    calibration = filled(Calibration, {"n": Quantity.absent("not known") if n is None else Quantity(n)})
    assert exponent_of(definition(), calibration)[0] == used


def results(reached: int) -> DrawnFlights:
    """A thousand flights of which so many leave the rail."""
    values = np.random.default_rng(7).normal(1000.0, 50.0, (1000, RESULTS))
    values[reached:, ASCENT["rail_departure_velocity"][0]] = np.nan
    return DrawnFlights(values, np.zeros(1), {})


def test_a_quantity_that_one_flight_in_five_lacks_has_no_spread() -> None:
    """Of those that have it the spread would be too small."""
    assert "rail_departure_velocity" in results(950).spreads()
    assert "rail_departure_velocity" not in results(800).spreads()
    found = results(1000).spreads()["apogee"]
    assert found.std == pytest.approx(50.0, rel=0.1)
    assert found.ci95 == pytest.approx((1000.0 - 98.0, 1000.0 + 98.0), abs=15.0)


@pytest.mark.parametrize(
    ("drift", "told"), [(0.3, ()), (0.7, ("1 N of the load cell's drift taken off over the burn",))]
)
def test_a_drift_is_told_that_does_not_round_to_nothing(burn: Trial, drift: float, told: tuple[str, ...]) -> None:
    signal = Signal.of(heated(burn, 0.0)["thrust"])
    assert _drift_taken(Thrust(signal, drift, np.nan)) == told
