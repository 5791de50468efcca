"""Files of adopted effects: what is written is read again, and what is wrong in them is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.inference.adopted.firing import make_root

from hfanalysis.effects import library
from hfanalysis.effects.trust import agree
from hfanalysis.engine.effect import Effect
from hfanalysis.errors import InputError
from hfanalysis.inference.adopted.effects import Adopted, read_adopted, read_effects, write_adopted
from hfanalysis.stages.open_test import open_test
from hfanalysis.units import Value


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "engines").mkdir()
    return make_root(tmp_path)


def adopted(root: Path, text: str, name: str = "T1") -> Adopted:
    (root / "engines" / f"{name}.effects.toml").write_text(text, encoding="utf-8")
    return read_adopted(root, open_test(root, "T1").definition)


@st.composite
def stated(draw: st.DrawFn) -> dict[str, dict[str, Value]]:
    """Some effects of the library with every parameter anywhere within its bounds."""
    names = draw(st.sets(st.sampled_from(sorted(library())), min_size=1, max_size=4))
    return {name: _values(draw, library()[name]) for name in sorted(names)}


def _values(draw: st.DrawFn, effect: Effect) -> dict[str, Value]:
    spread = st.none() | st.floats(0.0, 1e6, allow_nan=False)
    return {p.name: Value(draw(st.floats(p.low, p.high)), draw(spread)) for p in effect.parameters}


@given(stated())
def test_what_is_written_is_read_again_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, values: dict[str, dict[str, Value]]
) -> None:
    path = tmp_path_factory.mktemp("engines") / "T1.effects.toml"
    active = tuple(library()[name].at(**{k: v.value for k, v in found.items()}) for name, found in values.items())
    write_adopted(path, Adopted(active, values), ["why", "", "how to remove it"])
    found = read_effects(path, library())
    assert found.effects == active
    assert found.stated == values


def test_values_have_units_and_deviations(root: Path) -> None:
    found = adopted(
        root, '[tank_heat]\npower = "0.9 +/- 0.15 kW"\n[n2_purge]\narea = "8 mm^2"\ntemperature = "20 degC"\n'
    )
    assert [a.effect.name for a in found.effects] == ["n2_purge", "tank_heat"]
    purge, heat = found.effects
    # what is not stated: its prior's center
    assert heat.named == {"power": 900.0, "lag": 2.0, "fade": 40.0, "begun": 0.5}
    assert purge.named["area"] == pytest.approx(8e-6)
    assert purge.named["temperature"] == pytest.approx(293.15)
    assert purge.named["supply_pressure"] == 38e5
    power = found.product()[1].parameters["power"]
    assert (power.value, power.std, power.unit) == (900.0, 150.0, "W")


def test_a_difference_of_temperature_has_no_zero_point(root: Path) -> None:
    found = adopted(root, '[tank_stratification]\nexcess = "2 degC"\n')
    assert found.effects[0].named["excess"] == pytest.approx(2.0)


def test_without_a_file_nothing_is_adopted(root: Path) -> None:
    assert read_adopted(root, open_test(root, "T1").definition) == Adopted()


def test_a_tests_own_file_takes_the_place_of_its_stands(root: Path) -> None:
    of_stand = adopted(root, '[tank_heat]\npower = "1 kW"\n[chamber_tap_lag]\nlag = "30 ms"\n', "paper")
    assert {a.effect.name for a in of_stand.effects} == {"tank_heat", "chamber_tap_lag"}
    own = adopted(root, '[tank_heat]\npower = "2 kW"\nlag = "500 ms"\n')
    assert [(a.effect.name, a.values) for a in own.effects] == [("tank_heat", (2000.0, 0.5, 40.0, 0.5))]


def test_a_teams_own_effect_is_adopted_in_the_unit_that_it_has(root: Path) -> None:
    (root / "effects").mkdir()
    text = Path(library.__code__.co_filename).with_name("tank_heat.py").read_text(encoding="utf-8")
    text = text.replace('name="tank_heat"', 'name="lamp"').replace('"power", "W"', '"power", "lm"')
    (root / "effects" / "lamp.py").write_text(text, encoding="utf-8")
    agree(root / "effects")
    assert adopted(root, '[lamp]\npower = "12 +/- 2 lm"\n').effects[0].named["power"] == 12.0
    with pytest.raises(InputError, match=r"lamp\.power: found '12 W'; expected a value in lm"):
        adopted(root, '[lamp]\npower = "12 W"\n')


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[tank_haet]\npower = "1 kW"', r"found 'tank_haet'; expected an effect; did you mean 'tank_heat'"),
        (
            '[tank_heat]\npwoer = "1 kW"',
            r", tank_heat: found 'pwoer'; expected one of power, lag, fade, begun; did you mean 'power'",
        ),
        ('[tank_heat]\npower = "1 bar"', r", tank_heat\.power: unit 'bar' is a unit of pressure"),
        ('[tank_heat]\npower = "1 kw_"', r", tank_heat\.power: unit 'kw_' is not a known unit"),
        ("[tank_heat]\npower = 900", r", tank_heat\.power: found 900; expected a power with its unit"),
        ('[tank_heat]\npower = "much"', r", tank_heat\.power: found 'much'; expected a power with its unit"),
        ('[tank_heat]\npower = "90 kW"', r", tank_heat\.power: found '90 kW' = 90000 W; expected 0 to 20000 W"),
        ('[tank_heat]\npower = "1 +/- -2 kW"', r"expected a standard deviation that is not negative"),
        ("[tank_heat]", r", tank_heat: power is missing; expected the effect's strength"),
        ('[n2_purge]\nsupply_pressure = "30 bar"', r", n2_purge: area is missing"),
        ("[pressure_transducer_offset]", r"p_tank or p_run or p_chamber is missing"),
        ('tank_heat = "1 kW"', r", tank_heat: found '1 kW'; expected a table of parameters, \[tank_heat\]"),
        ("[tank_heat", r"not valid TOML"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(root: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=rf"T1\.effects\.toml.*{message}"):
        adopted(root, text)
