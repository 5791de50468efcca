"""Tangents of a run for named parameters: of an engine's numbers and of its effects'."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.engine import tangents
from hfanalysis.engine.effect import Active, compose
from hfanalysis.engine.equations import OUTPUTS, STATES
from hfanalysis.engine.phases import SCALES
from hfanalysis.engine.unsteady import ACCURACY, Burn, Engine, burn, constants, initial

ENGINE_PARAMETERS = {
    "volume": 1e-2,
    "area": 1e-5,
    "loss_factor": 1e8,
    "polytropic_exponent": 1.0,
    "oxidizer_mass": 1.0,
    "temperature": 100.0,
    "fuel_mass": 1.0,
    "grain_length": 0.1,
    "outer_radius": 0.01,
    "fuel_density": 100.0,
    "a": 1e-4,
    "n": 0.5,
    "dead_volume": 1e-3,
    "throat_area": 1e-3,
    "exit_area": 1e-3,
    "ambient_pressure": 1e5,
}
"""Numbers of an engine that can be a parameter, with what counts as large of each [SI]."""

SHIFT = 1e-6
"""By how much a parameter is moved for its difference quotient, relative to what counts as large [-]."""


@dataclass(frozen=True)
class Tangents:
    """A run and its sensitivities to ``parameters``.

    ``states`` (n, 4, states, parameters) and ``outputs`` (n, 4, outputs, parameters) on four nodes of each of the
    solver's n steps; ``liquid_out`` and ``burn_time`` (parameters,), NaN where the event does not take place.
    """

    burn: Burn
    parameters: tuple[str, ...]
    states: Array
    outputs: Array
    moments: Array

    def output(self, name: str, times: ArrayLike) -> Array:
        """Sensitivities (times, parameters) of one of OUTPUTS, or "impulse", at increasing times [s]."""
        where = np.ascontiguousarray(times, dtype=np.float64)
        source, row = (self.outputs, OUTPUTS.index(name)) if name in OUTPUTS else (self.states, STATES.index(name))
        return tangents.at_times(where, self.burn.steps.times, source[:, :, row : row + 1])[:, 0]

    def event(self, number: int) -> Array:
        """Sensitivities (parameters,) of the time [s] of an event of :mod:`hfanalysis.engine.phases`; NaN where there
        is none."""
        at = np.flatnonzero(self.burn.steps.events == number)
        return self.moments[at[-1]] if at.size else np.full(len(self.parameters), np.nan)


def shifted(engine: Engine, name: str) -> tuple[Engine, float]:
    """The engine with one parameter moved a little, and by how much [SI].

    ``name`` is one of ENGINE_PARAMETERS, or "EFFECT.PARAMETER" of an effect the engine has. Raises ValueError for
    others.
    """
    if "." in name:
        return _shifted_effect(engine, *name.split(".", 1))
    if name not in ENGINE_PARAMETERS:
        raise ValueError(f"{name!r} is no parameter of an engine; there are {sorted(ENGINE_PARAMETERS)}")
    step = SHIFT * ENGINE_PARAMETERS[name]
    if name in ("volume", "area", "loss_factor"):
        return replace(engine, feed=replace(engine.feed, **{name: getattr(engine.feed, name) + step})), step
    value = getattr(engine, name)
    if value is None:
        raise ValueError(f"{name} of this engine is not a number")
    return replace(engine, **{name: value + step}), step


def _shifted_effect(engine: Engine, effect: str, parameter: str) -> tuple[Engine, float]:
    moved, step = [], 0.0
    for active in engine.effects:
        if active.effect.name != effect:
            moved.append(active)
            continue
        names = [p.name for p in active.effect.parameters]
        where = names.index(parameter)
        step = SHIFT * active.effect.parameters[where].typical
        values = tuple(v + step if i == where else v for i, v in enumerate(active.values))
        moved.append(Active(active.effect, values))
    if step == 0.0:
        raise ValueError(f"the engine has no effect {effect!r} with a parameter {parameter!r}")
    return replace(engine, effects=tuple(moved)), step


NEVER = (np.inf, -np.inf)
"""When a parameter acts that only says where a run begins."""


def _acting(engine: Engine, name: str) -> tuple[float, float]:
    """From when to when a parameter changes anything [s]."""
    if "." not in name:
        return -np.inf, np.inf
    effect, parameter = name.split(".", 1)
    active = next(a for a in engine.effects if a.effect.name == effect)
    return next(p.acting for p in active.effect.parameters if p.name == parameter)


def run_with_tangents(
    engine: Engine,
    parameters: Sequence[str],
    longest: float = 120.0,
    rtol: float = ACCURACY,
    run_on: bool = False,
    times: Sequence[float] | Array | None = None,
) -> Tangents:
    """A run (as :func:`hfanalysis.engine.unsteady.burn`) and its sensitivities to ``parameters`` [SI].

    ``longest`` [s]; ``times`` (n,) [s]. Parameters of effects at strength 0 are allowed: their terms act with that
    strength. Raises ValueError for an engine that cannot be and for names that are none of its parameters,
    ArithmeticError where the solver gives up.
    """
    return tangents_of(burn(engine, longest, rtol, run_on, times, keep_idle=True), parameters)


def tangents_of(done: Burn, parameters: Sequence[str]) -> Tangents:
    """The sensitivities of a run, which has to have kept effects of strength 0, to ``parameters``."""
    engine, composition = done.steps.engine, done.steps.composition
    y = done.steps.begin[0]
    constant_rows, steps, acting, start = [], [], [], []
    for name in parameters:
        moved, step = shifted(engine, name)
        other = compose(moved.effects, constants(moved), len(STATES), idle=True)
        constant_rows.append(other.constants)
        steps.append(step)
        same = np.array_equal(other.constants, composition.constants, equal_nan=True)
        acting.append(NEVER if same else _acting(engine, name))
        start.append((initial(moved, other) - y) / step)
    scales = np.concatenate([SCALES, composition.scales])
    shifted_constants = np.array(constant_rows).reshape(len(steps), composition.constants.size)
    equations, moved_start = engine.equations(composition), np.ascontiguousarray(np.array(start).T)
    found = tangents.propagate(
        done.steps.history,
        equations,
        shifted_constants,
        np.array(steps),
        np.array(acting, dtype=np.float64).reshape(len(steps), 2),
        scales,
        moved_start,
    )
    return Tangents(done, tuple(parameters), *found)
