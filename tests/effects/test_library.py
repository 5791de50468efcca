"""What every effect of the library must keep, and what the two tank effects do."""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect, library
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Burn, burn

Array = NDArray[np.float64]

SECONDS = 10.0
WITH_TERMS = [name for name, found in library().items() if found.term is not None]


@cache
def base() -> Burn:
    return burn(engine_on_stand(), SECONDS, run_on=True)


def with_effects(*active: Active) -> Burn:
    return burn(engine_on_stand(effects=active), SECONDS, run_on=True)


def typical(name: str) -> Active:
    """The effect at its typical strength."""
    strength = effect(name).strength
    return effect(name).at(**{strength.name: strength.typical})


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


def test_composing_is_free_of_order() -> None:
    chosen = [typical(name) for name in WITH_TERMS][:4]
    runs = [with_effects(*order) for order in permutations(chosen)]
    assert all(np.array_equal(run.states, runs[0].states) for run in runs)


def test_an_effect_named_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="twice"):
        with_effects(typical("tank_heat"), typical("tank_heat"))


@pytest.mark.parametrize("name", WITH_TERMS)
def test_every_effect_says_what_it_is(name: str) -> None:
    found = effect(name)
    assert found.meaning
    assert found.reference
    assert found.decisive
    assert found.phases
    assert found.strength.center == 0.0
    assert found.strength.typical > 0.0
    assert found.strength.low <= 0.0 <= found.strength.high


def test_an_unknown_effect_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="n2_purge"):
        effect("gremlins")


def test_a_parameter_that_an_effect_does_not_have_is_refused() -> None:
    with pytest.raises(ValueError, match="power"):
        effect("tank_heat").at(watts=3.0)


def test_heat_keeps_the_tank_warmer_by_the_energy_it_brings() -> None:
    """Before anything flows much: m c dT = Q t, with the saturated tank's own heat capacity."""
    from hfanalysis.engine.tank import energy_derivatives

    warm, plain = with_effects(effect("tank_heat").at(power=2000.0)), base()
    at = np.array([0.2])
    gain = warm.steps.at(at)[0][0, 1] - plain.steps.at(at)[0][0, 1]
    engine = engine_on_stand()
    _, by_temperature, _ = energy_derivatives(engine.saturation.kernel_table, 16.5e-3, 8.2, 292.6)
    assert gain == pytest.approx(2000.0 * 0.2 / by_temperature, rel=0.02)


def test_nitrogen_enters_from_the_opening_on_and_is_conserved() -> None:
    opening = effect("n2_purge").at(area=4e-6, supply_pressure=35e5)
    found = with_effects(opening)
    pressure, inflow = found.output("tank_pressure"), found.output("nitrogen_inflow")
    assert (inflow[pressure > (35e5 - 4.27e5)] == 0.0).all()
    assert inflow[-1] > 0.0
    held = found.state("tank_nitrogen")[-1]
    entered = np.trapezoid(inflow, found.time)
    left = np.trapezoid(found.output("oxidizer_flow") * found.output("nitrogen_share"), found.time)
    assert held + left == pytest.approx(entered, rel=2e-3)
    assert held > 0.0
