"""How long the end of the fuel takes in a model, as against a measured fall of chamber pressure and thrust."""

from __future__ import annotations

from math import log, pi

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
    return log(max(seconds, abrupt_end(engine)) / _modelled(engine, speed))


def fade_slope(name: str, engine: Engine, speed: float) -> float:
    """Derivative of :func:`fade_misfit` with a parameter ``EFFECT.PARAMETER`` [SI]."""
    effect, _, parameter = name.partition(".")
    for active in engine.effects:
        if active.effect.name == effect and active.effect.fading_web is not None:
            step = 1e-4 * next(p.typical for p in active.effect.parameters if p.name == parameter)
            more = active.named | {parameter: active.named[parameter] + step}
            wider = active.effect.fading_web(more) - active.effect.fading_web(active.named)
            return -wider / step / speed / _modelled(engine, speed)
    return 0.0


def _modelled(engine: Engine, speed: float) -> float:
    """Seconds in which the fire of a model goes out."""
    webs = [a.effect.fading_web(a.named) for a in engine.effects if a.effect.fading_web is not None]
    return abrupt_end(engine) + sum(webs) / speed
