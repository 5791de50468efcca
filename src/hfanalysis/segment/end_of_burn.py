"""t_end: the chamber's pressure is below 1.8 times ambient for good.

That is a level, no more: a nozzle with a diverging part stays choked down to 1.03 times ambient in one dimension, 1.05
to 1.3 with losses, and what burns may burn on.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.crossing import NODES, crossing, usual_noise
from hfanalysis.sentences import said, text

CRITICAL_RATIO = 1.80
"""p_c / p_a [-] of t_end. Source: ((gamma + 1)/2)^(gamma/(gamma - 1)), 1.77 to 1.83 for gamma of 1.2 to 1.3: where a
nozzle without a diverging part would unchoke."""

SMOOTH = 0.1
"""Seconds over which the chamber's pressure is smoothed for a first look."""

APART = 1.0
"""Seconds for which the chamber rests below before what comes then counts as no part of the burn: a purge."""

NEAR = 0.5
"""Seconds on either side from which the noise of a sample is judged."""

CLEAR = 4.0
"""Standard deviations by which neighbors are above and below, so that no noise made them so. Source: one in 30,000."""

WANDERS = (-10.0, -0.05)
"""Seconds before the opening from which a sensor's wander is known, where they are quiet."""

QUIET = (-3.0, -0.05)
"""Seconds before the opening from which the chamber's zero is known."""


def find_low_pressure(
    chamber: Signal, ambient: float, t_feed: float, offset: float = 0.0, bias: float = 0.0, noise: Noise | None = None
) -> tuple[float, float] | str:
    """t_end [s] and its standard deviation [s] from the chamber pressure with time from the opening; else the reason.

    ``ambient`` [Pa] is the air's, ``t_feed`` [s] from when on it is looked for, ``offset`` [Pa] how far the open
    chamber read from ambient, ``bias`` [Pa] the standard deviation of how the limit reads, ``noise`` the sensor's.
    """
    part = chamber.between(max(t_feed, 0.0), np.inf)
    if part.time.size < 8:
        return "the log ends before the chamber's pressure can fall"
    smooth = part.smooth(max(SMOOTH, 4.0 * chamber.step))
    limit = CRITICAL_RATIO * ambient + offset
    if not (smooth > limit).any():
        return "the chamber pressure never is above 1.8 times ambient"
    last = _last_of_burn(part.time, smooth - limit)
    if last >= smooth.size - 2:
        left = said(float(smooth[-1]) - offset, "bar", ".1f")
        return text("the log ends with {left} in the chamber, above 1.8 times ambient", left=left)
    rough = float(part.time[last])
    if (at_once := _at_once(part, rough, limit, bias)) is not None:
        return at_once
    quiet = chamber.between(QUIET[0], QUIET[1])
    noise = noise or Noise.of(chamber, quiet)
    since = float(quiet.time[0]) if quiet.time.size else QUIET[0]
    around = (rough - SMOOTH, rough + SMOOTH)
    wander = replace(noise, white=0.0).difference_std((since, QUIET[1]), around)
    zero = noise.white * np.sqrt(noise.step / (QUIET[1] - since))
    error = float(np.linalg.norm([wander, zero, bias]))
    limits = [one for one in limit + error * NODES if (smooth > one).any()]
    found = [_passes(part, float(part.time[_last_of_burn(part.time, smooth - one)]), one, noise) for one in limits]
    return _mean_of(np.array(found), part.step)


def _passes(part: Signal, rough: float, limit: float, noise: Noise) -> tuple[float, float]:
    """Where the pressure around ``rough`` [s] passes a limit [Pa] that is known, and its deviation [s]."""
    near = part.between(rough - NEAR, rough + NEAR).value
    return crossing(part, rough, limit, replace(noise, white=max(noise.white, usual_noise(near))))


def _mean_of(found: Array, step: float) -> tuple[float, float]:
    """Mean and deviation of instants, each with its own deviation, (k, 2) [s]: what the limit's error does to them."""
    mean = float(found[:, 0].mean())
    variance = float(((found[:, 0] - mean) ** 2).mean() + (found[:, 1] ** 2).mean())
    return mean, float(np.sqrt(variance + step**2 / 12.0))


def pulses_after(chamber: Signal, limit: float, t_end: float) -> list[tuple[float, float]]:
    """From when to when [s] the chamber stands above the ``limit`` [Pa] again after ``t_end`` [s]: gas that is blown
    through, no burn."""
    part = chamber.between(t_end + APART, np.inf)
    if part.time.size < 8:
        return []
    above = part.smooth(max(SMOOTH, 4.0 * chamber.step)) > limit
    return [
        (float(part.time[a]), float(part.time[b]))
        for a, b in _runs(part.time, above)
        if part.time[b] - part.time[a] > SMOOTH
    ]


def _runs(time: Array, above: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each stretch above, those closer than APART together as one."""
    index = np.flatnonzero(above)
    if not index.size:
        return []
    cuts = np.flatnonzero(np.diff(time[index]) > APART)
    return list(zip(index[np.r_[0, cuts + 1]], index[np.r_[cuts, index.size - 1]], strict=True))


def _last_of_burn(time: Array, excess: Array) -> int:
    """The index that best parts above from below, in the stretch that holds the most pressure over time.

    A slow fall crosses often by noise: the integral of the excess is largest where it really does.
    """
    runs = _runs(time, excess > 0.0)
    sizes = [float(np.trapezoid(excess[a : b + 1], time[a : b + 1])) for a, b in runs]
    first, last = runs[int(np.argmax(sizes))]
    if first == last:
        return first
    return first + int(np.argmax(np.cumsum(excess[first : last + 1] * np.gradient(time[first : last + 1]))))


def _at_once(part: Signal, rough: float, limit: float, bias: float) -> tuple[float, float] | None:
    """Between which two samples about ``rough`` [s] the limit [Pa] is passed, where both are clear of it; else None."""
    near = part.between(rough - 2.0 * SMOOTH, rough + 2.0 * SMOOTH)
    above = near.value > limit
    last = int(above.argmin()) - 1
    if last < 0 or above[last + 1 :].any():
        return None
    sides = near.value[last] - limit, limit - near.value[last + 1]
    if min(sides) < CLEAR * max(part.noise, bias):
        return None
    step = float(near.time[last + 1] - near.time[last])
    return float(near.time[last]) + 0.5 * step, step / float(np.sqrt(12.0))
