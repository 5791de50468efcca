"""``hfa simulate`` and ``hfa design`` as users and scripts hold on to them."""

from __future__ import annotations

import csv
import itertools
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from tests.cli.run import Run

MAELSTROM = Path(__file__).parents[2] / "engines" / "maelstrom.toml"


COMMANDS = ("simulate", "design")

KEYS = {
    "simulate": (
        "burn_time total_impulse specific_impulse peak_chamber_temperature peak_chamber_pressure peak_thrust "
        "average_thrust liquid_depletion_time residual_oxidizer_mass wet_mass pad_thrust_to_weight tank_length "
        "dip_tube_length tank_volume flight"
    ),
    "design": (
        "burn_time oxidizer_mass fuel_mass of_ratio chamber_temperature thrust throat_radius exit_radius "
        "total_impulse specific_impulse pad_thrust_to_weight apogee optimum"
    ),
}
FLIGHT = (
    "apogee time_to_apogee rail_departure_velocity peak_velocity peak_mach peak_acceleration pad_thrust_to_weight "
    "wet_mass terminal_velocity_drogue terminal_velocity_main impact_velocity_ballistic"
)


def changed(folder: Path, *changes: tuple[str, str]) -> Path:
    """maelstrom.toml with lines replaced."""
    text = MAELSTROM.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "engine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def without_rocket(folder: Path) -> Path:
    """The engine alone on a stand, with no target apogee."""
    text = MAELSTROM.read_text(encoding="utf-8")
    start, end = text.index("[rocket]"), text.index("[design]")
    path = folder / "stand.toml"
    path.write_text(text[:start] + text[end:].replace('target_apogee = "3048 m"', ""), encoding="utf-8")
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_json_has_the_agreed_keys_and_nothing_else_is_printed(run: Run, command: str) -> None:
    status, out, err = run(command, MAELSTROM, "--json")
    product = json.loads(out)
    assert (status, err) == (0, "")
    assert set(KEYS[command].split()) <= set(product)
    assert product["engine"] == "maelstrom"
    assert product["oxidizer_enthalpy"]["of"].startswith("PROPEP")
    if command == "simulate":
        assert set(FLIGHT.split()) <= set(product["flight"])


@pytest.mark.parametrize("command", COMMANDS)
def test_people_get_a_table(run: Run, command: str) -> None:
    status, out, _ = run(command, MAELSTROM)
    assert status == 0
    for words in ("maelstrom", "conventions: report", "burn time", "apogee", "specific impulse", "PROPEP"):
        assert words in out


@pytest.mark.parametrize("command", COMMANDS)
def test_an_engine_without_a_rocket_says_what_is_lacking(run: Run, command: str, tmp_path: Path) -> None:
    status, out, _ = run(command, without_rocket(tmp_path), "--json")
    product = json.loads(out)
    apogee = product["flight"]["apogee"] if command == "simulate" else product["apogee"]
    assert status == 0
    assert apogee == {"value": None, "reason": "no [rocket] is given"}
    assert product["total_impulse"]["value"] > 16_000.0
    assert "no [rocket] is given" in run(command, tmp_path / "stand.toml")[1]


def test_thrust_on_the_stand_is_that_of_the_launch_site(run: Run, tmp_path: Path) -> None:
    flown = json.loads(run("simulate", MAELSTROM, "--json")[1])["peak_thrust"]["value"]
    stand = json.loads(run("simulate", without_rocket(tmp_path), "--json")[1])["peak_thrust"]["value"]
    assert stand == pytest.approx(flown, rel=1e-4)


def test_a_quadratic_feed_loss_and_a_number_for_the_exponent(run: Run, tmp_path: Path) -> None:
    def impulse(*changes: tuple[str, str]) -> float:
        product = json.loads(run("simulate", changed(tmp_path, *changes), "--json")[1])
        return float(product["total_impulse"]["value"])

    as_stated = impulse(('id = "maelstrom"', 'id = "other"'))
    lossless = impulse(('p_loss = "0.345 bar"', 'K_loss = "0 1/m^4"'))
    lossy = impulse(('p_loss = "0.345 bar"', 'K_loss = "6.4e8 1/m^4"'))
    assert lossy < as_stated
    assert lossless != as_stated
    assert impulse(('polytropic_exponent = "c_p/c_v"', "polytropic_exponent = 1.0")) != as_stated


BAD = [
    ("simulate", ('hole_area = "3.79 mm^2"', ""), ("injector", "'hole_area (or hole_diameter)'", "hfa simulate")),
    ("simulate", ("C_i = 1.0", ""), ("injector", "'C_i'", "hfa simulate")),
    ("simulate", ("C_i = 1.0", "C_i = 0.0"), ("injector.C_i", "more than zero")),
    ("simulate", ('p_loss = "0.345 bar"', ""), ("feed", "'p_loss (or K_loss)'", "hfa simulate")),
    ("simulate", ('p_loss = "0.345 bar"', 'p_loss = "60 bar"'), ("tank.temperature", "nothing flows")),
    ("simulate", ("ullage = 0.20 ", 'ullage = 0.2\nlength = "838 mm" '), ("tank", "'length'", "'ullage'")),
    ("simulate", ("ullage = 0.20 ", 'length = "100 mm" '), ("tank", "no saturated tank")),
    ("simulate", ("ullage = 0.20 ", 'volume = "8 L" '), ("tank.oxidizer_mass", "8 L")),
    ("simulate", ("ullage = 0.20 ", 'volume = "900 L" '), ("tank.oxidizer_mass", "900 L")),
    ("simulate", ('temperature = "25 degC"', 'temperature = "50 degC"'), ("tank.temperature", "323.15 K")),
    ("simulate", ('throat_radius = "23.3 mm"', 'throat_radius = "50 mm"'), ("nozzle.exit_radius", "throat")),
    ("simulate", ("a = 1.32e-4", ""), ("grain", "'a'", "hfa simulate")),
    ("simulate", ("[engine]", "[engin]"), ("engin", "did you mean 'engine'")),
    ("simulate", ("holes = 10", 'holes = "ten"'), ("injector.holes", "whole number")),
    ("simulate", ("schema = 1", "schema = 2"), ("schema", "1")),
    ("design", ('oxidizer_flow = "2.50 kg/s"', ""), ("design", "'oxidizer_flow'", "hfa design")),
    ("design", ('chamber_pressure = "27.579 bar"', 'chamber_pressure = "0.8 bar"'), ("design.chamber_pressure", "0.8")),
    ("design", ('target_apogee = "3048 m"', 'target_apogee = "9 km"'), ("design", "9000 m", "full")),
    (
        "design",
        ('throat_radius = "23.3 mm"\nexit_radius = "38.1 mm"', 'exit_radius = "20 mm"'),
        ("design", "exit radius", "throat"),
    ),
    ("design", ("drag_coefficient = 0.529", ""), ("design.target_apogee", "rocket.drag_coefficient")),
]


@pytest.mark.parametrize(("command", "change", "words"), BAD, ids=lambda item: str(item)[:40])
def test_a_bad_engine_file_ends_with_one_plain_message(
    run: Run, tmp_path: Path, command: str, change: tuple[str, str], words: tuple[str, ...]
) -> None:
    path = changed(tmp_path, change)
    status, out, err = run(command, path)
    assert (status, out) == (2, "")
    assert err.startswith(f"hfa: {path}")
    assert err.count("\n") == 1
    assert [word for word in words if word not in err] == [], err


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_that_is_not_there(run: Run, tmp_path: Path, command: str) -> None:
    status, _, err = run(command, tmp_path / "none.toml")
    assert status == 2
    assert "none.toml" in err


@pytest.mark.parametrize("command", COMMANDS)
def test_an_output_folder_that_is_a_file(run: Run, tmp_path: Path, command: str) -> None:
    (tmp_path / "taken").write_text("")
    status, out, err = run(command, MAELSTROM, "--out", tmp_path / "taken")
    assert (status, out) == (2, "")
    assert "taken" in err


def test_a_rocket_that_turns_with_fuel_left_has_an_apogee(run: Run, tmp_path: Path) -> None:
    product = json.loads(run("simulate", changed(tmp_path, ("a = 1.32e-4", "a = 1.0e-4")), "--json")[1])
    assert product["burn_time"]["value"] is None
    assert 2500.0 < product["flight"]["apogee"]["value"] < 3300.0
    assert 23.0 < product["flight"]["time_to_apogee"]["value"] < 27.0


def test_a_grain_too_large_for_the_model_still_gives_what_can_be_had(run: Run, tmp_path: Path) -> None:
    """A fuel that hardly burns is not gone when the run ends: no burn time, and the reason."""
    status, out, err = run("simulate", changed(tmp_path, ("a = 1.32e-4", "a = 1e-6")), "--json")
    product = json.loads(out)
    assert status == 0
    assert "fuel is not gone" in product["burn_time"]["reason"]
    assert product["flight"]["peak_velocity"]["value"] > 0.0
    assert product["warnings"]
    assert err.startswith("hfa: warning: ")


def test_a_rocket_that_is_too_heavy_has_no_flight_but_an_engine(run: Run, tmp_path: Path) -> None:
    path = changed(tmp_path, ('dry_mass = "52.5 kg"', 'dry_mass = "2000 kg"'))
    status, out, _ = run("simulate", path, "--json")
    product = json.loads(out)
    assert status == 0
    assert "does not leave its pad" in product["flight"]["apogee"]["reason"]
    assert product["pad_thrust_to_weight"]["value"] > 0.0
    assert product["total_impulse"]["value"] > 0.0


def test_simulate_writes_histories_and_plots(run: Run, tmp_path: Path) -> None:
    out = run("simulate", MAELSTROM, "--json", "--out", tmp_path)[1]
    assert (tmp_path / "simulate.json").read_text() == out
    with (tmp_path / "histories.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    times = [float(row["time [s]"]) for row in rows]
    assert times == sorted(times)
    assert times[-1] == json.loads(out)["burn_time"]["value"]
    assert float(rows[-1]["impulse [N s]"]) == json.loads(out)["total_impulse"]["value"]
    assert max(float(row["chamber_temperature [K]"]) for row in rows) < 3000.0
    for name in ("pressures.svg", "thrust.svg"):
        assert ET.parse(tmp_path / name).getroot().tag.endswith("svg")


def test_design_writes_the_study_and_an_engine_file(run: Run, tmp_path: Path) -> None:
    out = run("design", MAELSTROM, "--json", "--out", tmp_path)[1]
    assert (tmp_path / "design.json").read_text() == out
    assert len(list(tmp_path.glob("*.svg"))) == 5
    for plot in tmp_path.glob("*.svg"):
        assert ET.parse(plot).getroot().tag.endswith("svg")
    for name, rows in (("study_flow_length.csv", 39), ("study_mixture.csv", 324)):
        assert len((tmp_path / name).read_text().splitlines()) == rows + 1


def test_the_engine_file_keeps_the_impulse(run: Run, tmp_path: Path) -> None:
    product = json.loads(run("design", MAELSTROM, "--json", "--out", tmp_path)[1])
    lines = [line for line in (tmp_path / "maelstrom.eng").read_text().splitlines() if not line.startswith(";")]
    name, diameter, _, _, propellant, total, _ = lines[0].split()
    points = [(0.0, 0.0), *((float(t), float(f)) for t, f in (line.split() for line in lines[1:]))]
    area = sum(0.5 * (f + g) * (u - t) for (t, f), (u, g) in itertools.pairwise(points))
    assert (name, diameter) == ("maelstrom", "128.2")
    assert float(propellant) == pytest.approx(
        product["oxidizer_mass"]["value"] + product["fuel_mass"]["value"], abs=1e-4
    )
    assert float(total) >= float(propellant)
    assert all(u > t for (t, _), (u, _) in itertools.pairwise(points))
    assert points[-1][1] == 0.0
    assert area == pytest.approx(product["total_impulse"]["value"], rel=1e-6)


def test_products_are_the_same_from_run_to_run(run: Run, tmp_path: Path) -> None:
    for command in COMMANDS:
        for name in ("one", "two"):
            run(command, MAELSTROM, "-q", "--out", tmp_path / name / command)
    files = [path.relative_to(tmp_path / "one") for path in (tmp_path / "one").rglob("*.*")]
    assert len(files) == 24
    assert all((tmp_path / "one" / f).read_bytes() == (tmp_path / "two" / f).read_bytes() for f in files)


def test_a_stand_runs_on_through_cold_gas_where_asked(run: Run, tmp_path: Path) -> None:
    engine = without_rocket(tmp_path)
    (short, on) = (json.loads(run("simulate", engine, "--json", *more)[1]) for more in ((), ("--until", "12")))
    assert on["burn_time"] == short["burn_time"]
    assert on["residual_oxidizer_mass"]["value"] < 0.5 * short["residual_oxidizer_mass"]["value"]
    assert on["total_impulse"]["value"] > short["total_impulse"]["value"]


def test_seconds_that_are_none_are_refused(run: Run) -> None:
    status, _, err = run("simulate", MAELSTROM, "--until", "-3")
    assert status == 2
    assert "--until -3: expected seconds" in err
