"""What is left of the propellant, from calibrated pressures, a load cell, or the thrust alone."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from hfanalysis.errors import AbsentError
from hfanalysis.flight.summary import FlightSpread
from hfanalysis.measured_flight.firing import Firing, firing
from hfanalysis.measured_flight.uncertainty import disperse, inputs, rows
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.disk import read_json
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.log import TestLog, read_log
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).resolve().parents[2]


@cache
def analysed() -> tuple[TestLog, Segments, Calibration]:
    """The replica of Hot Fire 5: its log, phases and calibration."""
    root = Path(mkdtemp())
    shutil.copytree(ROOT / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    out = run_to("calibrate", open_test(root, "HF5", settings={"calibrate.samples": 20})).out
    segments = Segments.from_json(read_json(out / "segments.json"))
    found = read_log(out / "ingest.h5"), segments, Calibration.from_json(read_json(out / "calibration.json"))
    shutil.rmtree(root)
    return found


def definition(*changes: tuple[str, str]) -> TestDefinition:
    """Its test.toml, changed."""
    folder = Path(mkdtemp()) / "HF5"
    folder.mkdir()
    text = (ROOT / "raw_tests" / "HF5" / "test.toml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "test.toml").write_text(text)
    (folder / "log.csv").write_text("")
    found = load_definition(folder / "test.toml")
    shutil.rmtree(folder.parent)
    return found


@cache
def replica(*changes: tuple[str, str], calibrated: bool = True, without: tuple[str, ...] = ()) -> Firing:
    """Its firing by a changed test.toml, without some channels, and with the purge gas that it had."""
    log, segments, calibration = analysed()
    kept = replace(log, channels={name: of for name, of in log.channels.items() if name not in without})
    as_fired = segments.but(t_purge=Quantity.absent("nothing is left out here"))
    return firing(kept, as_fired, calibration if calibrated else None, definition(*changes))


def flown(drag: float) -> dict[str, FlightSpread]:
    """What drawn flights with an uncertainty of the drag say."""
    rocket = definition().rocket
    assert rocket is not None
    drawn = rows(replica(), replace(rocket, drag_uncertainty=drag), 1000, 3)
    return disperse(replica(), drawn, 30.0, curves=(replica().curve,)).spreads()


def left(found: Firing, time: float) -> tuple[float, float]:
    """Oxidizer and fuel [kg] at a time [s]."""
    load = found.propellant
    return float(np.interp(time, load.time, load.oxidizer)), float(np.interp(time, load.time, load.fuel))


def test_the_oxidizer_at_the_end_of_the_liquid_is_the_calibrated_vapor() -> None:
    """1.87 kg by the calibration of the noisy log."""
    assert left(replica(), 5.27)[0] == pytest.approx(1.873, rel=0.01)
    assert left(replica(), 0.0) == pytest.approx((8.35, 1.594))


def test_the_liquid_is_gone_when_the_phases_say_so() -> None:
    load = replica().propellant
    assert np.interp(5.2, load.time, load.liquid) > 0.0
    assert np.interp(5.4, load.time, load.liquid) == 0.0
    assert np.all(load.liquid <= load.oxidizer + 1e-12)


def test_masses_never_grow() -> None:
    load = replica().propellant
    assert np.all(np.diff(load.oxidizer) <= 1e-12)
    assert np.all(np.diff(load.fuel) <= 1e-12)
    assert load.fuel[-1] == pytest.approx(0.0, abs=1e-9)


def test_without_a_calibration_the_load_cell_says_what_is_left() -> None:
    """Within half a kilogram of the injector's equation, the cell being shaken."""
    weighed = replica(calibrated=False)
    assert "load cell" in weighed.propellant.how["oxidizer"]
    for time in (1.0, 3.0, 5.0):
        assert left(weighed, time)[0] == pytest.approx(left(replica(), time)[0], abs=0.5)


def test_with_neither_the_thrust_says_it() -> None:
    guessed = replica(calibrated=False, without=("m_tank",))
    assert "impulse" in guessed.propellant.how["oxidizer"]
    assert left(guessed, 3.0)[0] == pytest.approx(left(replica(), 3.0)[0], abs=1.0)
    assert left(guessed, 17.0)[0] == pytest.approx(0.0, abs=1e-9)


def test_what_was_weighed_after_the_burn_is_left() -> None:
    seen = ("[observed]\n", '[observed]\nfuel_mass_after = "0.25 kg"\noxidizer_mass_after = "0.4 kg"\n')
    found = replica(seen)
    assert left(found, 17.0) == pytest.approx((0.4, 0.25), abs=1e-6)
    assert "0.250 kg left as seen" in found.propellant.how["fuel"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('mass = "1594 g"\n', ""), r"\[grain\] mass is not given"),
        (('launch_angle = "6 deg"\n', ""), "launch_angle is not given"),
        (("drag_coefficient = 0.529\n", ""), "drag_coefficient"),
        (('diameter = "157.48 mm"\n', ""), "frontal_area"),
    ],
)
def test_what_a_flight_needs_is_named(change: tuple[str, str], said: str) -> None:
    with pytest.raises(AbsentError, match=said):
        replica(change, calibrated=False)


def test_corrected_conventions_carry_what_is_left() -> None:
    seen = ("[observed]\n", '[observed]\nfuel_mass_after = "0.25 kg"\n')
    carrying = replica(seen, ('conventions = "report"', 'conventions = "corrected"'))
    assert carrying.curve.mass_after == pytest.approx(52.5 + carrying.propellant.total[-1])
    assert replica(seen).curve.mass_after == 52.5


def test_the_chamber_s_gas_weighs_grams() -> None:
    gas = replica().gas_mass
    assert gas is not None
    assert 1e-3 < gas.max() < 20e-3


def test_the_nozzle_gains_what_the_ambient_pressure_loses_while_it_flows_full() -> None:
    """(p_stand - p_a) A_e at the peak of the chamber's pressure."""
    curve = replica().curve
    at = int(1.0 / curve.step)
    pressures = curve.ambients[0] + curve.ambients[1] * np.arange(curve.gain.shape[1])
    gained = np.interp(84_623.0, pressures, curve.gain[at])
    assert gained == pytest.approx((101_300.0 - 84_623.0) * np.pi * 0.0381**2, rel=1e-6)


def test_a_coarse_log_keeps_its_straight_lines() -> None:
    """Thrust sampled every 0.2 s: between two samples the curve lies on the line through them."""
    log, segments, calibration = analysed()
    thrust = log["thrust"]
    coarse = replace(thrust, **{name: getattr(thrust, name)[::200] for name in ("time", "values", "flags")}, raw=None)
    sparse = replace(log, channels={**log.channels, "thrust": coarse})
    curve = firing(sparse, segments, calibration, definition(), raw_thrust=True).curve
    times = coarse.time[coarse.good] - (segments.t_open.value or 0.0)
    inside = (curve.time > 1.0) & (curve.time < 16.0)
    expected = np.interp(curve.time, times, coarse.values[coarse.good])
    assert curve.thrust[inside] == pytest.approx(expected[inside], abs=0.02 * float(expected.max()))
    assert np.median(np.abs(curve.thrust[inside] - expected[inside])) < 1e-6 * float(expected.max())


def test_without_an_exit_radius_the_thrust_stays_the_stand_s() -> None:
    raw = replica(('exit_radius = "38.1 mm"\n', ""))
    assert raw.curve.gain.shape == (1, 1)
    assert "exit_radius" in " ".join(raw.notes)


def test_stated_uncertainties_win_over_the_defaults() -> None:
    changed = definition(
        ('launch_angle = "6 deg"', 'launch_angle = "6 +/- 2 deg"'),
        ("drag_coefficient = 0.529", "drag_coefficient = 0.529\ndrag_uncertainty = 0.03"),
        ("[rocket.drogue]", 'wind_speed = "5 +/- 1 m/s"\n[rocket.drogue]'),
        ('dry_mass = "52.5 kg"', 'dry_mass = "52.5 +/- 0.2 kg"'),
        ('mass = "1594 g"', 'mass = "1594 +/- 2 g"'),
    ).rocket
    assert changed is not None
    found = inputs(replica(), changed)
    assert found["launch_angle"].std == pytest.approx(np.radians(2.0))
    assert [found[name].std for name in ("drag", "wind", "dry_mass")] == pytest.approx([0.03, 1.0, 0.2])
    assert all(found[name].stated for name in ("launch_angle", "drag", "wind", "dry_mass"))
    assert not found["propellant"].stated


def test_drawn_flights_are_the_same_from_run_to_run() -> None:
    rocket = definition().rocket
    assert rocket is not None
    first, second = (disperse(replica(), rows(replica(), rocket, 600, 7), 30.0) for _ in range(2))
    assert np.array_equal(first.results, second.results)
    assert np.array_equal(first.bands["height"], second.bands["height"])


def test_more_uncertain_drag_spreads_the_apogee_and_not_the_rail_s_end() -> None:
    narrow, wide = flown(0.01), flown(0.3)
    assert wide["apogee"].std > 1.5 * narrow["apogee"].std
    assert wide["rail_departure_velocity"].std == pytest.approx(narrow["rail_departure_velocity"].std, rel=0.05)


def test_the_bands_hold_the_flight_in_the_middle_of_the_drawn_ones() -> None:
    rocket = definition().rocket
    assert rocket is not None
    found = disperse(replica(), rows(replica(), rocket, 1000, 3), 30.0)
    low, median, high = found.bands["height"]
    assert np.all((low <= median) & (median <= high))
    assert found.time[-1] <= found.spreads()["time_to_apogee"].ci95[0]
