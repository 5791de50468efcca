"""Tangents against differences of whole runs, through the end of the liquid, of the fuel, and an opening valve."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine import sensitivity
from hfanalysis.engine.phases import FUEL_OUT, LIQUID_OUT, SHOCK
from hfanalysis.engine.sensitivity import ENGINE_PARAMETERS, Tangents, run_with_tangents
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.splines import Splines, probe

Array = NDArray[np.float64]

SECONDS = 12.0
SHIFT = 1e-4
"""Of what is typical: half the difference between runs."""
GRID = np.linspace(0.01, SECONDS, 1200)
CHANNELS = ("tank_pressure", "run_pressure", "chamber_pressure", "thrust")
OF_EFFECTS = ("tank_heat.power", "n2_purge.area", "n2_purge.supply_pressure", "n2_purge.cracking_pressure")
TYPICAL = {f"{name}.{p.name}": p.typical for name in ("tank_heat", "n2_purge") for p in effect(name).parameters}


@cache
def heated_and_purged() -> Engine:
    return engine_on_stand(
        effects=(effect("tank_heat").at(power=500.0), effect("n2_purge").at(area=4e-6, supply_pressure=35e5))
    )


@cache
def tangents() -> Tangents:
    names = (*ENGINE_PARAMETERS, *OF_EFFECTS)
    return run_with_tangents(heated_and_purged(), names, SECONDS, rtol=1e-6, run_on=True, times=GRID)


def differences(engine: Engine, name: str, times: Array = GRID) -> tuple[Burn, Burn, float]:
    """Two whole runs with the parameter moved up and down, and by how much they lie apart."""
    runs = []
    for sign in (1.0, -1.0):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sensitivity, "SHIFT", sign * SHIFT)
            moved, _ = sensitivity.shifted(engine, name)
        runs.append(burn(moved, SECONDS, rtol=1e-8, run_on=True, times=times))
    return runs[0], runs[1], 2.0 * SHIFT * {**ENGINE_PARAMETERS, **TYPICAL}[name]


def away_from_events() -> Array:
    """An event's own motion makes a spike in a difference quotient that is no sensitivity at a time."""
    found = np.ones(GRID.size, dtype=bool)
    steps = tangents().burn.steps
    for at in steps.times[steps.events >= 0, 1]:
        found &= np.abs(GRID - at) > 0.06
    return found


@pytest.mark.parametrize("name", [*ENGINE_PARAMETERS, *OF_EFFECTS])
def test_tangents_are_the_differences_of_runs(name: str) -> None:
    up, down, apart = differences(heated_and_purged(), name)
    column, quiet = tangents().parameters.index(name), away_from_events()
    for channel in CHANNELS:
        quotient = ((up.output(channel) - down.output(channel)) / apart)[quiet]
        tangent = tangents().output(channel, GRID)[quiet, column]
        # a difference of two runs at the tolerance 1e-8 sees nothing smaller
        visible = 1e-4 * np.ptp(up.output(channel)) / {**ENGINE_PARAMETERS, **TYPICAL}[name]
        assert np.abs(tangent - quotient).max() < 5e-3 * np.abs(quotient).max() + visible


@pytest.mark.parametrize("name", ["area", "oxidizer_mass", "temperature", "a", "n", "tank_heat.power"])
def test_the_times_of_events_move_as_tangents_say(name: str) -> None:
    up, down, apart = differences(heated_and_purged(), name)
    column = tangents().parameters.index(name)
    assert up.liquid_out is not None
    assert down.liquid_out is not None
    liquid, fuel = (up.liquid_out - down.liquid_out) / apart, (up.burn_time - down.burn_time) / apart
    assert tangents().event(LIQUID_OUT)[column] == pytest.approx(liquid, rel=1e-3)
    assert tangents().event(FUEL_OUT)[column] == pytest.approx(fuel, rel=1e-3)


@pytest.mark.parametrize("name", ["area", "a", "tank_heat.power"])
def test_a_fire_that_is_out_at_a_given_time_has_tangents_beyond_it(name: str) -> None:
    out = 4.0
    engine = replace(heated_and_purged(), spare_web=0.05, fuel_end=out)
    found = run_with_tangents(engine, [name], SECONDS, rtol=1e-6, run_on=True, times=GRID)
    assert found.burn.burn_time == pytest.approx(out, abs=1e-9)
    assert found.event(FUEL_OUT)[0] == 0.0
    assert np.ptp(found.burn.state("port_radius")[out < GRID]) < 1e-12
    up, down, apart = differences(engine, name)
    for channel in ("tank_pressure", "run_pressure"):
        quotient = (up.output(channel) - down.output(channel)) / apart
        beyond = out + 0.06 < GRID
        beyond &= np.abs(GRID - (found.burn.liquid_out or 0.0)) > 0.06
        tangent = found.output(channel, GRID)[:, 0]
        assert np.abs(tangent - quotient)[beyond].max() < 0.02 * np.abs(quotient[beyond]).max()


@pytest.mark.parametrize("name", ["a", "temperature"])
def test_thrust_has_exact_tangents_on_either_side_of_a_shock_that_enters_the_nozzle(name: str) -> None:
    """Its slope over the chamber's pressure changes at once there; a step across it would smear that over the step."""
    engine = replace(engine_on_stand(), spare_web=0.05)
    steps = burn(engine, SECONDS, 1e-6, True).steps
    enters = float(steps.times[steps.events == SHOCK, 1][-1])
    beside = enters + np.array([-0.1, -0.05, -0.02, -0.01, 0.01, 0.02, 0.05, 0.1])
    found = run_with_tangents(engine, [name], SECONDS, rtol=1e-6, run_on=True, times=beside)
    up, down, apart = differences(engine, name, beside)
    quotient = (up.output("thrust") - down.output("thrust")) / apart
    assert abs(quotient[3] - quotient[4]) > 0.3 * abs(quotient[3])
    assert found.output("thrust", beside)[:, 0] == pytest.approx(quotient, rel=0.01)


def test_an_effect_of_strength_zero_has_a_tangent() -> None:
    idle = engine_on_stand(effects=(effect("tank_heat").at(power=0.0),))
    found = run_with_tangents(idle, ["tank_heat.power"], SECONDS, run_on=True)
    warmer = burn(replace(idle, effects=(effect("tank_heat").at(power=1.0),)), SECONDS, 1e-8, True, times=GRID)
    base = burn(idle, SECONDS, 1e-8, True, times=GRID)
    wet = base.liquid_out or 0.0
    before = wet - 0.05 > GRID
    expected = warmer.output("tank_pressure") - base.output("tank_pressure")
    assert found.output("tank_pressure", GRID)[before, 0] == pytest.approx(expected[before], rel=2e-3, abs=1e-3)


def test_slopes_of_what_acts_for_a_while_are_the_same_where_it_is_asked_for_all_the_time() -> None:
    """A coefficient of a spline out of its reach, and what only says where a run begins, cost nothing and are exact."""
    source = probe("tank_heat", Splines.over(0.0, SECONDS, 1.0), 2000.0)
    everywhere = replace(source, parameters=tuple(replace(p, acting=(-np.inf, np.inf)) for p in source.parameters))
    names = ("oxidizer_mass", "a", *(f"probe_tank_heat.c{i}" for i in range(12)))
    sparing, whole = (
        run_with_tangents(engine_on_stand(effects=(e.at(on=1.0, c3=900.0),)), names, SECONDS, run_on=True)
        for e in (source, everywhere)
    )
    assert np.array_equal(sparing.states, whole.states)
    assert np.array_equal(sparing.outputs, whole.outputs)
    assert np.array_equal(sparing.moments, whole.moments)
    assert np.abs(whole.states[..., names.index("probe_tank_heat.c5")]).max() > 0.0
    reach = {p.name: p.acting for p in source.parameters}["c5"]
    assert 0.0 < reach[0] < reach[1] < SECONDS


def test_an_unknown_parameter_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="throat_area"):
        run_with_tangents(engine_on_stand(), ["throat"])
    with pytest.raises(ValueError, match="no effect 'tank_heat'"):
        run_with_tangents(engine_on_stand(), ["tank_heat.power"])
