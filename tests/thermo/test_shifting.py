"""Shifting expansion against NASA CEA's own rocket problem, and the table of it against direct expansions."""

from __future__ import annotations

from functools import cache
from typing import Any

import cea
import numpy as np
import pytest

from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.fuels import PARAFFIN
from hfanalysis.thermo.shifting import expand, shifting

ENTHALPY = 1.7e6
CASES = [
    (12.0, 10.5, 2.67), (12.0, 7.0, 2.67), (27.0, 4.3, 2.67), (5.0, 3.5, 2.67), (40.0, 6.0, 5.0), (20.0, 9.5, 8.0),
    (2.0, 12.0, 1.6), (60.0, 5.0, 11.0), (8.0, 2.5, 2.5), (15.0, 25.0, 3.0),
]  # fmt: skip
"""Chamber pressure [bar], O/F and area ratio: from rich of the carbon edge to far lean."""


@cache
def rocket() -> tuple[Any, Any]:
    def reactant(name: str, formula: dict[str, float], mass: float) -> Any:
        return cea.Reactant(
            name=name, formula=formula, molecular_weight=mass, enthalpy=0.0, enthalpy_units="J/kg", temperature=298.15
        )

    fuel = reactant("paraffin", {"C": 20.0, "H": 42.0}, PARAFFIN.molar_mass)
    oxidizer = reactant("nitrous oxide", {"N": 2.0, "O": 1.0}, OXIDIZER_MOLAR_MASS)
    products = cea.Mixture([fuel, oxidizer], products_from_reactants=True)
    solver = cea.RocketSolver(products, reactants=cea.Mixture([fuel, oxidizer]))
    return solver, cea.RocketSolution(solver)


def by_cea(bar: float, ratio: float, area: float) -> tuple[float, float]:
    """c* [m/s] and C_F into vacuum, equilibrium all the way."""
    solver, solution = rocket()
    weights = np.array([1.0, ratio]) / (1.0 + ratio)
    enthalpy = float(weights @ [PARAFFIN.enthalpy, ENTHALPY]) / cea.R
    solver.solve(solution, weights, bar, [2.0], supar=[area], hc=enthalpy, iac=True)
    last = solution.num_pts - 1
    c_star = float(solution.c_star[last])
    return c_star, float(solution.Isp_vacuum[last]) / c_star


@pytest.mark.parametrize(("bar", "ratio", "area"), CASES)
def test_c_star_and_thrust_coefficient_are_those_of_ceas_rocket_problem(bar: float, ratio: float, area: float) -> None:
    c_star, coefficient = by_cea(bar, ratio, area)
    found = expand(bar * 1e5, ratio, ENTHALPY)
    assert found.c_star == pytest.approx(c_star, rel=1e-4)
    assert float(found.vacuum_coefficient(area)) == pytest.approx(coefficient, rel=1e-4)
    gain, force = shifting(np.array([bar * 1e5]), np.array([ratio]), ENTHALPY, area)
    assert gain[0] * found.frozen == pytest.approx(c_star, rel=1e-3)
    assert force[0] == pytest.approx(coefficient, rel=1e-3)


def test_shifting_gives_more_than_frozen_where_the_gas_is_dissociated_and_no_more_where_it_is_not() -> None:
    hot, cool = expand(12e5, 9.5), expand(12e5, 3.3)
    assert 1.02 < hot.c_star / hot.frozen < 1.05
    assert cool.c_star / cool.frozen == pytest.approx(1.0, abs=5e-3)


def test_where_there_is_no_mixture_there_is_no_number() -> None:
    gain, force = shifting(np.array([12e5, 12e5]), np.array([np.nan, 8.0]), ENTHALPY, 2.67)
    assert np.isnan([gain[0], force[0]]).all()
    assert np.isfinite([gain[1], force[1]]).all()
