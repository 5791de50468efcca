"""Runs of the stand's engine with and without effects, for the tests of the library."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect, library
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import OUTPUTS, STATES
from hfanalysis.engine.unsteady import Burn, burn

Array = NDArray[np.float64]

SECONDS = 10.0
WITH_TERMS = [name for name, found in library().items() if found.term is not None]
OF_SENSORS = [name for name, found in library().items() if found.of_sensor]


@cache
def base() -> Burn:
    return burn(engine_on_stand(), SECONDS, run_on=True)


def with_effects(*active: Active, rtol: float = 3e-5, **changes: object) -> Burn:
    return burn(engine_on_stand(effects=active, **changes), SECONDS, rtol, run_on=True)


def typical(name: str) -> Active:
    """The effect at its typical strength."""
    strength = effect(name).strength
    return effect(name).at(**{strength.name: strength.typical})


def only(name: str, **values: float) -> Burn:
    """A run with one effect, accurately."""
    return with_effects(effect(name).at(**values), rtol=1e-7)


@cache
def plain() -> Burn:
    """A run without effects, as accurate as :func:`only`."""
    return with_effects(rtol=1e-7)


def channel(run: Burn, name: str, at: float) -> float:
    """An output at a time."""
    states, outputs = run.steps.at(np.array([at]))
    if name in STATES:
        return float(states[0, STATES.index(name)])
    return float(outputs[0, OUTPUTS.index(name)])


def own_state(run: Burn, number: int, at: float) -> float:
    """A state that the run's effect brought along."""
    return float(run.steps.at(np.array([at]))[0][0, len(STATES) + number])
