"""How long the end of the fuel takes in a model, as against a measured fall of chamber pressure and thrust."""

from __future__ import annotations

from math import log, pi

from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Engine

FALL = 2.2
"""Time constants in which something that decays falls from 90 to 10 %."""

CHARACTERISTIC_VELOCITY, CHOKED_FLOW = 1500.0, 0.42
"""Typical c* [m/s] of nitrous oxide and paraffin, and the square of Vandenkerckhove's function of its gas."""


def abrupt_end(engine: Engine) -> float:
    """Seconds in which a chamber without fuel empties through its throat: V / (A c*), Sutton and Biblarz, chapter 6."""
    volume = engine.dead_volume + pi * engine.outer_radius**2 * engine.grain_length
    return FALL * volume / (engine.throat_area * CHOKED_FLOW * CHARACTERISTIC_VELOCITY)


def fade_misfit(seconds: float, engine: Engine, speed: float) -> float:
    """Log of the measured over the modelled time in which the fire goes out; 0 for falls faster than an abrupt one.

    ``speed``: typical regression [m/s].
    """
    abrupt = abrupt_end(engine)
    return log(max(seconds, abrupt) / (abrupt + sum(_fading_web(active) for active in engine.effects) / speed))


def fade_slope(name: str, engine: Engine, speed: float) -> float:
    """Derivative of :func:`fade_misfit` with a parameter ``EFFECT.PARAMETER`` [SI]."""
    total = abrupt_end(engine) + sum(_fading_web(active) for active in engine.effects) / speed
    effect, _, parameter = name.partition(".")
    for active in engine.effects:
        if active.effect.name == effect and active.effect.fading_web is not None:
            step = 1e-4 * next(p.typical for p in active.effect.parameters if p.name == parameter)
            more = active.named | {parameter: active.named[parameter] + step}
            return -(active.effect.fading_web(more) - active.effect.fading_web(active.named)) / step / speed / total
    return 0.0


def _fading_web(active: Active) -> float:
    """Web [m] over which the burning surface fades at last."""
    shape = active.effect.fading_web
    return shape(active.named) if shape is not None else 0.0
