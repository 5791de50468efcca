"""All courses of the mixture that fit: where they are one, where they are two, and what pulls at them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.performance.reconstruction.inputs import Error, Inputs
from hfanalysis.performance.reconstruction.posterior import Courses, courses
from hfanalysis.performance.reconstruction.theory import Theory

AREA, ENTHALPY, FLOW = 5e-4, 1.6e6, 0.4
TIME = np.linspace(0.5, 5.5, 51)


@pytest.fixture(scope="module")
def theory() -> Theory:
    return Theory.of(ENTHALPY, AREA, 3.0 * AREA)


def inputs(theory: Theory, of_ratio: Array, efficiency: Array | float = 0.93) -> Inputs:
    """Exact measurements of a burn with this mixture, the fuel's mass known to half a per cent."""
    pressure = np.full(TIME.size, 20e5)
    for _ in range(20):
        c_star = theory.at(theory.c_star, pressure, of_ratio)
        pressure = efficiency * c_star * FLOW * (1.0 + 1.0 / of_ratio) / AREA
    fuel = float(np.trapezoid(FLOW / of_ratio, TIME))
    drift = Error("efficiency", 0.04 * np.linspace(-0.5, 0.5, TIME.size))
    return Inputs(
        TIME, pressure, np.full(TIME.size, FLOW), np.full(TIME.size, AREA), np.zeros(TIME.size),
        np.full(TIME.size, 1e-3), (fuel, 0.005 * fuel), (0.93, 0.1), np.zeros(TIME.size), {"drift": drift},
    )  # fmt: skip


def off(found: Courses, of_ratio: Array) -> Array:
    return np.asarray(np.median(found.of_ratio, axis=1) / of_ratio - 1.0)


@pytest.mark.parametrize("ends", [(7.0, 9.0), (11.0, 8.0), (5.0, 4.2), (2.6, 2.2)])
def test_a_mixture_on_each_side_is_found_again(theory: Theory, ends: tuple[float, float]) -> None:
    true = np.geomspace(*ends, TIME.size)
    found = courses(inputs(theory, true), theory)
    assert np.median(np.abs(off(found, true))) < 0.05
    low, high = np.quantile(found.of_ratio, (0.005, 0.995), axis=1)
    assert ((true > low) & (true < high)).mean() > 0.9


def test_an_efficiency_that_falls_is_no_mixture_that_jumps(theory: Theory) -> None:
    true = np.geomspace(5.6, 5.4, TIME.size)
    found = courses(inputs(theory, true, np.linspace(0.95, 0.88, TIME.size)), theory)
    low, high = np.quantile(found.of_ratio, (0.025, 0.975), axis=1)
    assert ((true > low) & (true < high)).all()
    assert np.abs(off(found, true)).max() < 0.2


def test_without_the_fuel_both_sides_of_the_peak_are_in_the_band(theory: Theory) -> None:
    true = np.full(TIME.size, 8.0)
    found = courses(replace(inputs(theory, true), fuel=None, efficiency=(0.93, 0.05)), theory)
    low, high = np.quantile(found.of_ratio, (0.025, 0.975), axis=1)
    assert (low < 3.5).all()
    assert (high > 8.0).all()


def test_a_sample_that_nothing_explains_moves_nothing(theory: Theory) -> None:
    true = np.geomspace(9.0, 8.0, TIME.size)
    clean = inputs(theory, true)
    wild = clean.pressure.copy()
    wild[-1] *= 0.7
    found = courses(replace(clean, pressure=wild), theory)
    assert np.median(np.abs(off(found, true))) < 0.05


def test_the_band_holds_an_oxidizer_flow_off_by_its_error(theory: Theory) -> None:
    true = np.geomspace(8.0, 7.0, TIME.size)
    of_flow = Error("oxidizer", np.full(TIME.size, 0.02))
    made = inputs(theory, true)
    less = replace(made, oxidizer=0.98 * made.oxidizer, errors={**made.errors, "flow": of_flow})
    found = courses(less, theory)
    band = np.quantile(found.oxidizer[25], (0.025, 0.975))
    assert band[0] < FLOW < band[1]


def test_a_chamber_that_gives_off_more_than_enters_and_leaves_is_refused(theory: Theory) -> None:
    """As with a chamber stated ten times as wide: what it stores outweighs what passes."""
    made = inputs(theory, np.full(TIME.size, 8.0))
    stored = np.where(np.arange(TIME.size) == 25, -1.0, 0.0)
    with pytest.raises(AbsentError, match="falls faster than its volume lets it"):
        courses(replace(made, stored=stored), theory)


def test_a_burn_in_which_nothing_flows_for_a_while_is_refused_with_the_instant(theory: Theory) -> None:
    made = inputs(theory, np.full(TIME.size, 8.0))
    flow = np.where(np.arange(TIME.size) == 25, 0.0, made.oxidizer)
    with pytest.raises(AbsentError, match=r"nothing passes the injector at 3\.00 s"):
        courses(replace(made, oxidizer=flow), theory)
