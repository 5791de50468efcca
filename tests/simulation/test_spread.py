"""Bands of an engine's numbers, from what its file states with a +/-."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.cli.shaped import MAELSTROM

from hfanalysis.errors import InputError
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.products.engines import Simulated
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import EngineFile, engine_of
from hfanalysis.simulation import spread, steady_run
from hfanalysis.simulation.over_temperature import over_temperature
from hfanalysis.simulation.unsteady_run import simulate


def file(**changes: Any) -> EngineFile:
    """maelstrom.toml with keys stated otherwise: ``tank__temperature="25 +/- 2 degC"``."""
    content = read_toml(MAELSTROM)[1]
    for name, value in changes.items():
        section, _, key = name.partition("__")
        if key:
            content[section] = {**content.get(section, {}), key: value}
        else:
            content[section] = value
    return engine_of(content, Path("engine.toml"), b"")


def found(draws: int = 200, **changes: Any) -> Simulated:
    return simulate(file(**changes), None, draws).product


def slope(key: str, low: str, high: str, std: float) -> float:
    """What one deviation of an input does to the apogee [m], by two runs."""
    ends = [found(0, **{key: value}).flight.apogee.value for value in (low, high)]
    assert None not in ends
    return abs(ends[1] - ends[0]) * std  # type: ignore[operator]


@pytest.mark.parametrize(
    ("key", "loose", "low", "high", "std"),
    [
        ("rocket__drag_coefficient", "0.529 +/- 0.01", "0.528", "0.530", 0.01 / 0.002),
        ("rocket__dry_mass", "52.5 +/- 0.2 kg", "52.4 kg", "52.6 kg", 0.2 / 0.2),
        ("grain__mass", "1639 +/- 4 g", "1638 g", "1640 g", 4.0 / 2.0),
    ],
)
def test_an_input_is_worth_its_deviation_times_its_slope(key: str, loose: str, low: str, high: str, std: float) -> None:
    apogee = found(**{key: loose}).flight.apogee
    assert apogee.std == pytest.approx(slope(key, low, high, std), rel=0.12)
    assert apogee.interval is not None
    assert apogee.interval[0] < apogee.value < apogee.interval[1]


def test_another_seed_moves_a_deviation_by_less_than_a_tenth() -> None:
    loose = file(rocket__drag_coefficient="0.529 +/- 0.03", injector__C_i="1.0 +/- 0.03")
    spreads = [spread.bands(loose, Adopted(), "hfa simulate", spread.DRAWS, seed).flight["apogee"] for seed in (1, 2)]
    one, two = (of.std for of in spreads if not isinstance(of, str))
    assert one == pytest.approx(two, rel=0.1)


def test_constants_that_go_together_cancel_where_they_do() -> None:
    """a up and n down leave the rate at the burn's mean flux as it is; each alone moves the impulse far."""
    names, std = ["ln_a", "n"], [0.30, 0.05]
    bound = {"names": names, "std": std, "correlation": [[1.0, -0.999], [-0.999, 1.0]]}
    free = {**bound, "correlation": [[1.0, 0.0], [0.0, 1.0]]}
    tied, alone = (found(covariance=errors).peak_chamber_pressure.std for errors in (bound, free))
    assert tied is not None
    assert alone is not None
    assert tied < 0.3 * alone


def test_a_constant_of_the_covariance_is_not_drawn_a_second_time() -> None:
    errors = {"names": ["flow_area"], "std": [1e-6], "correlation": [[1.0]]}
    own = file(injector__C_i="1.0 +/- 0.5", covariance=errors)
    assert [one.name for one in spread.loose(own)] == []
    assert [one.name for one in spread.loose(file(injector__C_i="1.0 +/- 0.5"))] == ["injector.C_i"]


def test_the_tank_that_was_built_is_filled_with_another_load() -> None:
    """An ullage sizes the tank once: another load fills the same tank further."""
    built = spread.with_tank_as_built(file(tank__oxidizer_mass="7.0 +/- 0.1 kg"), "hfa simulate")
    assert built.tank.volume is not None
    assert built.tank.ullage is None
    itself = spread.with_tank_as_built(file(tank__ullage="0.2 +/- 0.02"), "hfa simulate")
    assert itself.tank.volume is None


def test_chances_are_shares_of_the_draws_and_the_budget_names_what_costs_most() -> None:
    told = found(rocket__drag_coefficient="0.529 +/- 0.05", rocket__dry_mass="52.5 +/- 0.1 kg").spread
    assert told is not None
    chances = {one.name: one.probability for one in told.chances}
    assert set(chances) == {"target_reached", "rail_speed", "injector_stiffness"}
    assert 0.5 < chances["target_reached"] < 0.99
    assert chances["injector_stiffness"] == 1.0
    shares = told.budget["apogee"].shares
    assert next(iter(shares)) == "rocket.drag_coefficient"
    assert shares["rocket.drag_coefficient"] > 0.9
    assert {one.name for one in told.inputs} == {"rocket.drag_coefficient", "rocket.dry_mass"}


def test_a_number_that_few_draws_have_says_so_and_has_no_band() -> None:
    told = found(grain__a="1.32e-4 +/- 2e-5").liquid_depletion_time
    assert told.std is None
    assert "no band" in str(told.why)


def test_without_a_spread_nothing_is_drawn_and_nothing_changes() -> None:
    plain, asked = found(0), found(200)
    assert asked.spread is None
    assert asked == plain


def test_engines_that_cannot_be_are_counted() -> None:
    told = found(tank__temperature="25 +/- 20 degC").spread
    assert told is not None
    assert 10 < told.refused < 190


def test_a_design_has_bands_as_well() -> None:
    told = steady_run.design(file(grain__a="1.32e-4 +/- 5e-6"), 60).product
    assert told.spread is not None
    assert next(iter(told.spread.budget["fuel_mass"].shares)) == "grain.a"
    ends = [steady_run.design(file(grain__a=a)).product.fuel_mass.value for a in (1.27e-4, 1.37e-4)]
    assert told.fuel_mass.std == pytest.approx(abs(np.subtract(*ends)) / 2.0, rel=0.3)
    assert told.grain_length.std is None


@pytest.mark.parametrize(("name", "std"), [("volume", 2e-4), ("fuel_mass", 0.02), ("oxidizer_mass", 0.05), ("m", 0.02)])
def test_every_name_of_a_covariance_moves_the_engine(name: str, std: float) -> None:
    errors = {"names": [name], "std": [std], "correlation": [[1.0]]}
    told = found(100, covariance=errors, tank__polytropic_exponent=1.1)
    assert told.total_impulse.std is not None
    assert told.total_impulse.std > 1e-5 * told.total_impulse.value


def test_a_name_that_is_no_constant_of_the_engine_is_refused() -> None:
    errors = {"names": ["weather"], "std": [1.0], "correlation": [[1.0]]}
    with pytest.raises(InputError, match=r"covariance\.names: found 'weather'"):
        found(20, covariance=errors)


def test_what_the_file_states_with_an_error_makes_bands_over_the_temperature() -> None:
    loose = file(injector__C_i="1.0 +/- 0.05")
    days = over_temperature(loose, Adopted(), "hfa simulate", drawn=40)
    fits = days.temperature < 31.0  # beyond, its load fills the tank with liquid
    for name in ("peak_thrust", "peak_chamber_pressure", "apogee"):
        low, high = days.bands[name]
        assert (low[fits] < days.numbers[name][fits]).all()
        assert (days.numbers[name][fits] < high[fits]).all()
        assert np.isnan(low[~fits]).all()
    low, high = (np.interp(25.0, days.temperature, end) for end in days.bands["peak_thrust"])
    ends = [found(0, injector__C_i=value).peak_thrust.value or 0.0 for value in ("0.9", "1.1")]
    assert high - low == pytest.approx(ends[1] - ends[0], rel=0.3)  # two deviations to either side
    assert over_temperature(loose, Adopted(), "hfa simulate", drawn=0).bands == {}
