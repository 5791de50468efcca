"""Warnings that an engineer would give, from ``hfa design`` and ``hfa simulate``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from tests.cli.run import Run
from tests.cli.test_engines import MAELSTROM, changed

OF_THE_REPORT = {"simulate": {"oxidizer_flux", "of_ratio", "tank_below_triple_point"}, "design": {"oxidizer_flux"}}
"""What the report's own engine draws: a flux of 1100 kg/(m^2 s), O/F 3.9 once liquid and vapor are burnt, 167 K."""

SIMULATED = [
    ("injector_stiffness", ("holes = 10", "holes = 30")),
    ("rail_speed", ('rail_length = "6.05 m"', 'rail_length = "2 m"')),
    ("thrust_to_weight", ('dry_mass = "52.5 kg"', 'dry_mass = "150 kg"')),
    ("nozzle_separation", ('exit_radius = "38.1 mm"', 'exit_radius = "90 mm"')),
    ("oxidizer_left", ("a = 1.32e-4", "a = 2.5e-4")),
]
"""A warning, and what draws it from a burn of the report's engine."""

DESIGNED = [
    ("chamber_above_tank", ('chamber_pressure = "27.579 bar"', 'chamber_pressure = "70 bar"')),
    ("injector_stiffness", ('chamber_pressure = "27.579 bar"', 'chamber_pressure = "50 bar"')),
    ("rail_speed", ('rail_length = "6.05 m"', 'rail_length = "2 m"')),
    ("thrust_to_weight", ('oxidizer_flow = "2.50 kg/s"', 'oxidizer_flow = "0.9 kg/s"')),
    (
        "nozzle_separation",
        ('throat_radius = "23.3 mm"\nexit_radius = "38.1 mm"', 'exit_radius = "90 mm"'),
    ),
    ("of_ratio", ("a = 1.32e-4", "a = 1.9e-4")),
]
"""A warning, and what draws it from the report's design."""


def drawn(run: Run, command: str, path: Path) -> dict[str, Any]:
    """The warnings of a product, by name."""
    status, out, err = run(command, path, "--json")
    assert (status, err) == (0, "")
    return {caution["name"]: caution for caution in json.loads(out)["beyond"]}


@pytest.mark.parametrize("command", OF_THE_REPORT)
def test_the_report_s_engine_draws_what_it_should_and_no_more(run: Run, command: str) -> None:
    assert set(drawn(run, command, MAELSTROM)) == OF_THE_REPORT[command]


@pytest.mark.parametrize(
    ("command", "name", "change"),
    [*(("simulate", *case) for case in SIMULATED), *(("design", *case) for case in DESIGNED)],
    ids=lambda item: str(item)[:30],
)
def test_a_changed_engine_draws_it(run: Run, tmp_path: Path, command: str, name: str, change: tuple[str, str]) -> None:
    assert name in drawn(run, command, changed(tmp_path, change))


def test_a_chamber_above_its_tank_is_told_once(run: Run, tmp_path: Path) -> None:
    found = drawn(run, "design", changed(tmp_path, DESIGNED[0][1]))
    assert found["chamber_above_tank"]["value"]["value"] == 70e5
    assert found["chamber_above_tank"]["limit"] == pytest.approx(57.29e5 - 0.345e5, rel=1e-3)
    assert "injector_stiffness" not in found


def test_an_injector_that_holds_nothing_back_lets_gas_flow_back(run: Run, tmp_path: Path) -> None:
    wide = changed(tmp_path, ("holes = 10", "holes = 400"), ('throat_radius = "23.3 mm"', 'throat_radius = "12 mm"'))
    found = drawn(run, "simulate", wide)
    assert found["reversed_flow"]["value"]["value"] < 1000.0
    assert found["injector_stiffness"]["value"]["value"] < 0.001


def test_fuel_that_outlasts_the_liquid_leaves_vapor_and_a_good_mixture_and_no_word_of_them(
    run: Run, tmp_path: Path
) -> None:
    """With an isothermal vapor's exponent nearly, the tank stays above the triple point, too."""
    slower = changed(
        tmp_path,
        ("a = 1.32e-4", "a = 1.2e-4"),
        ('polytropic_exponent = "c_p/c_v"', "polytropic_exponent = 1.02"),
    )
    assert set(drawn(run, "simulate", slower)) == {"oxidizer_flux"}


def test_a_wide_port_has_little_flux(run: Run, tmp_path: Path) -> None:
    wide = changed(tmp_path, ('outer_radius = "39.497 mm"', 'outer_radius = "55 mm"'))
    assert "oxidizer_flux" not in drawn(run, "simulate", wide)


@pytest.mark.parametrize("command", OF_THE_REPORT)
def test_people_read_them_at_the_terminal(run: Run, command: str) -> None:
    status, _, err = run(command, MAELSTROM)
    assert status == 0
    assert err.count("hfa: warning: ") == len(OF_THE_REPORT[command])
    assert "above 700 kg/(m^2 s) (Humble, Henry and Larson" in err
