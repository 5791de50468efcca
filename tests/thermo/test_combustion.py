"""Equilibrium combustion of nitrous oxide and paraffin, and its table."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.arrays import Array
from hfanalysis.steady_design.steady import Requirement, ideal_specific_impulse, optimum
from hfanalysis.thermo.combustion import (
    FORMATION_OFFSET,
    PROPEP_OXIDIZER_ENTHALPY,
    equilibrium,
)
from hfanalysis.thermo.combustion_table import (
    GAMMA,
    LN_RT,
    STOICHIOMETRIC,
    Nodes,
    _at,
    build,
    carbon_edge,
    chamber_pressure,
    gas_at,
    temperatures,
)
from hfanalysis.thermo.constants import GAS_CONSTANT, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.fuels import PARAFFIN
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
        molecular_weight=PARAFFIN.molar_mass,
        enthalpy=-554e6 / PARAFFIN.molar_mass,
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
    enthalpy = weights @ np.array([-554e6 / PARAFFIN.molar_mass, PROPEP_OXIDIZER_ENTHALPY])
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


WORST = (1e-4, 1e-4, 2.5e-4)
"""Of ln(R T), gamma, ln T; the temperature is only printed, nothing is solved with it."""

TOP_SHARE = 0.85
"""Beyond it the gas is below 1100 K; there the table's 1e-4 become 1e-3."""


def mixtures(count: int, ratios: tuple[float, float], most_nitrogen: float) -> Array:
    """Random pressure, oxidizer to fuel, enthalpy and share: shape (count, 4)."""
    rng = np.random.default_rng(5)
    p = np.exp(rng.uniform(np.log(0.3e5), np.log(100e5), count))
    r = np.exp(rng.uniform(*np.log(ratios), count))
    h = rng.uniform(1.39e6, PROPEP_OXIDIZER_ENTHALPY, count)
    return np.column_stack([p, r, h, rng.uniform(0.0, most_nitrogen, count)])


def errors(points: Array) -> Array:
    """Of ln(R T), gamma and ln T against direct equilibrium."""
    out = np.empty((len(points), 3))
    for row, (p, r, h, s) in zip(out, points, strict=True):
        of = r / (1.0 - s)
        gas = equilibrium(float(p), float(of), float(h), float(s))
        rt, gamma = gas_at(table().kernel, np.log(p), np.log(of), h, s)
        at = np.array([np.log(p)]), np.array([np.log(of)]), np.array([h]), np.array([s])
        hot = temperatures(table().kernel, *at)[0]
        row[:] = np.log(rt / (gas.gas_constant * gas.temperature)), gamma - gas.gamma, np.log(hot / gas.temperature)
    return np.abs(out)


@pytest.mark.parametrize(("ratios", "nitrogen"), [((0.5, 200.0), 0.0), ((0.7, 60.0), 0.0), ((0.5, 60.0), TOP_SHARE)])
def test_the_table_agrees_with_equilibrium(ratios: tuple[float, float], nitrogen: float) -> None:
    found = errors(mixtures(600, ratios, nitrogen))
    assert np.quantile(found, 0.5) < 2e-6
    assert np.quantile(found, 0.95, axis=0).max() < 2e-5
    assert (found.max(axis=0) < WORST).all()


@pytest.mark.parametrize("nitrogen", [0.0, 0.5])
def test_the_table_agrees_with_equilibrium_where_carbon_condenses(nitrogen: float) -> None:
    found = errors(mixtures(400, (2.9, 3.4), nitrogen))
    assert np.quantile(found, 0.95, axis=0).max() < 6e-5
    assert (found.max(axis=0) < WORST).all()


def test_nitrogen_nearly_alone_is_right_to_half_a_percent() -> None:
    points = mixtures(300, (0.3, 20.0), 0.0)
    points[:, 3] = np.random.default_rng(6).uniform(TOP_SHARE, 0.98, len(points))
    assert errors(points).max() < 5e-3


@given(ln_p=st.floats(9.0, 17.0), ln_of=st.floats(-3.0, 6.0), h=st.floats(1.3e6, 1.9e6))
def test_a_trace_of_nitrogen_changes_a_trace(ln_p: float, ln_of: float, h: float) -> None:
    """Without nitrogen the value is the first level's own, to which the others lead without a step."""
    none = np.array(gas_at(table().kernel, ln_p, ln_of, h, 0.0))
    assert (np.array(gas_at(table().kernel, ln_p, ln_of, h, -0.0)) == none).all()
    assert gas_at(table().kernel, ln_p, ln_of, h, 1e-9) == pytest.approx(none, rel=1e-8)


@given(p=st.floats(0.3e5, 100e5), h=st.floats(1.40e6, 1.86e6), share=st.sampled_from([0.0, 0.1, 0.33, 0.6, 0.8]))
def test_values_meet_at_the_carbon_edge_and_at_stoichiometry_and_midway(p: float, h: float, share: float) -> None:
    ln_p, offset = np.log(p), -np.log1p(-share)
    edge = carbon_edge(p, h, share)
    # the table's own edge is where its second difference peaks: nowhere is there a step
    around = np.concatenate(
        [edge + np.linspace(-1e-3, 1e-3, 401), np.log(STOICHIOMETRIC) + np.linspace(-1e-3, 1e-3, 401)]
    )
    values = np.array([gas_at(table().kernel, ln_p, x + offset, h, share) for x in around])
    steps = np.abs(np.diff(np.log(values), axis=0))
    steps[400] = 0.0
    assert steps.max() < 5e-6 * 3.0


def test_the_slope_breaks_at_the_carbon_edge_and_nowhere_else() -> None:
    """From 1 % on either side; with one kink kept, the next is a hilltop."""

    def breaks(x: float, h: float = 1e-6) -> float:
        a, b, c = (np.log(gas_at(table().kernel, np.log(27e5), x + d, 1.6e6, 0.0)[0]) for d in (-h, 0.0, h))
        return float(abs(a - 2.0 * b + c) / h)

    edge = carbon_edge(27e5, 1.6e6, 0.0)
    found = np.array(
        [breaks(x) for x in np.concatenate([np.linspace(-0.6, edge - 0.01, 500), [np.log(STOICHIOMETRIC)]])]
    )
    assert found.max() < 1e-3
    near = np.linspace(-2e-5, 2e-5, 41)
    assert max(breaks(edge + d) for d in near) > 0.05


@given(
    st.floats(1e-6, 0.5),
    st.floats(3e-4, 5e-3),
    st.floats(0.05, 900.0),
    st.floats(1.39e6, 1.9e6),
    st.sampled_from([0.0, 0.3, 0.97]),
    st.floats(0.3e5, 1e7),
)
def test_the_chambers_pressure_satisfies_the_gas_law(
    mass: float, volume: float, of: float, h: float, share: float, guess: float
) -> None:
    kernel = table().kernel
    p, rt, gamma = chamber_pressure(kernel, mass, volume, np.log(of), h, share, guess)
    assert p * volume == pytest.approx(mass * rt, rel=1e-11)
    assert (rt, gamma) == pytest.approx(gas_at(kernel, np.log(p), np.log(of), h, share), rel=1e-9)


def test_the_pressures_derivative_is_the_values() -> None:
    """Newton's step needs it exact, the motion of the carbon edge with pressure included."""
    kernel, h = table().kernel, 1e-6
    for of in (0.8, 2.9, 3.02, 3.2, 5.0, 8.0, 12.0, 100.0):
        for share in (0.0, 0.4):
            for row in (LN_RT, GAMMA):
                at = np.log(of / (1.0 - share)), 1.6e6, share, row
                up, down = _at(kernel, 14.0 + h, *at)[0], _at(kernel, 14.0 - h, *at)[0]
                assert (up - down) / (2.0 * h) == pytest.approx(_at(kernel, 14.0, *at)[1], abs=1e-8)


@pytest.mark.parametrize("which", range(4))
def test_what_is_no_number_stays_none(which: int) -> None:
    at = [14.0, 1.0, 1.6e6, 0.3]
    at[which] = float("nan")
    assert np.isnan(gas_at(table().kernel, *at)).all()
    assert np.isnan(chamber_pressure(table().kernel, -1.0, 1e-3, 1.0, 1.6e6, 0.0, 1e5)).all()


SMALL = Nodes(pressures=4, mixtures=5, shares=4)


def test_a_spoilt_table_is_built_anew_and_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HFA_CACHE", str(tmp_path))
    first = build(SMALL).kernel
    (path,) = tmp_path.iterdir()
    good = path.read_bytes()
    path.write_bytes(good[: len(good) // 2])
    equilibrium(20e5, 1.0)  # what CEA was asked before does not show
    for a, b in zip(build(SMALL).kernel, first, strict=True):
        np.testing.assert_array_equal(a, b)
    assert path.read_bytes() == good


def test_building_prints_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HFA_CACHE", str(tmp_path))
    build(SMALL)
    assert capfd.readouterr() == ("", "")


def test_the_gas_constant_is_of_the_gas() -> None:
    gas = equilibrium(27.579e5, 6.33)
    assert gas.gas_constant * gas.molar_mass == pytest.approx(GAS_CONSTANT)
