"""Fuels other than the report's paraffin: formula, enthalpy, blends, and the gas that they burn to."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.cli.shaped import MAELSTROM

from hfanalysis.errors import InputError
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import EngineFile, engine_of
from hfanalysis.record.sections import fuel_of
from hfanalysis.simulation.steady_run import design
from hfanalysis.simulation.unsteady_run import simulate
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, equilibrium
from hfanalysis.thermo.combustion_table import Nodes, build, gas_at
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.fuels import PARAFFIN, Fuel, atoms_of, blend, molar_mass
from hfanalysis.thermo.shifting import expand

ACRYLIC = Fuel("PMMA", atoms_of("C5H8O2"), molar_mass(atoms_of("C5H8O2")), -4.3e6)
"""A fuel with oxygen; its enthalpy is of the right size, and all the same for what is tested here."""


def file(**fuel: Any) -> EngineFile:
    """The report's engine with [fuel]."""
    content = read_toml(MAELSTROM)[1]
    return engine_of({**content, **({"fuel": fuel} if fuel else {})}, Path("engine.toml"), b"")


def test_it_burns_to_carbon_dioxide_water_and_nitrogen_at_its_own_mixture() -> None:
    assert ACRYLIC.stoichiometric == pytest.approx(12.0 * OXIDIZER_MOLAR_MASS / 100.117, rel=1e-4)
    ratios = np.linspace(2.0, 10.0, 81)
    hottest = [max(ratios, key=lambda r: equilibrium(20e5, r, fuel=f).temperature) for f in (ACRYLIC, PARAFFIN)]
    assert hottest[0] < ACRYLIC.stoichiometric < PARAFFIN.stoichiometric
    assert hottest[0] < hottest[1]


def test_the_table_of_another_fuel_agrees_with_equilibrium() -> None:
    kernel = build(Nodes(8, 20, 4), ACRYLIC).kernel
    rng = np.random.default_rng(3)
    for pressure, ratio in zip(rng.uniform(3e5, 60e5, 60), np.exp(rng.uniform(0.0, 3.5, 60)), strict=True):
        gas = equilibrium(float(pressure), float(ratio), 1.6e6, fuel=ACRYLIC)
        rt, gamma = gas_at(kernel, np.log(pressure), np.log(ratio), 1.6e6, 0.0)
        assert rt == pytest.approx(gas.gas_constant * gas.temperature, rel=2e-3)
        assert gamma == pytest.approx(gas.gamma, rel=2e-3)


def test_a_blend_has_the_atoms_and_the_enthalpy_of_its_parts() -> None:
    half = blend("both", [(0.5, PARAFFIN), (0.5, ACRYLIC)])
    assert half.stoichiometric == pytest.approx(0.5 * (PARAFFIN.stoichiometric + ACRYLIC.stoichiometric), rel=1e-4)
    assert half.enthalpy == pytest.approx(0.5 * (PARAFFIN.enthalpy + ACRYLIC.enthalpy))
    alone = equilibrium(20e5, 5.0, PROPEP_OXIDIZER_ENTHALPY, fuel=blend("one", [(1.0, ACRYLIC)]))
    assert alone.temperature == pytest.approx(equilibrium(20e5, 5.0, fuel=ACRYLIC).temperature, rel=1e-5)


def test_an_engine_burns_what_its_file_states() -> None:
    none, same = file(), file(formula="C20H42", molar_enthalpy="-554 kJ/mol")
    other = file(name="acrylic", formula="C5H8O2", enthalpy="-4.3 MJ/kg")
    impulse = [simulate(one).product.total_impulse.value or 0.0 for one in (none, same, other)]
    assert impulse[1] == impulse[0]
    assert [simulate(one).product.fuel for one in (none, other)] == ["paraffin", "acrylic"]
    assert impulse[2] > 1.01 * impulse[0]  # the report's engine burns rich of paraffin, and near the best of this one
    best = [design(one).product.optimum.of_ratio.value or 0.0 for one in (none, other)]
    assert best[1] < 0.75 * best[0]
    assert (fuel_of(none.fuel).wax, fuel_of(same.fuel).wax, fuel_of(other.fuel).wax) == (True, True, False)


@pytest.mark.parametrize(
    ("fuel", "words"),
    [
        ({"formula": "C20H42"}, "expected 'enthalpy' or 'molar_enthalpy'"),
        ({"formula": "Al", "enthalpy": "0 J/kg"}, "Al in 'Al'; expected C, H, N, O"),
        ({"formula": "C2O4", "enthalpy": "0 J/kg"}, "expected more carbon than oxygen"),
        ({"formula": "wax!", "enthalpy": "0 J/kg"}, "expected a formula such as C20H42"),
        ({"name": "wax"}, "expected a 'formula' with its enthalpy, or 'parts'"),
        ({"formula": "CH2", "enthalpy": "0 J/kg", "molar_enthalpy": "0 J/mol"}, "expected one of them"),
        ({"formula": "C20H42", "molar_enthalpy": "+554 kJ/mol"}, "is the sign or the unit another"),
        ({"formula": "C20H42", "enthalpy": "-46 MJ/kg"}, "one of combustion"),
        ({"parts": [{"formula": "CH2", "enthalpy": "0 J/kg", "share": "40 %"}]}, "100 % in all"),
    ],
)
def test_what_is_no_fuel_is_refused(fuel: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=rf"fuel.*{words}"):
        file(**fuel)


def test_a_nozzle_s_shifting_flow_is_that_of_its_fuel() -> None:
    found = expand(20e5, 5.0, fuel=ACRYLIC)
    of_paraffin = expand(20e5, 5.0)
    assert found.c_star == pytest.approx(found.frozen, rel=0.05)
    assert abs(found.c_star / of_paraffin.c_star - 1.0) > 0.02
