"""``hfa simulate`` goes to the ground: flight, margin in winds, engine files, and a page that shows them."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from tests.cli.run import Run, hfa
from tests.cli.shaped import GEOMETRY, MAELSTROM, engine

from hfanalysis.flight import rasp, rocksim

PUBLISHED = MAELSTROM.with_suffix(".published.toml")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What ``--out`` has of it."""
    folder = tmp_path_factory.mktemp("engine")
    (folder / "engine.published.toml").write_bytes(PUBLISHED.read_bytes())
    assert hfa("simulate", engine(folder), "--out", folder / "out", "--quiet").status == 0
    return folder / "out"


def product(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "simulate.json").read_text())
    return found


def table(path: Path) -> dict[str, list[str]]:
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    return {name: [row[name] for row in rows] for name in rows[0]}


def test_the_flight_s_table_goes_up_and_down_to_the_ground(written: Path) -> None:
    found, flight = table(written / "flight.csv"), product(written)["flight"]
    parts = np.array(found["part"])
    assert list(dict.fromkeys(parts)) == ["ascent", "drogue", "main", "ballistic"]
    height, speed = (np.array(found[name], dtype=float) for name in ("height [m]", "speed [m/s]"))
    assert height.max() == pytest.approx(flight["apogee"]["value"])
    for last in ("main", "ballistic"):
        assert height[parts == last][-1] == pytest.approx(0.0, abs=1e-3)
    assert -speed[parts == "main"][-1] == pytest.approx(flight["terminal_velocity_main"]["value"])
    assert -speed[parts == "ballistic"][-1] == pytest.approx(flight["impact_velocity_ballistic"]["value"])
    mach = np.array([float(cell) for cell in found["mach [1]"] if cell])
    assert mach.max() == pytest.approx(flight["peak_mach"]["value"])
    with h5py.File(written / "flight.h5") as file:
        assert {"ascent", "drogue", "main", "ballistic", "balance", "stability"} <= set(file)
        assert file["ascent"]["oxidizer_mass"][-1] == pytest.approx(product(written)["residual_oxidizer_mass"]["value"])


def test_histories_have_balance_flux_and_rate(written: Path) -> None:
    found = {name: np.array(cells, dtype=float) for name, cells in table(written / "histories.csv").items()}
    radius, time = found["port_radius [m]"], found["time [s]"]
    grown = np.trapezoid(found["regression_rate [m/s]"], time)
    assert grown == pytest.approx(radius[-1] - radius[0], rel=5e-3)
    flux = found["oxidizer_flow [kg/s]"] / (np.pi * radius**2)
    assert found["oxidizer_flux [kg/m^2/s]"] == pytest.approx(flux)
    stability = product(written)["flight"]["stability"]
    center = found["center_of_gravity [m]"]
    assert center[0] == pytest.approx(stability["center_of_gravity_loaded"]["value"])
    assert center[-1] == pytest.approx(stability["center_of_gravity_empty"]["value"])


def test_a_warmer_day_gives_more_pressure_and_thrust(written: Path) -> None:
    found = {name: np.array(cells, dtype=float) for name, cells in table(written / "temperature.csv").items()}
    warm = found["temperature [degC]"]
    assert (warm[0], warm[-1]) == (5.0, 35.0)
    fits = warm < 31.0  # beyond, its load fills the tank with liquid
    for name in ("peak_thrust [N]", "peak_chamber_pressure [Pa]"):
        assert (np.diff(found[name][fits]) > 0.0).all()
        assert np.isnan(found[name][~fits]).all()
    stated = product(written)
    for name, unit in (("total_impulse", "N s"), ("burn_time", "s")):
        assert np.interp(25.0, warm, found[f"{name} [{unit}]"]) == pytest.approx(stated[name]["value"], rel=1e-9)
    assert np.interp(25.0, warm, found["apogee [m]"]) == pytest.approx(stated["flight"]["apogee"]["value"], rel=1e-6)


def test_the_margin_is_told_in_the_report_s_winds_and_in_the_launch_s_own(tmp_path: Path, run: Run) -> None:
    path = engine(tmp_path, GEOMETRY, ('rail_length = "6.05 m"', 'rail_length = "6.05 m"\nwind_speed = "9 m/s"'))
    flight = json.loads(run("simulate", path, "--json")[1])["flight"]
    assert [wind["wind"] for wind in flight["stability"]["winds"]] == [2.235, 4.47, 6.706, 9.0]
    departures = [wind["departure"]["mean"] for wind in flight["stability"]["winds"]]
    assert departures == sorted(departures, reverse=True)  # the angle of attack brings the body's lift forward
    assert flight["checks"]["largest_static_margin"]["result"] == "failed"


@pytest.mark.parametrize(("span", "drawn"), [("0.16 m", "comes up to"), ("0.06 m", "comes down to"), ("0.09 m", "")])
def test_a_margin_beyond_its_limits_is_warned_of(span: str, drawn: str, tmp_path: Path, run: Run) -> None:
    path = engine(tmp_path, GEOMETRY.replace('span = "0.16 m"', f'span = "{span}"'))
    beyond = {one["name"]: one["text"] for one in json.loads(run("simulate", path, "--json")[1])["beyond"]}
    assert (drawn in beyond["static_margin"]) if drawn else ("static_margin" not in beyond)


def test_without_a_geometry_the_margin_says_what_is_lacking(run: Run) -> None:
    flight = json.loads(run("simulate", MAELSTROM, "--json")[1])["flight"]
    assert flight["stability"]["margin_at_rail_departure"]["reason"] == "no [rocket.geometry] is given"
    assert flight["checks"]["least_static_margin"]["result"] == "unknown"


def test_engine_files_hold_the_simulated_impulse_and_the_engine_s_center(written: Path) -> None:
    impulse = product(written)["total_impulse"]["value"]
    motor, points, comments = rasp.read((written / "maelstrom.eng").read_text())
    assert points.impulse == pytest.approx(impulse, rel=1e-3)
    assert motor.propellant_mass == pytest.approx(8.674, rel=1e-3)
    assert motor.total_mass == pytest.approx(12.5 + 8.674, rel=1e-3)
    assert "SIMULATED" in comments[0]
    _, static, said = rasp.read((written / "maelstrom_static.eng").read_text())
    assert 0.985 * points.impulse < static.impulse < points.impulse  # the air is thicker on the stand
    assert any("as on a stand" in line for line in said)
    _, curve, _, _ = rocksim.read((written / "maelstrom.rse").read_text())
    assert curve.center is not None
    assert curve.center[0] < curve.center[-1]  # tank empties first, the empty engine's center lies behind it
    assert "GivenMotor" in (written / "maelstrom_rocketpy.py").read_text()


def test_an_engine_on_its_stand_has_its_static_curve_alone(tmp_path: Path, run: Run) -> None:
    text = MAELSTROM.read_text(encoding="utf-8")
    path = tmp_path / "stand.toml"
    path.write_text(text[: text.index("[rocket]")].replace('id = "maelstrom"', 'id = "on its stand"'), encoding="utf-8")
    status, _, _ = run("simulate", path, "--out", tmp_path / "out")
    assert status == 0
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert "on-its-stand_static.eng" in names
    assert not {name for name in names if name.endswith((".rse", ".h5")) or name == "on-its-stand.eng"}
    page = (tmp_path / "out" / "on-its-stand.html").read_text(encoding="utf-8")
    assert "No flight: no [rocket] is given" in page.replace("<code>", "").replace("</code>", "")


CHARTS = (
    "thrust pressures mixture flows temperatures gas regression port flux tank-mass balance flight-height flight-speed "
    "flight-acceleration flight-mach flight-drag flight-margin specific_impulse_flow_length thrust_flow_length "
    "exit_radius_flow_length specific_impulse_ideal_flow_length specific_impulse_mixture temperature"
)


def test_the_page_has_every_curve_of_the_report_and_what_it_printed(written: Path) -> None:
    page = (written / "maelstrom.html").read_text(encoding="utf-8")
    assert set(re.findall(r'data-chart="([^"]+)"', page)) == set(CHARTS.split())
    text = re.sub(r"<[^>]+>", "|", page)
    for stated in ("16845 N s", "27.6 bar", "34.0 m/s", "6111 g", "3.79e-5 m^2"):
        assert f"|{stated}|" in text
    assert "SIMULATED, not measured" in page
    assert not re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', page)  # it asks for nothing


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ('burn_tme = "3.34 s"', "simulate: unknown key 'burn_tme'; did you mean 'burn_time'"),
        ('burn_time = "3.34 kg"', "maelstrom.published.toml, simulate.burn_time"),
    ],
)
def test_what_is_published_of_what_is_no_number_of_it_is_refused(new: str, said: str, tmp_path: Path, run: Run) -> None:
    for file in (MAELSTROM, PUBLISHED):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    beside = tmp_path / PUBLISHED.name
    beside.write_text(beside.read_text(encoding="utf-8").replace('burn_time = "3.34 s"', new), encoding="utf-8")
    status, _, err = run("simulate", tmp_path / MAELSTROM.name, "--out", tmp_path / "out")
    assert status == 2
    assert said in err
