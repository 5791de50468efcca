"""Tangents of every effect against differences of whole runs, through events, at strength 0 and at a typical one."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.effects.runs import OF_SENSORS, WITH_TERMS
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect, library
from hfanalysis.effects.chamber_tap_lag import lagged
from hfanalysis.effects.load_cell_drift import REFERENCE, heat_clock
from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import CHANNELS, observe, observe_tangents
from hfanalysis.engine.sensitivity import Tangents, run_with_tangents
from hfanalysis.engine.unsteady import Burn, burn

Array = NDArray[np.float64]

SECONDS = 9.0
GRID = np.linspace(0.01, SECONDS, 900)
STEP = 1e-3
"""Of what is typical: the difference between runs."""

CARBON_APPEARS = 3.07
"""O/F at which the gas table has a corner; a step of the solver may straddle it."""

SETTINGS = {"n2_purge": {"supply_pressure": 35e5}, "pressure_transducer_offset": {}}
PARAMETERS = [(name, p.name) for name, found in library().items() for p in found.parameters]


def active(name: str, share: float) -> Active:
    """The effect at a share of its typical strength (every strength, where it has several)."""
    found = effect(name)
    strengths = {p.name: share * p.typical for p in found.parameters[: found.strengths]}
    return found.at(**{**SETTINGS.get(name, {}), **strengths})


@cache
def tangents(name: str, share: float) -> Tangents:
    engine = engine_on_stand(effects=(active(name, share),))
    names = [f"{name}.{p.name}" for p in effect(name).parameters]
    return run_with_tangents(engine, names, SECONDS, rtol=1e-6, run_on=True, times=GRID)


def run(moved: Active) -> Burn:
    engine = engine_on_stand(effects=(moved,))
    return burn(engine, SECONDS, rtol=1e-8, run_on=True, times=GRID, keep_idle=True)


def moved(name: str, parameter: str, share: float, by: float) -> Active:
    found = active(name, share)
    names = [p.name for p in found.effect.parameters]
    values = list(found.values)
    values[names.index(parameter)] += by
    return replace(found, values=tuple(values))


def quiet(found: Burn) -> Array:
    """An event's own motion makes a spike in a difference quotient that is no sensitivity at a time."""
    keep = np.ones(GRID.size, dtype=bool)
    for at in found.steps.times[found.steps.events >= 0, 1]:
        keep &= np.abs(GRID - at) > 0.06
    return keep & (np.abs(found.output("of_ratio") - CARBON_APPEARS) > 0.03)


def agree(tangent: dict[str, Array], quotient: dict[str, Array], span: dict[str, float], keep: Array) -> None:
    for channel in CHANNELS:
        expected = quotient[channel][keep]
        # a difference of runs at the tolerance 1e-8 sees nothing smaller
        allowed = 5e-3 * np.abs(expected).max() + span[channel]
        assert np.abs(tangent[channel][keep, 0] - expected).max() < allowed, channel


def of_parameter(found: Tangents, name: str, parameter: str) -> dict[str, Array]:
    column = found.parameters.index(f"{name}.{parameter}")
    return {k: v[:, column : column + 1] for k, v in observe_tangents(found, GRID).items()}


@pytest.mark.parametrize(("name", "parameter"), PARAMETERS)
def test_tangents_at_a_typical_strength_are_the_differences_of_runs(name: str, parameter: str) -> None:
    scale = next(p.typical for p in effect(name).parameters if p.name == parameter)
    # half the typical strength leaves room on both sides of bounded weights
    up, down = (observe(run(moved(name, parameter, 0.5, sign * STEP * scale)), GRID) for sign in (1.0, -1.0))
    quotient = {k: (up[k] - down[k]) / (2.0 * STEP * scale) for k in CHANNELS}
    visible = {k: 1e-4 * float(np.ptp(up[k])) / scale for k in CHANNELS}
    found = tangents(name, 0.5)
    agree(of_parameter(found, name, parameter), quotient, visible, quiet(found.burn))


@pytest.mark.parametrize("name", [*WITH_TERMS, *OF_SENSORS])
def test_tangents_at_strength_zero_are_the_one_sided_differences_of_runs(name: str) -> None:
    strength = effect(name).strength
    step = STEP * strength.typical
    at = [observe(run(moved(name, strength.name, 0.0, k * step)), GRID) for k in (0, 1, 2)]
    quotient = {k: (4.0 * at[1][k] - 3.0 * at[0][k] - at[2][k]) / (2.0 * step) for k in CHANNELS}
    visible = {k: 1e-4 * float(np.ptp(at[0][k])) / strength.typical for k in CHANNELS}
    found = tangents(name, 0.0)
    slopes = of_parameter(found, name, strength.name)
    agree(slopes, quotient, visible, quiet(found.burn))
    assert max(float(np.abs(slopes[k]).max()) * strength.typical / np.ptp(at[0][k]) for k in CHANNELS) > 1e-3


def test_a_distortion_passes_on_the_engines_tangents() -> None:
    """What a lagging sensor sees of a larger injector is the lagged change, to which its own lag adds nothing."""
    lag, drift = (
        effect("chamber_tap_lag").at(lag=0.05, thinning=0.0),
        effect("load_cell_drift").at(drift=200.0, exponent=1.0),
    )
    engine = engine_on_stand(effects=(lag, drift))
    found = run_with_tangents(engine, ["area", "load_cell_drift.time"], SECONDS, rtol=1e-6, run_on=True, times=GRID)
    slopes = observe_tangents(found, GRID)
    alone = observe_tangents(found, GRID, [])
    late = lagged(GRID, alone["p_chamber"][:, 0].copy(), np.full(GRID.size, 0.05))
    assert slopes["p_chamber"][:, 0] == pytest.approx(late, rel=1e-4)
    read = observe(found.burn, GRID, [lag])["p_chamber"]
    heat = heat_clock(GRID, read, 1.0)
    more = np.concatenate([[0.0], np.cumsum(0.5 * (late[1:] + late[:-1]) * np.diff(GRID))]) / REFERENCE
    warmer = 200.0 / 10.0 * np.exp(-heat / 10.0) * more
    assert slopes["thrust"][:, 0] - alone["thrust"][:, 0] == pytest.approx(warmer, abs=3e-3 * np.abs(warmer).max())
    expected = -200.0 * heat / 10.0**2 * np.exp(-heat / 10.0)
    assert slopes["thrust"][:, 1] == pytest.approx(expected, rel=1e-3, abs=1e-3)
    assert not slopes["p_tank"][:, 1].any()
