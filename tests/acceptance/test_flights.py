"""Flights of the replicas beside the report's table, and of Halcyon beside its altimeter.

The replicas' thrust curves are not the report's (raw_tests/README.md); docs/flight.md explains the differences.
Halcyon's data are not in the repository.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import pytest
from tests.cli.shaped import GEOMETRY

from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.motor import problems
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).resolve().parents[2]
HALCYON = Path(
    os.environ.get("HFA_REAL_TESTS", Path(__file__).parents[3] / "shared" / "real_tests")
) / "HALCYON-flight"  # fmt: skip

REPORT = {"HF4": (1190.0, 18.1, 99.4), "HF5": (2444.0, 20.5, 166.0)}
"""Apogee [m], rail departure and peak velocity [m/s] of the report's table."""


FLIGHTS = 300
"""With inputs drawn: enough for a band; a test of a band's ends is elsewhere."""


def flown(root: Path, name: str, **settings: Any) -> tuple[dict[str, Any], Path]:
    """flight.json of a test and the folder it is in."""
    named = {key.replace("__", "."): value for key, value in {"flight__flights": FLIGHTS, **settings}.items()}
    out = run_to("flight", open_test(root, name, settings=named)).out
    return json.loads((out / "flight.json").read_text()), out


@pytest.fixture(scope="module")
def replicas(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    root = tmp_path_factory.mktemp("flights")
    shutil.copytree(ROOT / "raw_tests", root / "raw_tests")
    raw = {name: flown(root, name, flight__raw_thrust=True)[0] for name in REPORT}
    return {"raw": raw, "root": root, **{name: flown(root, name) for name in REPORT}}


def test_raw_thrust_flies_as_high_as_the_report_s_where_the_impulse_is_the_report_s(replicas: dict[str, Any]) -> None:
    """HF5 within 2 %; HF4's replica spreads its impulse otherwise over the burn and comes 9 to 10 % higher."""
    apogee = {name: replicas["raw"][name]["apogee"]["value"] for name in REPORT}
    assert apogee["HF5"] == pytest.approx(REPORT["HF5"][0], rel=0.02)
    assert 1.05 < apogee["HF4"] / REPORT["HF4"][0] < 1.15


@pytest.mark.parametrize("name", REPORT)
def test_lower_peaks_leave_the_rail_slower_than_the_report_s(replicas: dict[str, Any], name: str) -> None:
    speed = replicas["raw"][name]["rail_departure_velocity"]["value"]
    assert 0.80 < speed / REPORT[name][1] < 1.0


@pytest.mark.parametrize("name", REPORT)
def test_thin_air_adds_thrust(replicas: dict[str, Any], name: str) -> None:
    for quantity in ("apogee", "rail_departure_velocity", "peak_velocity"):
        assert replicas[name][0][quantity]["value"] > replicas["raw"][name][quantity]["value"]
    assert replicas["raw"][name]["thrust"] == "as measured on the stand"


@pytest.mark.parametrize("name", REPORT)
def test_the_rail_is_left_too_slowly_as_the_report_says(replicas: dict[str, Any], name: str) -> None:
    assert replicas[name][0]["checks"]["rail_departure_velocity"]["result"] == "failed"


@pytest.mark.parametrize(("name", "apogee"), [("HF4", 1491.2), ("HF5", 2821.8)])
def test_the_stand_s_nitrogen_lifts_nothing(replicas: dict[str, Any], name: str, apogee: float) -> None:
    """The thrust with it in flies as before; without it lower, but higher than the stand's raw thrust."""
    product, raw = replicas[name][0], replicas["raw"][name]
    assert (product["thrust_basis"], raw["thrust_basis"]) == ("without purge gas", "as measured")
    assert product["apogee_as_measured"]["value"] == pytest.approx(apogee, abs=0.5)
    assert raw["apogee"]["value"] < product["apogee"]["value"] < apogee - 30.0
    assert any("one-dimensional law of the nozzle: as the log has it" in note for note in product["notes"])


@pytest.mark.parametrize("name", REPORT)
def test_every_quantity_of_the_contract_is_there(replicas: dict[str, Any], name: str) -> None:
    product = replicas[name][0]
    for quantity in ("apogee", "time_to_apogee", "rail_departure_velocity", "peak_velocity", "peak_mach",
                     "peak_acceleration", "pad_thrust_to_weight", "wet_mass", "terminal_velocity_drogue",
                     "terminal_velocity_main", "impact_velocity_ballistic"):  # fmt: skip
        assert product[quantity]["value"] > 0.0
    low, high = product["apogee"]["ci95"]
    assert low < product["apogee"]["value"] < high
    assert product["source"] == "replica"


@pytest.mark.parametrize("name", REPORT)
def test_the_engine_files_keep_the_rules_and_the_impulse(replicas: dict[str, Any], name: str) -> None:
    product, out = replicas[name]
    impulse = product["impulse_flown"]["value"]
    eng = rasp.read((out / f"{name}.eng").read_text())
    rse = rocksim.read((out / f"{name}.rse").read_text())
    for points in (eng[1], rse[1]):
        assert problems(points) == []
        assert points.impulse == pytest.approx(impulse, rel=1e-3)
    assert "REPLICA" in eng[2][0]
    assert rse[1].mass is not None
    assert rse[1].mass[0] == pytest.approx(eng[0].propellant_mass, abs=1e-3)


@pytest.mark.parametrize("name", REPORT)
def test_products_are_the_same_from_run_to_run(replicas: dict[str, Any], name: str) -> None:
    names = ("flight.json", "flight.h5", f"{name}.eng", f"{name}.rse", f"{name}_rocketpy.py")
    out = replicas[name][1]
    first = {file: (out / file).read_bytes() for file in names}
    context = open_test(replicas["root"], name, settings={"flight.flights": FLIGHTS})
    for file in names:
        (out / file).unlink()
    run_to("flight", context)
    assert {file: (out / file).read_bytes() for file in names} == first


TOML = """\
schema = 1
[test]
id = "HALCYON"
kind = "hot_fire"
[log]
files = ["log.csv"]
time = { column = "time", unit = "s" }
[channels.thrust]
column = "thrust"
unit = "N"
tare = "none"
[segments]
t_open = "0 s"
[tank]
oxidizer_mass = "4.2 kg"
[grain]
mass = "1.2 kg"
[rocket]
dry_mass = "25.283 kg"
drag_table = "drag.csv"
diameter = "152.4 mm"
launch_angle = "5 deg"
rail_length = "12 m"
launch_altitude = "130 m"
"""
"""As published: rocket 14.613 kg and motor 10.670 kg, empty; 85 degrees over the horizon."""


@pytest.fixture(scope="module")
def halcyon(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    if not HALCYON.is_dir():
        pytest.skip(f"no {HALCYON}")
    root = tmp_path_factory.mktemp("halcyon")
    folder = root / "raw_tests" / "HALCYON"
    folder.mkdir(parents=True)
    _, points, _ = rasp.read((HALCYON / "engine_Halcyon_4thHotfire.eng").read_text())
    pd.DataFrame({"time": points.time, "thrust": points.thrust}).to_csv(folder / "log.csv", index=False)
    (folder / "drag.csv").write_bytes((HALCYON / "DragCoeffOR_off.csv").read_bytes())
    (folder / "test.toml").write_text(TOML)
    return flown(root, "HALCYON")


def test_thrust_of_a_hot_fire_predicts_halcyon_s_apogee(halcyon: tuple[dict[str, Any], Path]) -> None:
    """3450 m officially; within 5 %, and the band covers it."""
    apogee = halcyon[0]["apogee"]
    assert apogee["value"] == pytest.approx(3450.0, rel=0.05)
    assert apogee["ci95"][0] < 3450.0 < apogee["ci95"][1]


def test_halcyon_s_altitude_follows_its_altimeter(halcyon: tuple[dict[str, Any], Path]) -> None:
    """Within 5 % of the apogee all the way up, the clocks set by the first 30 m."""
    log = pd.read_csv(HALCYON / "altimeter_halcyon.csv")
    with h5py.File(halcyon[1] / "flight.h5") as file:
        time, height = file["ascent/time"][:], file["ascent/height"][:]
    measured, clock = log["filtered_altitude_AGL"].to_numpy(), log["ts"].to_numpy()
    late = clock[np.argmax(measured > 30.0)] - time[np.argmax(height > 30.0)]
    at = np.arange(1.0, 27.0, 0.5)
    difference = np.interp(at, time, height) - np.interp(at + late, clock, measured)
    assert np.abs(difference).max() < 0.05 * 3450.0


@pytest.fixture(scope="module")
def shaped(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    """HF5 in a rocket whose geometry is known and whose drag is not."""
    root = tmp_path_factory.mktemp("shaped")
    folder = root / "raw_tests" / "HF5"
    shutil.copytree(ROOT / "raw_tests" / "HF5", folder)
    text = (folder / "test.toml").read_text().replace("drag_coefficient = 0.529\n", "", 1)
    volume = 'volume = "16.5 L"\n'
    text = text.replace(volume, f'{volume}inner_diameter = "128.194 mm"\n')
    (folder / "test.toml").write_text(text + GEOMETRY)
    return flown(root, "HF5")


def test_a_geometry_stands_in_for_a_drag_coefficient(shaped: tuple[dict[str, Any], Path]) -> None:
    assert shaped[0]["drag"] == "built up from the geometry"
    assert shaped[0]["apogee"]["value"] > 2000.0


def test_the_margin_is_least_at_the_rail_s_end_and_in_the_strongest_wind(shaped: tuple[dict[str, Any], Path]) -> None:
    winds = shaped[0]["stability"]["winds"]
    at_rail = [wind["departure"]["mean"] for wind in winds]
    assert at_rail == sorted(at_rail, reverse=True)
    assert all(wind["least"] < wind["departure"]["mean"] < wind["largest"] for wind in winds)
    assert shaped[0]["checks"]["least_static_margin"]["result"] == "passed"
    assert shaped[0]["checks"]["largest_static_margin"]["result"] == "failed"


def test_the_center_of_gravity_moves_ahead_as_the_tank_empties(shaped: tuple[dict[str, Any], Path]) -> None:
    """By hand: structure, engine and what is loaded, about the nose tip."""
    with h5py.File(shaped[1] / "flight.h5") as file:
        center, mass = file["balance/center_of_gravity"][:], file["balance/mass"][:]
    assert mass[0] == pytest.approx(52.5 + 8.35 + 1.594, abs=0.02)
    assert center[0] == pytest.approx((40.0 * 1.75 + 12.5 * 3.1 + 8.35 * 2.87 + 1.594 * 3.75) / mass[0], abs=0.02)
    rest = mass[-1] - 52.5  # of vapor and fuel, 1.7 m behind the rocket's center at most
    assert 0.0 <= rest < 0.5
    assert center[-1] == pytest.approx((40.0 * 1.75 + 12.5 * 3.1) / 52.5, abs=1e-3 + 1.7 * rest / mass[-1])


def test_the_rocksim_file_carries_the_engine_s_center_of_gravity(shaped: tuple[dict[str, Any], Path]) -> None:
    motor, points, _, _ = rocksim.read((shaped[1] / "HF5.rse").read_text())
    assert motor.total_mass == pytest.approx(12.5 + 9.944, abs=1e-3)
    assert points.center is not None
    assert points.mass is not None
    left = points.mass[-1] / (12.5 + points.mass[-1])  # in tank and grain, 0.7 m from the empty engine's center at most
    assert points.center[-1] == pytest.approx(3.1 - 2.1, abs=1e-3 + 0.7 * left)
    assert points.center[0] != pytest.approx(points.center[-1], abs=0.02)


def test_without_a_geometry_stability_says_what_is_missing(replicas: dict[str, Any]) -> None:
    assert "[rocket.geometry]" in replicas["HF5"][0]["stability"]["margin_at_rail_departure"]["reason"]
