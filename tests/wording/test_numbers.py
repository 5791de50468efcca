"""Numbers as people read them: their units, and no more digits than they deserve."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.products.model import AdoptedEffect
from hfanalysis.quantity import Quantity
from hfanalysis.wording.numbers import adopted_in_words, fixed, ordered, people_unit, shown
from hfanalysis.wording.scales import pretty_unit, scale


@pytest.mark.parametrize(
    ("made", "value", "std", "interval", "unit"),
    [
        (Quantity(11.43e5, "Pa", 0.12e5), "11.43", "0.12", "11.19 … 11.67", "bar"),
        (Quantity(0.29312, "", 0.0034), "0.2931", "0.0034", "0.2865 … 0.2998", ""),
        (Quantity(6.371e8, "1/m^4", 2.1e7), "6.37", "0.21", "5.96 … 6.78", "×10⁸ 1/m⁴"),
        (Quantity(-3.1, "", 0.4), "−3.10", "0.40", "−3.88 … −2.32", ""),
        (Quantity(3.6e-9, "s", 1e-9), "0.0000", "0.0000", "0.0000 … 0.0000", "s"),
        (Quantity(1e-9, "N", 1.0), "0.0", "1.0", "−2.0 … 2.0", "N"),
        (Quantity(1.32e-4, "m/s", 2e-6), "1.320", "0.020", "1.281 … 1.359", "×10⁻⁴ m/s"),
    ],
)
def test_a_quantity_reads_in_the_units_of_the_stand(
    made: Quantity, value: str, std: str, interval: str, unit: str
) -> None:
    text = shown(made)
    assert (text.value, text.std, text.interval, text.unit) == (value, std, interval, unit)


def test_a_missing_quantity_says_why() -> None:
    text = shown(Quantity.absent("the vapor phase lasts 0.05 s", verdict="not identifiable"))
    assert (text.value, text.verdict, text.why) == ("–", "not identifiable", "the vapor phase lasts 0.05 s")


@given(st.floats(-1e12, 1e12), st.floats(1e-9, 1e9))
def test_rounding_never_moves_a_value_by_more_than_a_twentieth_of_its_std(value: float, std: float) -> None:
    text = shown(Quantity(value, "N", std))
    power = 1.0
    if "×10" in text.unit:
        digits = text.unit.removeprefix("×10").removesuffix(" N").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
        power = 10.0 ** int(digits)
    read = float(text.value.replace("−", "-")) * power
    assert math.isclose(read, value, abs_tol=std / 19.9 + 1e-8 * power, rel_tol=1e-8)


def test_units_that_people_do_not_use_keep_their_si_names() -> None:
    assert people_unit("kg/s") == (1.0, "kg/s")
    assert pretty_unit("kg/m^3") == "kg/m³"


def test_minus_zero_is_zero() -> None:
    assert fixed(-0.0001, 2) == "0.00"


def test_known_quantities_come_first_and_none_is_lost() -> None:
    product = {name: Quantity(value, "", 0.1) for name, value in (("new_one", 1.0), ("m", 0.7), ("C_i", 0.3))}
    assert list(ordered(product)) == ["C_i", "m", "new_one"]


@pytest.mark.parametrize(
    ("made", "read"),
    [
        (Quantity(1e6, "Pa", 1e4), "145.0 psi"),
        (Quantity(4448.2216152605, "N", 10.0), "1000.0 lbf"),
        (Quantity(4448.2216152605, "N s", 10.0), "1000.0 lbf s"),
        (Quantity(3048.0, "m", 3.0), "10000.0 ft"),
        (Quantity(8.35, "kg", 0.05), "8.350 kg"),
        (Quantity(293.15, "K", 0.5), "20.00 °C"),
    ],
)
def test_a_quantity_reads_in_the_units_of_the_team(made: Quantity, read: str) -> None:
    assert shown(made, "team").with_unit == read


def test_a_difference_of_temperatures_knows_no_zero_point() -> None:
    assert shown(Quantity(2.0, "K", 0.5), "team", difference=True).value == "2.00"


def test_a_burning_surface_is_told_in_millimeters_per_second() -> None:
    assert shown(Quantity(1.05e-3, "m/s", 2e-5), name="regression_rate_reference").with_unit == "1.050 mm/s"
    assert scale("m/s").unit == "m/s"


def test_adopted_effects_are_said_with_their_values_and_their_file() -> None:
    file = "HF5.effects.toml"
    heat = AdoptedEffect(name="tank_heat", parameters={"power": Quantity(912.34, "W", 152.1)}, file=file)
    layers = {"excess": Quantity(2.0, "K"), "mixing": Quantity(0.031, "-", 0.004)}
    layer = AdoptedEffect(name="tank_stratification", parameters=layers, file=file)
    names = {"tank_heat": "heat into the tank", "tank_stratification": "warm layers in the tank"}
    assert adopted_in_words([], names.__getitem__) == ""
    said = adopted_in_words([heat], names.__getitem__)
    assert said == "Included in the model: heat into the tank, 0.91 ± 0.15 kW (engines/HF5.effects.toml)."
    said = adopted_in_words([heat, layer], names.__getitem__)
    assert said.endswith("and warm layers in the tank, 2 K (mixing 0.0310 ± 0.0040) (engines/HF5.effects.toml).")
