"""What flies is what the tank would have given without the stand's nitrogen, at altitude by the nozzle's own law."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulated.purged import ROCKET, Truth, fired

from hfanalysis.flight.ascent import ascend
from hfanalysis.flight.curve import Curve, altitude_gain
from hfanalysis.measured_flight.firing import AS_MEASURED, WITHOUT_PURGE, Firing, firing
from hfanalysis.measured_flight.product import fly_measured, product
from hfanalysis.measured_flight.uncertainty import disperse, rows, spread_of
from hfanalysis.products.flight import Flight
from hfanalysis.quantity import Quantity

FLIGHTS = 240
PLAIN = Truth()
SEPARATED = Truth(nozzle="separated", purge=False)


def held(quantity: Quantity, truth: float) -> bool:
    low, high = quantity.interval or (np.nan, np.nan)
    return bool(low <= truth <= high)


@cache
def firing_of(truth: Truth) -> Firing:
    return fired(truth).flown()


def flight_of(found: Firing, shots: bool = False) -> Flight:
    return product(fly_measured(found, ROCKET, FLIGHTS, 1, shots=shots), ROCKET, "no geometry")


def alone(found: Firing, curve: Curve) -> Flight:
    """The flight on one curve, with no other that may hold: as if nothing had been left out of it."""
    return flight_of(replace(found, curve=curve, curves=(curve,), as_measured=(curve,)))


@pytest.mark.parametrize(
    "truth",
    [PLAIN, Truth(choked=True), Truth(m=1.05, n=0.35), Truth(nozzle="separated"), SEPARATED],
    ids=["incompressible vapor", "choked vapor", "other exponents", "and separated", "separated, no purge"],
)
def test_the_corrected_flight_holds_the_truth_and_the_uncorrected_does_not(truth: Truth) -> None:
    up, impulse = fired(truth).flight()
    found = firing_of(truth)
    corrected, old = flight_of(found), alone(found, one_dimensional_as_measured(truth))
    assert held(corrected.apogee, up.height)
    assert held(corrected.impulse_flown, impulse)
    assert not held(old.apogee, up.height)
    assert not held(old.impulse_flown, impulse)


def one_dimensional_as_measured(truth: Truth) -> Curve:
    """The thrust as it was flown before: purge gas and all, to altitude by the one-dimensional law."""
    return fired(truth).flown(nozzle="one-dimensional").as_measured[0]


@pytest.mark.parametrize("truth", [PLAIN, Truth(choked=True)])
def test_the_vapor_s_own_law_gives_the_unsteady_engine_s_impulse(truth: Truth) -> None:
    """Whose nozzle's thrust after t_purge is known, to two in a hundred."""
    assert truth.m == 1.15
    run, start = fired(truth).alone, fired(truth).segments.t_purge.value
    late = run.time >= start
    expected = float(np.trapezoid(run.output("thrust")[late], run.time[late]))
    curve = firing_of(truth).curve
    late = curve.time >= start
    assert float(np.trapezoid(curve.thrust[late], curve.time[late])) == pytest.approx(expected, rel=0.03)


def test_both_apogees_are_stated_and_the_basis_is_said() -> None:
    found = flight_of(firing_of(PLAIN))
    assert found.thrust_basis == WITHOUT_PURGE
    assert found.apogee_as_measured.value > found.apogee.value + 100.0
    assert any("purge gas fed the burn" in note for note in found.notes)
    assert found.impulse_flown.value > found.impulse_stand.value


def test_raw_thrust_is_the_stand_s_purge_gas_and_all() -> None:
    test = fired(PLAIN)

    raw = firing(test.log, test.segments, test.calibration, test.definition, raw_thrust=True)
    found = flight_of(raw)
    assert found.thrust_basis == AS_MEASURED
    assert raw.curve.gain.shape == (1, 1)
    assert found.impulse_flown.value == pytest.approx(found.impulse_stand.value, rel=2e-3)
    assert found.apogee_as_measured == found.apogee


@pytest.mark.parametrize(
    ("change", "said"),
    [({"t_purge": Quantity(3.0, "s", 0.01)}, "before the liquid is gone"), ({"C_i": None}, "no C_i is known")],
)
def test_what_cannot_be_told_flies_as_measured_with_a_warning(change: dict[str, Quantity | None], said: str) -> None:

    test = fired(PLAIN)
    calibrated = None if "C_i" in change else test.calibration
    segments = test.segments if "C_i" in change else test.segments.but(**change)
    found = firing(test.log, segments, calibrated, test.definition)
    assert found.thrust_basis == AS_MEASURED
    assert said in " ".join(found.warnings)


def test_without_purge_and_with_a_full_nozzle_nothing_differs() -> None:
    """p_c stays above separation: the curve is the measured thrust's, with the one-dimensional gain, and alone."""
    test = fired(Truth(purge=False))
    segments = test.segments.but(t_end=Quantity(4.0, "s", 0.01))

    found = firing(test.log, segments, test.calibration, test.definition)
    time = found.curve.time
    assert found.curves == found.as_measured == (found.curve,)
    pressure = np.interp(time, test.alone.time, test.alone.output("chamber_pressure"))
    nozzle = test.definition.nozzle
    assert nozzle is not None
    areas = [np.pi * radius.value**2 for radius in (nozzle.throat_radius, nozzle.exit_radius) if radius is not None]
    expected, _ = altitude_gain(np.full(time.size, 1.26), pressure, 101_325.0, *areas)
    lit = pressure > 7e5
    assert found.curve.gain[lit, 20] == pytest.approx(expected[lit, 20], rel=1e-6)


def test_a_stated_law_corrects_and_the_band_holds_the_other() -> None:
    test = fired(SEPARATED)
    one, off = (test.flown(nozzle=law) for law in ("one-dimensional", "separated"))
    high, low = (flight_of(found).apogee for found in (one, off))
    assert high.value > low.value + 20.0
    assert held(high, low.value)
    assert held(low, high.value)
    assert firing_of(SEPARATED).curve.gain == pytest.approx(off.curve.gain)


def test_the_band_says_what_it_covers_and_shots_widen_it() -> None:
    once, again = flight_of(firing_of(SEPARATED)), flight_of(firing_of(SEPARATED), shots=True)
    assert "if this thrust repeats exactly" in once.band_covers
    assert "6.7 %" in again.band_covers
    assert "default" in again.band_covers
    assert again.apogee.std > 3.0 * once.apogee.std
    assert again.apogee.value == once.apogee.value


def test_more_flights_than_courses_are_kept_all_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether one curve flies or several, and the courses are those of the first rows."""
    found = firing_of(SEPARATED)
    drawn = rows(found, ROCKET, 700, 1)
    every = {n: disperse(found, drawn, 30.0, curves=found.curves[:n]) for n in (1, 2)}
    monkeypatch.setattr("hfanalysis.measured_flight.uncertainty.PATHS", 100)
    for count, all_kept in every.items():
        few = disperse(found, drawn, 30.0, curves=found.curves[:count])
        assert few.results == pytest.approx(all_kept.results, nan_ok=True)
        first = disperse(found, drawn[:100], 30.0, curves=found.curves[:count])
        shared = min(few.time.size, first.time.size)
        assert few.bands["height"][:, :shared] == pytest.approx(first.bands["height"][:, :shared])


def test_thrust_to_weight_at_lift_off_is_the_mean_on_the_rail() -> None:
    found = firing_of(SEPARATED)
    up = ascend(found.curve, found.vehicle, found.rail_length)
    said = flight_of(found)
    speed = float(said.rail_departure_velocity.value or 0.0)
    rail = float(found.rail_length or 0.0)
    mean = speed**2 / (2.0 * rail) / 9.80665 + np.cos(found.vehicle.launch_angle)
    assert said.liftoff_thrust_to_weight.value == pytest.approx(mean, rel=0.05)
    assert said.liftoff_thrust_to_weight.value < said.pad_thrust_to_weight.value
    assert up.height == pytest.approx(said.apogee.value)


def test_of_several_laws_the_interval_holds_that_of_each() -> None:
    """Ten flights in a hundred by a law of its own are no tail."""
    rng = np.random.default_rng(1)
    values, laws = rng.normal(0.0, 1.0, 1000), np.repeat([0, 1], [900, 100])
    values[laws == 1] += 20.0
    low, high = spread_of(values, laws).ci95
    assert low == pytest.approx(-1.96, abs=0.2)
    assert high == pytest.approx(21.96, abs=0.6)
    assert spread_of(values).ci95[0] == pytest.approx(low, abs=0.2)
