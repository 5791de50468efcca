"""A value that is stated without +/- is known as well as its kind usually is, and no better."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from tests.segment.stand import HOLE_AREA, HOLES, definition

from hfanalysis.errors import InputError
from hfanalysis.record.default_deviations import KINDS, OXIDIZER_MASS, TANK_VOLUME, Deviation, Deviations
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.sections import GrainSection, Injector, ObservedSection
from hfanalysis.units import Value

GUIDE = (Path(__file__).parents[2] / "docs" / "test-toml.md").read_text()


def test_without_a_deviation_the_default_of_its_kind() -> None:
    found = definition(volume=Value(0.02), mass=Value(8.0)).known
    assert found("tank.volume") == Value(0.02, TANK_VOLUME.share * 0.02)
    assert found("tank.oxidizer_mass") == Value(8.0, OXIDIZER_MASS.share * 8.0)
    assert found("observed.burn_time") is None


def test_what_is_stated_wins_even_as_exact() -> None:
    found = definition(volume=Value(0.02, 1e-5), mass=Value(8.0, 0.0))
    assert found.known_std("tank.volume") == 1e-5
    assert found.known_std("tank.oxidizer_mass") == 0.0


def test_a_fault_of_the_drill_is_twice_as_large_in_the_area() -> None:
    """Holes of 2 mm, all of them 0.05 mm too wide: 5 %, however many."""
    by_area = definition(injector=Injector(HOLES, Value(HOLE_AREA))).injector_area
    by_diameter = definition(injector=Injector(8, hole_diameter=Value(2e-3))).injector_area
    stated = definition().injector_area
    assert by_area is not None
    assert by_diameter is not None
    assert stated is not None
    assert by_area.std == pytest.approx(2.0 * 0.05e-3 / (4.0 / 3.14159265 * HOLE_AREA) ** 0.5 * by_area.value)
    assert by_diameter.std == pytest.approx(0.05 * by_diameter.value)
    assert stated.std == 0.0


def test_what_is_left_is_known_to_a_share_of_what_there_was() -> None:
    weighed = definition(grain=GrainSection(Value(1.6)), observed=ObservedSection(fuel_mass_after=Value(0.01)))
    assert weighed.known_std("observed.fuel_mass_after") == pytest.approx(0.016)


def test_a_test_may_have_defaults_of_its_own() -> None:
    own = replace(definition(volume=Value(0.02)), deviations=Deviations(tank_volume=Deviation(absolute=1e-4)))
    assert own.known_std("tank.volume") == 1e-4


def read(folder: Path, line: str) -> TestDefinition:
    """HF5's definition with a line in [deviations]."""
    text = (Path(__file__).parents[2] / "raw_tests" / "HF5" / "test.toml").read_text()
    test = folder / "HF5"
    test.mkdir()
    (test / "log.csv").touch()
    (test / "test.toml").write_text(f"{text}\n[deviations]\n{line}\n")
    return load_definition(test / "test.toml")


@pytest.mark.parametrize(("line", "expected"), [('"0.2 %"', 0.002 * 0.0165), ('"0.1 L"', 1e-4)])
def test_they_are_read_as_a_share_or_in_their_unit(tmp_path: Path, line: str, expected: float) -> None:
    assert read(tmp_path, f"tank_volume = {line}").known_std("tank.volume") == pytest.approx(expected)


@pytest.mark.parametrize("line", ['"-1 %"', '"1 kg"', "0.1", '"wide"'])
def test_no_deviation_is_refused_by_its_key(tmp_path: Path, line: str) -> None:
    with pytest.raises(InputError, match=r"tank_volume.*one standard deviation"):
        read(tmp_path, f"tank_volume = {line}")


def test_the_guide_has_every_kind() -> None:
    assert not [kind for kind in {*KINDS.values(), "line_volume", "properties"} if f"`{kind}`" not in GUIDE]
