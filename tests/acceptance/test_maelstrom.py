"""The report's design point through the commands: the certified answers, each as checked independently."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.cli import run

MAELSTROM = Path(__file__).parents[2] / "engines" / "maelstrom.toml"

TIMES = 0.010
"""[s] within which times have to come out."""

APOGEE = 0.003
OTHERS = 0.005
"""Relative, for apogees and for everything else."""


def hfa(*arguments: object) -> dict[str, Any]:
    """The JSON product of a command."""
    ended = run.hfa(*arguments, "--json")
    assert ended.status == 0, ended.err
    product: dict[str, Any] = json.loads(ended.out)
    return product


def varied(folder: Path, *changes: tuple[str, str]) -> Path:
    """The engine file with lines replaced; an empty replacement leaves the line out."""
    text = MAELSTROM.read_text(encoding="utf-8")
    for line, new in changes:
        assert text.count(line) == 1
        text = text.replace(line, new)
    path = folder / "varied.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def simulated() -> dict[str, Any]:
    return hfa("simulate", MAELSTROM)


@pytest.fixture(scope="module")
def designed(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    out = tmp_path_factory.mktemp("design")
    return hfa("design", MAELSTROM, "--out", out), out


SIMULATED = {
    "total_impulse": (16_844.0, "N s"),
    "specific_impulse": (198.0, "s"),
    "peak_chamber_temperature": (2811.0, "K"),
    "peak_chamber_pressure": (27.53e5, "Pa"),
    "peak_thrust": (6750.0, "N"),
    "average_thrust": (5055.0, "N"),
    "residual_oxidizer_mass": (0.6775, "kg"),
    "tank_length": (0.8385, "m"),
    "dip_tube_length": (0.1399, "m"),
    "tank_volume": (10.82e-3, "m^3"),
    "wet_mass": (52.5 + 7.035 + 1.639, "kg"),
}

FLOWN = {
    "peak_velocity": (252.4, "m/s"),
    "peak_mach": (0.758, ""),
    "rail_departure_velocity": (34.8, "m/s"),
    "terminal_velocity_drogue": (23.5, "m/s"),
    "terminal_velocity_main": (6.45, "m/s"),
    "time_to_main": (130.5, "s"),
    "main_deployment_acceleration": (11.7 * 9.80665, "m/s^2"),
    "impact_velocity_ballistic": (213.1, "m/s"),
}

DESIGNED = {
    "oxidizer_mass": (6.102, "kg"),
    "fuel_mass": (1.422, "kg"),
    "of_ratio": (4.290, ""),
    "chamber_temperature": (2666.0, "K"),
    "thrust": (6756.0, "N"),
    "throat_radius": (23.29e-3, "m"),
    "exit_radius": (38.1e-3, "m"),
    "total_impulse": (16_489.0, "N s"),
    "specific_impulse": (223.5, "s"),
    "pad_thrust_to_weight": (11.48, ""),
}


@pytest.mark.parametrize("name", SIMULATED)
def test_the_unsteady_design_point(simulated: dict[str, Any], name: str) -> None:
    value, unit = SIMULATED[name]
    assert simulated[name]["value"] == pytest.approx(value, rel=OTHERS)
    assert simulated[name]["unit"] == unit
    assert simulated[name]["std"] is None


@pytest.mark.parametrize(("name", "time"), [("liquid_depletion_time", 2.660), ("burn_time", 3.332)])
def test_the_times_of_the_burn(simulated: dict[str, Any], name: str, time: float) -> None:
    assert simulated[name]["value"] == pytest.approx(time, abs=TIMES)


@pytest.mark.parametrize("name", FLOWN)
def test_the_flight_of_the_design_point(simulated: dict[str, Any], name: str) -> None:
    value, unit = FLOWN[name]
    assert simulated["flight"][name]["value"] == pytest.approx(value, rel=OTHERS)
    assert simulated["flight"][name]["unit"] == unit


def test_the_apogee_of_the_design_point(simulated: dict[str, Any]) -> None:
    assert simulated["flight"]["apogee"]["value"] == pytest.approx(3053.0, rel=APOGEE)
    assert simulated["flight"]["time_to_apogee"]["value"] == pytest.approx(25.4, abs=0.05)


def test_a_drag_table_flies_as_its_numbers_say(simulated: dict[str, Any], tmp_path: Path) -> None:
    """A table of one number is that number; a rising one costs height, in both models."""
    table = varied(tmp_path, ("drag_coefficient = 0.529", 'drag_table = "drag.csv"'), ('target_apogee = "3048 m"', ""))
    (tmp_path / "drag.csv").write_text("Mach,Cd\n0.1,0.529\n0.9,0.529\n")
    flat, design = hfa("simulate", table), hfa("design", table)
    assert flat["flight"]["apogee"]["value"] == pytest.approx(simulated["flight"]["apogee"]["value"], rel=1e-6)
    assert set(flat["provenance"]["drag_table"]) == {"drag.csv"}
    (tmp_path / "drag.csv").write_text("0.1 0.529\n0.9 0.8\n")
    assert hfa("simulate", table)["flight"]["apogee"]["value"] < 0.97 * flat["flight"]["apogee"]["value"]
    assert hfa("design", table)["apogee"]["value"] < 0.97 * design["apogee"]["value"]


def test_the_propellant_for_the_target_apogee(simulated: dict[str, Any], designed: tuple[dict[str, Any], Path]) -> None:
    needed = simulated["propellant_for_target_apogee"]
    oxidizer, fuel = needed["oxidizer_mass"]["value"], needed["fuel_mass"]["value"]
    assert oxidizer == pytest.approx(7.035, rel=OTHERS)
    assert fuel == pytest.approx(1.639, rel=OTHERS)
    steady = designed[0]["oxidizer_mass"]["value"] + designed[0]["fuel_mass"]["value"]
    assert (oxidizer + fuel) / steady - 1.0 == pytest.approx(0.151, abs=0.002)


def test_both_ways_to_size_the_tank_agree(simulated: dict[str, Any], tmp_path: Path) -> None:
    length = simulated["tank_length"]["value"]
    sized = hfa("simulate", varied(tmp_path, ("ullage = 0.20 ", f'length = "{length} m" ')))
    for name in ("tank_volume", "dip_tube_length", "total_impulse"):
        assert sized[name]["value"] == pytest.approx(simulated[name]["value"], rel=1e-6)
    held = hfa("simulate", varied(tmp_path, ("ullage = 0.20 ", f'volume = "{simulated["tank_volume"]["value"]} m^3" ')))
    for name in ("tank_length", "dip_tube_length", "total_impulse"):
        assert held[name]["value"] == pytest.approx(simulated[name]["value"], rel=1e-6)


@pytest.mark.parametrize("name", DESIGNED)
def test_the_steady_design_point(designed: tuple[dict[str, Any], Path], name: str) -> None:
    value, unit = DESIGNED[name]
    assert designed[0][name]["value"] == pytest.approx(value, rel=OTHERS)
    assert designed[0][name]["unit"] == unit


def test_the_steady_design_reaches_its_target(designed: tuple[dict[str, Any], Path]) -> None:
    assert designed[0]["burn_time"]["value"] == pytest.approx(2.441, abs=TIMES)
    assert designed[0]["apogee"]["value"] == pytest.approx(3048.0, rel=1e-5)
    assert designed[0]["fuel_mass_from"] == "design.target_apogee"


def test_the_best_mixture(designed: tuple[dict[str, Any], Path]) -> None:
    best = designed[0]["optimum"]
    assert best["of_ratio"]["value"] == pytest.approx(6.33, rel=OTHERS)
    assert best["specific_impulse"]["value"] == pytest.approx(237.7, rel=OTHERS)


def test_the_liquid_s_enthalpy_moves_the_best_mixture(tmp_path: Path) -> None:
    """PROPEP's ideal gas makes three seconds too much and moves the optimum from 6.53 to 6.33."""
    corrected = hfa("design", varied(tmp_path, ('conventions = "report"', 'conventions = "corrected"')))
    assert corrected["oxidizer_enthalpy"]["of"] == "saturated liquid at 298.15 K"
    assert corrected["oxidizer_enthalpy"]["value"] * 44.0128 / 1e6 == pytest.approx(71.47, rel=1e-3)
    assert corrected["optimum"]["of_ratio"]["value"] == pytest.approx(6.53, rel=OTHERS)
    assert 237.7 - corrected["optimum"]["specific_impulse"]["value"] == pytest.approx(3.0, abs=0.3)


def test_the_first_design_with_an_ideal_nozzle(tmp_path: Path) -> None:
    first = hfa(
        "design",
        varied(
            tmp_path,
            ('length = "610 mm"', 'length = "813 mm"'),
            ("drag_coefficient = 0.529", "drag_coefficient = 0.75"),
            ('oxidizer_flow = "2.50 kg/s"', 'oxidizer_flow = "2 kg/s"'),
            ('exit_radius = "38.1 mm"\n', ""),
        ),
    )
    assert first["fuel_mass"]["value"] == pytest.approx(2.310, rel=OTHERS)
    assert first["thrust"]["value"] == pytest.approx(5336.0, rel=OTHERS)
    assert first["burn_time"]["value"] == pytest.approx(3.349, abs=TIMES)


def columns(path: Path) -> dict[str, np.ndarray]:
    """The numbers of a table by column."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "reason"}


@pytest.mark.parametrize(("length", "ideal", "fixed"), [(0.4575, 237.6, 233.2), (0.610, None, 223.7)])
def test_the_best_impulse_of_the_study(
    designed: tuple[dict[str, Any], Path], length: float, ideal: float | None, fixed: float
) -> None:
    table = columns(designed[1] / "study_flow_length.csv")
    here = np.isclose(table["grain_length [m]"], length)
    assert table["specific_impulse [s]"][here].max() == pytest.approx(fixed, rel=1e-3)
    if ideal is not None:
        assert table["ideal_specific_impulse [s]"][here].max() == pytest.approx(ideal, rel=1e-3)


def test_the_ideal_exit_passes_the_casing_s_at_one_and_a_half_kilograms(
    designed: tuple[dict[str, Any], Path],
) -> None:
    table = columns(designed[1] / "study_flow_length.csv")
    here = np.isclose(table["grain_length [m]"], 0.610)
    flow = np.interp(38.1e-3, table["ideal_exit_radius [m]"][here], table["oxidizer_flow [kg/s]"][here])
    assert flow == pytest.approx(1.5, abs=0.05)
