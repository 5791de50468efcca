"""What an engineer writes becomes the right number in SI, or a message that says why not."""

from __future__ import annotations

import math

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.errors import InputError
from hfanalysis.units import ALIASES, DIMENSIONS, GAUGE, TABLE, Value, dimension_of, is_gauge, parse, unit_factor

REGISTRY = pint.UnitRegistry()
SPOKEN = {"": "dimensionless", "1": "dimensionless", "-": "dimensionless", "%": "percent"}
ENTRIES = [(d, unit, factor) for d, units in TABLE.items() for unit, factor in units.items()]


@pytest.mark.parametrize(("dimension", "unit", "factor"), ENTRIES, ids=str)
def test_the_table_agrees_with_pint(dimension: str, unit: str, factor: tuple[float, float]) -> None:
    there = REGISTRY.Unit(SPOKEN.get(unit, unit.replace("^", "**")))
    si = REGISTRY.Unit(DIMENSIONS[dimension].pint)
    for x in (0.0, 1.0, 37.5):
        expected = REGISTRY.Quantity(x, there).to(si).magnitude
        assert factor[0] * x + factor[1] == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("dimension", "alias"), [(d, a) for d, names in ALIASES.items() for a in names], ids=str)
def test_every_alias_leads_to_the_table(dimension: str, alias: str) -> None:
    unit = ALIASES[dimension][alias]
    assert unit_factor(alias, dimension, "here") == TABLE[dimension][unit]


@pytest.mark.parametrize(
    ("text", "dimension", "value", "std"),
    [
        ("8.35 +/- 0.05 kg", "mass", 8.35, 0.05),
        ("(8.35 ± 0.05) kg", "mass", 8.35, 0.05),
        ("8.35 kg +/- 50 g", "mass", 8.35, 0.05),
        ("8.35 kg +- 1 %", "mass", 8.35, 0.0835),
        ("20 +/- 1 degC", "temperature", 293.15, 1.0),
        ("41 +/- 1.8 °F", "temperature", 278.15, 1.0),
        ("278 K", "temperature", 278.0, None),
        ("2 degC", "temperature_difference", 2.0, None),
        ("2 psig", "pressure_difference", 13789.514586, None),
        ("951 PSI", "pressure", 6556914.186, None),
        ("6 deg", "angle", math.radians(6.0), None),
        ("6°", "angle", math.radians(6.0), None),
        ("3.142 mm²", "area", 3.142e-6, None),
        ("0.218L", "volume", 0.218e-3, None),
        ("6.4e8 1/m^4", "loss_coefficient", 6.4e8, None),
        ("1 furlong", "length", 201.168, None),
        (0.529, "dimensionless", 0.529, None),
        ("0.529 +/- 0.01", "dimensionless", 0.529, 0.01),
    ],
)
def test_values_are_read_into_si(text: str, dimension: str, value: float, std: float | None) -> None:
    found = parse(text, dimension, "here")
    assert found.value == pytest.approx(value, rel=1e-5)
    assert found.std == (None if std is None else pytest.approx(std, rel=1e-6))


@given(st.floats(-1e6, 1e6), st.floats(0, 1e3), st.sampled_from(sorted(set(TABLE["pressure"]))))
def test_a_value_comes_back_as_written(x: float, spread: float, unit: str) -> None:
    scale = TABLE["pressure"][unit][0]
    found = parse(f"{x!r} +/- {spread!r} {unit}", "pressure", "here")
    assert found == Value(x * scale, spread * scale)


@pytest.mark.parametrize("unit", sorted(GAUGE))
def test_a_gauge_unit_is_known_as_one_and_is_no_absolute_value(unit: str) -> None:
    assert is_gauge(unit)
    assert not is_gauge(GAUGE[unit])
    with pytest.raises(InputError, match="gauge"):
        parse(f"3 {unit}", "pressure", "here")


@pytest.mark.parametrize(
    ("unit", "dimension"),
    [("C", "temperature"), ("F", "temperature"), ("psig", "pressure"), ("lbf", "force"), ("lb", "mass"),
     ("V", "voltage"), ("", "dimensionless"), ("acre", "area")],
)  # fmt: skip
def test_a_unit_tells_the_dimension_of_a_channel(unit: str, dimension: str) -> None:
    assert dimension_of(unit, "here") == dimension


@pytest.mark.parametrize("unit", ["mpa", "xyzzy", "kgg", "__import__('os')"])
def test_what_is_no_pressure_unit_is_refused(unit: str) -> None:
    with pytest.raises(InputError, match="here: unit"):
        unit_factor(unit, "pressure", "here")
