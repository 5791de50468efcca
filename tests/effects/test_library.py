"""What every effect of the library must keep."""

from __future__ import annotations

from collections.abc import Iterator
from ctypes import POINTER, c_double
from dataclasses import replace
from itertools import product
from math import pi
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.effects.runs import SECONDS, WITH_TERMS, base, typical, with_effects
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect, library
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import OUTPUTS, STATES
from hfanalysis.engine.model import neutral
from hfanalysis.engine.sites import AT_CHAMBER, AT_FLOW, AT_TANK, ENVIRONMENT, HOOK_OF_SITE, RATES, SITES
from hfanalysis.engine.unsteady import Burn, burn, constants

Array = NDArray[np.float64]


@pytest.mark.parametrize("name", WITH_TERMS)
def test_strength_zero_is_the_base_model_to_the_last_bit(name: str) -> None:
    found = with_effects(effect(name).at(**{effect(name).strength.name: 0.0}))
    assert np.array_equal(found.time, base().time)
    assert np.array_equal(found.states, base().states)
    assert np.array_equal(found.outputs, base().outputs)


@pytest.mark.parametrize("name", WITH_TERMS)
def test_a_term_that_acts_with_strength_zero_changes_nothing(name: str) -> None:
    idle = engine_on_stand(effects=(effect(name).at(**{effect(name).strength.name: 0.0}),))
    grid = np.linspace(0.0, SECONDS, 500)
    kept = burn(idle, SECONDS, 1e-8, True, times=grid, keep_idle=True)
    plain = burn(engine_on_stand(), SECONDS, 1e-8, True, times=grid)
    span = np.ptp(plain.outputs, axis=0) + 1e-9
    assert (np.abs(kept.outputs - plain.outputs) / span).max() < 1e-4


@pytest.mark.parametrize("name", WITH_TERMS)
def test_a_typical_strength_is_seen(name: str) -> None:
    found = with_effects(typical(name))
    grid = np.linspace(0.05, SECONDS, 200)
    moved = np.abs(found.steps.at(grid)[1] - base().steps.at(grid)[1]).max(axis=0)
    assert (moved > 1e-3 * np.ptp(base().outputs, axis=0)).any()


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.lists(st.sampled_from(WITH_TERMS), min_size=2, max_size=5, unique=True), st.randoms(use_true_random=False))
def test_composing_is_free_of_order(names: list[str], chance: Random) -> None:
    chosen = [half_typical(name) for name in names]
    shuffled = chosen.copy()
    chance.shuffle(shuffled)
    one, other = with_effects(*chosen), with_effects(*shuffled)
    assert np.array_equal(one.states, other.states)
    assert np.array_equal(one.outputs, other.outputs)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.lists(st.sampled_from(WITH_TERMS), min_size=2, max_size=5, unique=True))
def test_any_subset_conserves_mass(names: list[str]) -> None:
    found = with_effects(*(half_typical(name) for name in names), rtol=1e-8)
    assert mass_unaccounted_for(found) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", WITH_TERMS)
def test_mass_is_conserved(name: str) -> None:
    found = with_effects(typical(name), rtol=1e-8)
    assert mass_unaccounted_for(found) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", WITH_TERMS)
def test_every_effect_fits_an_engine_with_the_reports_constant_losses(name: str) -> None:
    feed = replace(engine_on_stand().feed, loss_factor=0.0, constant_losses=(12e5, 8e5))
    found = with_effects(typical(name), rtol=1e-8, feed=feed)
    assert np.isfinite(found.outputs).all()
    assert mass_unaccounted_for(found) == pytest.approx(0.0, abs=1e-6)


def half_typical(name: str) -> Active:
    strength = effect(name).strength
    return effect(name).at(**{strength.name: 0.5 * strength.typical})


def mass_unaccounted_for(run: Burn) -> float:
    """Largest gap [kg] over time between what engine and effects hold and what came and went."""
    e = run.steps.engine
    own = [s.unit for a in run.steps.composition.active for s in a.effect.states]
    chamber = ("chamber_oxidizer", "chamber_fuel", "chamber_nitrogen", "cold_gas")
    stores = [STATES.index(name) for name in ("tank_mass", "tank_nitrogen", *chamber)]
    stores += [len(STATES) + k for k, unit in enumerate(own) if unit == "kg"]
    ends = run.steps.end
    fuel = e.fuel_density * pi * e.grain_length * (e.outer_radius**2 - ends[:, STATES.index("port_radius")] ** 2)
    start = run.steps.begin[0]
    held = ends[:, stores].sum(axis=1) + fuel - start[stores].sum() - e.fuel_mass
    return float(np.abs(held - np.cumsum(net_inflow(run))).max())


def net_inflow(run: Burn) -> Array:
    """What nitrogen line and nozzle bring and take over each step [kg], by Gauss's rule."""
    x, weights = np.polynomial.legendre.leggauss(5)
    times = run.steps.times
    length = times[:, 1:] - times[:, :1]
    at = times[:, :1] + 0.5 * length * (x + 1.0)
    outputs = run.steps.at(at.ravel())[1].reshape(*at.shape, len(OUTPUTS))
    flow = outputs[:, :, OUTPUTS.index("nitrogen_inflow")] - outputs[:, :, OUTPUTS.index("nozzle_flow")]
    return np.asarray((0.5 * length * weights * flow).sum(axis=1))


@pytest.mark.parametrize("name", WITH_TERMS)
def test_flows_never_reverse(name: str) -> None:
    found = with_effects(typical(name))
    for flow in ("oxidizer_flow", "fuel_flow", "nozzle_flow"):
        assert found.output(flow).min() >= 0.0


@pytest.mark.parametrize("name", WITH_TERMS)
def test_a_term_sets_the_sites_that_it_names_each_in_its_hook(name: str) -> None:
    touched = {hook: sites_set_by(name, hook) for hook in (AT_TANK, AT_CHAMBER, AT_FLOW, RATES)}
    for hook, sites in touched.items():
        assert all(HOOK_OF_SITE.get(site, RATES) == hook for site in sites)
    assert set().union(*touched.values()) == set(effect(name).sites)


def sites_set_by(name: str, hook: int) -> set[str]:
    """Sites that a term changes, over a liquid and a vapor phase, early and late in the grain."""
    active, engine = typical(name), engine_on_stand()
    c = constants(engine)
    own = np.array([s.start(engine, active.named) for s in active.effect.states] or [0.0])
    own[own == 0.0] = 0.01
    found = set()
    for values in environments(engine.outer_radius):
        before, after = np.empty(len(SITES)), np.empty(len(SITES))
        neutral(before)
        neutral(after)
        arrays = (values, c, np.array(active.values), own, after, np.zeros(own.size))
        active.effect.term.ctypes(hook, 0.3, *(a.ctypes.data_as(POINTER(c_double)) for a in arrays))
        found |= {SITES[i] for i in np.flatnonzero(before != after)}
    return found


def environments(outer_radius: float) -> Iterator[Array]:
    for liquid, port in product((1.0, 0.0), (0.6 * outer_radius, 0.999 * outer_radius)):
        here = {
            "is_liquid": liquid, "is_burning": 1.0, "p_ambient": 1e5, "p_tank": 30e5, "t_tank": 280.0, "m_tank": 5.0,
            "m_liquid": 4.0 * liquid, "rho_feed": 800.0 if liquid else 80.0, "p_chamber": 12e5, "rt_chamber": 9e5,
            "gamma_chamber": 1.25, "of_ratio": 4.0, "oxidizer_flow": 1.0, "fuel_flow": 0.25, "port_radius": port,
            "p_run": 25e5, "hot_share": 1.0,
        }  # fmt: skip
        yield np.array([here.get(name, 0.0) for name in ENVIRONMENT])


def test_an_effect_named_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="twice"):
        with_effects(typical("tank_heat"), typical("tank_heat"))


@pytest.mark.parametrize("name", library())
def test_every_effect_says_what_it_is(name: str) -> None:
    found = effect(name)
    assert found.meaning
    assert found.reference
    assert found.decisive
    assert found.phases
    assert found.formula
    assert found.sites
    assert found.strength.center == 0.0
    assert found.strength.typical > 0.0
    assert found.strength.low <= 0.0 <= found.strength.high
    assert all(name in effect(twin).twins for twin in found.twins)


@pytest.mark.parametrize("name", library())
def test_priors_lie_within_their_bounds(name: str) -> None:
    for p in effect(name).parameters:
        assert p.low <= p.center <= p.high
        assert p.typical > 0.0
        assert p.center + p.typical <= p.high


def test_an_unknown_effect_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="n2_purge"):
        effect("gremlins")


def test_a_parameter_that_an_effect_does_not_have_is_refused() -> None:
    with pytest.raises(ValueError, match="power"):
        effect("tank_heat").at(watts=3.0)
