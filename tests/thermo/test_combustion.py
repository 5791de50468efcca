"""Equilibrium combustion of nitrous oxide and paraffin, and its table."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.engine.steady import Requirement, ideal_specific_impulse, optimum
from hfanalysis.thermo.combustion import (
    FORMATION_OFFSET,
    FUEL_MOLAR_MASS,
    PROPEP_OXIDIZER_ENTHALPY,
    equilibrium,
)
from hfanalysis.thermo.combustion_table import build, chamber_pressure, gas_at
from hfanalysis.thermo.constants import GAS_CONSTANT, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Property

DESIGN = Requirement(2.5, 27.579e5, 0.84623 * 101325.0, None)


table = cache(build)


def test_the_design_point_burns_at_the_certified_temperature() -> None:
    assert equilibrium(27.579e5, 4.29).temperature == pytest.approx(2666.0, abs=1.0)


def test_the_best_mixture_is_the_certified_one() -> None:
    best = optimum(DESIGN)
    assert best.of_ratio == pytest.approx(6.33, abs=0.02)
    assert best.specific_impulse == pytest.approx(237.7, abs=0.1)


@pytest.mark.parametrize("source", ["report", "coolprop"])
@pytest.mark.parametrize(("temperature", "certified"), [(293.15, 70.82), (298.15, 71.47)])
def test_the_liquids_enthalpy_is_on_the_formation_scale(source: str, temperature: float, certified: float) -> None:
    liquid = float(saturation(source).energy(Property.LIQUID_ENTHALPY, temperature)[0])
    assert (liquid + FORMATION_OFFSET) * OXIDIZER_MOLAR_MASS / 1e6 == pytest.approx(certified, abs=0.05)


def test_propep_takes_the_ideal_gas_which_is_eleven_megajoules_too_much() -> None:
    propep = PROPEP_OXIDIZER_ENTHALPY * OXIDIZER_MOLAR_MASS / 1e6
    assert propep == pytest.approx(82.05, abs=1e-9)
    liquid = float(saturation("report").energy(Property.LIQUID_ENTHALPY, 298.15)[0]) + FORMATION_OFFSET
    assert propep - liquid * OXIDIZER_MOLAR_MASS / 1e6 == pytest.approx(10.6, abs=0.1)


def test_the_liquids_enthalpy_costs_impulse_and_moves_the_optimum() -> None:
    liquid = float(saturation("report").energy(Property.LIQUID_ENTHALPY, 298.15)[0]) + FORMATION_OFFSET
    best = optimum(Requirement(2.5, 27.579e5, 0.84623 * 101325.0, None, liquid))
    assert best.of_ratio == pytest.approx(6.53, abs=0.03)
    assert 237.7 - best.specific_impulse == pytest.approx(3.0, abs=0.5)


def test_gamma_is_frozen_an_equilibrium_gamma_would_give_249_s() -> None:
    """The same nozzle with CEA's equilibrium exponent lies where the report's numbers cannot be."""

    def impulse(of: float) -> float:
        gas, g = equilibrium(DESIGN.chamber_pressure, of), equilibrium_gamma(DESIGN.chamber_pressure, of)
        drop = 1.0 - (DESIGN.ambient / DESIGN.chamber_pressure) ** ((g - 1.0) / g)
        return sqrt(2.0 * g / (g - 1.0) * gas.gas_constant * gas.temperature * drop) / 9.80665

    ratios = np.linspace(5.0, 9.0, 81)
    impulses = [impulse(float(of)) for of in ratios]
    assert max(impulses) == pytest.approx(249.0, abs=1.0)
    assert ratios[int(np.argmax(impulses))] == pytest.approx(7.0, abs=0.2)
    assert ideal_specific_impulse(DESIGN, 6.33) < max(impulses) - 10.0


def equilibrium_gamma(pressure: float, of_ratio: float) -> float:
    """CEA's isentropic exponent of a reacting mixture, by a solver of its own."""
    solution, _ = raw(pressure, of_ratio)
    return float(solution.gamma_s)


def raw(pressure: float, of_ratio: float):  # type: ignore[no-untyped-def]
    import cea

    fuel = cea.Reactant(
        name="wax",
        formula={"C": 20.0, "H": 42.0},
        molecular_weight=FUEL_MOLAR_MASS,
        enthalpy=-554e6 / FUEL_MOLAR_MASS,
        enthalpy_units="J/kg",
        temperature=298.15,
    )
    oxidizer = cea.Reactant(
        name="N2O(PROPEP)",
        formula={"N": 2.0, "O": 1.0},
        molecular_weight=OXIDIZER_MOLAR_MASS,
        enthalpy=PROPEP_OXIDIZER_ENTHALPY,
        enthalpy_units="J/kg",
        temperature=298.15,
    )
    reactants = cea.Mixture([fuel, oxidizer])
    products = cea.Mixture([fuel, oxidizer], products_from_reactants=True)
    solver = cea.EqSolver(products, reactants=reactants)
    solution = cea.EqSolution(solver)
    weights = np.array([1.0, of_ratio]) / (1.0 + of_ratio)
    enthalpy = weights @ np.array([-554e6 / FUEL_MOLAR_MASS, PROPEP_OXIDIZER_ENTHALPY])
    solver.solve(solution, cea.HP, float(enthalpy) / cea.R, pressure / 1e5, weights)
    return solution, products


def test_condensed_carbon_counts_in_the_mass_and_not_in_the_gas_law() -> None:
    solution, _ = raw(20e5, 2.0)
    carbon = solution.mass_fractions["C(gr)"]
    assert carbon > 0.01
    gas_moles = sum(x / GRAMS[name] for name, x in mass_of_main_species(solution).items())
    assert equilibrium(20e5, 2.0).molar_mass == pytest.approx(1.0 / gas_moles, rel=2e-3)
    assert equilibrium(20e5, 2.0).molar_mass > 1.01 * (1.0 - carbon) / gas_moles


GRAMS = {"CO": 28.010, "CO2": 44.009, "H2": 2.016, "H2O": 18.015, "N2": 28.014, "CH4": 16.043, "HCN": 27.026}


def mass_of_main_species(solution) -> dict[str, float]:  # type: ignore[no-untyped-def]
    return {name: float(solution.mass_fractions[name]) for name in GRAMS}


def test_nitrogen_lowers_the_characteristic_velocity() -> None:
    velocities = [equilibrium(20e5, 6.0, nitrogen_share=s).characteristic_velocity for s in (0.0, 0.2, 0.4, 0.6)]
    assert all(b < a - 10.0 for a, b in pairwise(velocities))


def test_inert_nitrogen_leaves_less_to_burn_as_more_fuel_would() -> None:
    """O/F counts what the injector passes: half of it nitrogen leaves half the oxidizer."""
    assert equilibrium(20e5, 8.0, nitrogen_share=0.5).temperature < equilibrium(20e5, 4.0).temperature


@pytest.mark.parametrize(
    ("pressure", "of_ratio", "share"),
    [(0.0, 4.0, 0.0), (-1e5, 4.0, 0.0), (20e5, 0.0, 0.0), (20e5, -1.0, 0.0), (20e5, 4.0, 1.0), (20e5, 4.0, -0.1)],
)
def test_what_is_no_mixture_is_refused(pressure: float, of_ratio: float, share: float) -> None:
    with pytest.raises(ValueError, match="no mixture"):
        equilibrium(pressure, of_ratio, nitrogen_share=share)


def test_no_convergence_is_an_error_and_no_warning() -> None:
    with pytest.raises(ArithmeticError, match="no equilibrium"):
        equilibrium(20e5, 4.0, -3e7)


@pytest.mark.parametrize("of_ratio", [float("nan"), float("inf")])
def test_a_ratio_that_is_no_number_never_yields_a_gas(of_ratio: float) -> None:
    with pytest.raises(ValueError, match="no mixture"):
        equilibrium(20e5, of_ratio)


def test_the_table_agrees_with_equilibrium() -> None:
    rng = np.random.default_rng(5)
    p = np.exp(rng.uniform(np.log(0.5e5), np.log(60e5), 400))
    of = np.exp(rng.uniform(np.log(1.0), np.log(60.0), 400))
    errors = np.empty((400, 2))
    for i in range(400):
        gas = equilibrium(float(p[i]), float(of[i]))
        rt, gamma = gas_at(table().kernel, np.log(p[i]), np.log(of[i]))
        errors[i] = abs(rt / (gas.gas_constant * gas.temperature) - 1.0), abs(gamma / gas.gamma - 1.0)
    edge = (of > 2.6) & (of < 3.4)
    assert np.median(errors, axis=0) == pytest.approx([0.0, 0.0], abs=1e-5)
    assert errors[~edge].max() < 1e-3
    assert errors[edge].max() < 1e-2


@given(node=st.integers(1, 18), other=st.floats(3.0, 130.0), along_ratio=st.booleans(), row=st.integers(0, 1))
def test_slopes_agree_from_both_sides_of_a_node(node: int, other: float, along_ratio: bool, row: int) -> None:
    kernel = table().kernel
    _, p0, dp, r0, dr = kernel

    def at(offset: float) -> float:
        if along_ratio:
            return float(gas_at(kernel, p0 + dp * other / 7.0, r0 + dr * (7 * node + offset))[row])
        return float(gas_at(kernel, p0 + dp * (node + offset), r0 + dr * other)[row])

    h = 1e-5
    left = (at(0.0) - at(-h)) / h
    right = (at(h) - at(0.0)) / h
    # between them lies h times the curvature, which a cubic on this grid bounds
    bend = abs(at(0.5) - 2.0 * at(0.0) + at(-0.5)) * 100.0 + 1e-6 * abs(at(0.0))
    assert left == pytest.approx(right, abs=h * bend + 1e-9 * abs(at(0.0)) / h)


@given(st.floats(1e-6, 0.5), st.floats(3e-4, 5e-3), st.floats(0.5, 100.0), st.floats(0.3e5, 1e7))
def test_the_chambers_pressure_satisfies_the_gas_law(mass: float, volume: float, of: float, guess: float) -> None:
    kernel = table().kernel
    p, rt, gamma = chamber_pressure(kernel, mass, volume, np.log(of), guess)
    assert p * volume == pytest.approx(mass * rt, rel=1e-11)
    assert (rt, gamma) == pytest.approx(gas_at(kernel, np.log(p), np.log(of)), rel=1e-10)


def test_the_gas_constant_is_of_the_gas() -> None:
    gas = equilibrium(27.579e5, 6.33)
    assert gas.gas_constant * gas.molar_mass == pytest.approx(GAS_CONSTANT)
