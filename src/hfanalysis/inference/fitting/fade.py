"""How long the end of the fuel takes in a model, as against a measured fall of chamber pressure and thrust."""

from __future__ import annotations

from dataclasses import replace
from math import log

import numpy as np

from hfanalysis.engine.chamber import chamber_volume
from hfanalysis.engine.observe import true_channels
from hfanalysis.engine.unsteady import Engine, burn
from hfanalysis.inference.observations.burn_out import AFTER, about, fall_of
from hfanalysis.inference.observations.observed import FADE, Observed
from hfanalysis.inference.observations.recorded import TOGETHER
from hfanalysis.record.signals import Signal

FALL = 2.2
"""Time constants in which something that decays falls from 90 to 10 %. Source: ln 9."""

CHARACTERISTIC_VELOCITY, CHOKED_FLOW = 1500.0, 0.42
"""Typical c* of nitrous oxide and paraffin [m/s], and the square of Vandenkerckhove's function Gamma of its gas [-].
Source: Gamma^2 = gamma (2/(gamma + 1))^((gamma + 1)/(gamma - 1)) is 0.42 at gamma = 1.2."""

FARTHEST_MISFIT = 6.0
"""Standard deviations beyond which a slow fall says no more: it may have a reason that nobody thought of."""

FALL_STEP = 1e-3
"""Seconds between the readings at which a model's fall is timed."""


def with_abrupt_end(observed: Observed, engine: Engine) -> Observed:
    """The observations with the time in which chamber pressure and thrust of an engine fall whose fire is out at once.

    It is timed in a run as it is in the samples; an engine that cannot be run, or does not burn up to the measured end
    of the fuel, leaves it open. The times are in seconds.
    """
    if FADE not in observed.stated:
        return observed
    gone = observed.events["t_fuel_out"][0]
    ends_at_once = replace(engine, effects=(), spare_web=engine.outer_radius, fuel_end=gone)
    try:
        burnt = burn(ends_at_once, gone + 2.0 * AFTER, run_on=True, keep_idle=True)
    except (ValueError, ArithmeticError):
        return observed
    start, end = about(gone, burnt.liquid_out)
    time = np.arange(max(start, 0.0), min(end, float(burnt.steps.times[-1, 1])), FALL_STEP)
    read = true_channels(burnt, time)
    falls = [fall_of(Signal(name, time, read[name], 0.0, FALL_STEP), gone) for name in TOGETHER]
    known = [seconds for seconds in falls if seconds is not None]
    return replace(observed, abrupt=min(known)) if len(known) == len(falls) else observed


def bounded(misfit: float) -> tuple[float, float]:
    """A misfit in standard deviations that nears FARTHEST_MISFIT as it grows, and its slope [-]: one number proves no
    name.

    >>> [round(part, 3) for part in bounded(1.0)], [round(part, 3) for part in bounded(100.0)]
    ([1.0, 0.999], [6.0, 0.0])
    """
    grown = 1.0 + (misfit / FARTHEST_MISFIT) ** 4
    return misfit / grown**0.25, grown**-1.25


def abrupt(observed: Observed, engine: Engine) -> float:
    """Time [s] in which a fire that is out at once fades: as a run was timed, else as the chamber empties."""
    return observed.abrupt if observed.abrupt is not None else abrupt_end(engine)


def abrupt_end(engine: Engine) -> float:
    """Time [s] in which the pressure of a chamber without fuel falls from 90 to 10 % through its throat.

    A chamber of volume V empties as exp(-t/tau) with tau = V / (A Gamma^2 c*), for p V = m R T and mdot = p A / c* with
    c* = sqrt(R T) / Gamma (Sutton and Biblarz, chapter 3).
    """
    volume = chamber_volume(engine.dead_volume, engine.outer_radius, engine.grain_length)
    return FALL * float(volume) / (engine.throat_area * CHOKED_FLOW * CHARACTERISTIC_VELOCITY)


def fade_misfit(seconds: float, abrupt: float, engine: Engine, speed: float) -> float:
    """Log of the measured over the modelled time in which the fire goes out [-]; 0 for falls faster than an ``abrupt``
    one.

    ``seconds``: the measured time [s]; ``abrupt`` [s]: that of a fire which is out at once; ``speed``: regression at
    the end [m/s].
    """
    return log(max(seconds, abrupt) / _modelled(abrupt, engine, speed))


def fade_slope(name: str, abrupt: float, engine: Engine, speed: float) -> float:
    """Derivative of :func:`fade_misfit` [1/SI] with a parameter ``EFFECT.PARAMETER`` [SI]; ``abrupt`` [s], ``speed``
    [m/s] as there."""
    effect, _, parameter = name.partition(".")
    for active in engine.effects:
        if active.effect.name == effect and active.effect.fading_web is not None:
            step = 1e-4 * next(p.typical for p in active.effect.parameters if p.name == parameter)
            less, more = (
                active.effect.fading_web(active.named | {parameter: active.named[parameter] + side * step})
                for side in (-1.0, 1.0)
            )
            return -(more - less) / (2.0 * step) / speed / _modelled(abrupt, engine, speed)
    return 0.0


def _modelled(abrupt: float, engine: Engine, speed: float) -> float:
    """Seconds in which the fire of a model goes out."""
    webs = [a.effect.fading_web(a.named) for a in engine.effects if a.effect.fading_web is not None]
    return abrupt + sum(webs) / speed
