"""How the fire answers the feed, and what the thrust says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal, sample_noise

GRID = 0.01
"""Seconds from one value of the chamber's response to the next."""

SMOOTH = 0.03
"""Seconds over which the pressures are smoothed for it."""

WINDOW = 0.3
"""Seconds looked at on either side of a sudden fall."""

GAP = 0.04
"""Seconds left out on either side of it: the chamber empties and the smoothing spreads within these."""

LOWEST_EXCESS = 0.08e5
"""Chamber pressure above ambient [Pa] below which nothing can be said of the fire."""


@dataclass(frozen=True)
class Response:
    """(p_c - p_a) sqrt(median dp / dp) [Pa] on a grid of times, the scatter of a grid value, and over how long [s] it
    is smoothed."""

    time: Array
    value: Array
    noise: float
    width: float


def response_of(
    signals: Mapping[str, Signal], ambient: float, end: float, width: float, step: float
) -> Response | None:
    """From signals with time from the opening up to ``end`` [s], smoothed over ``width`` [s] every ``step`` [s],
    without its holes; None where the chamber hardly stands above ``ambient`` [Pa]."""
    chamber, run = signals["p_chamber"], signals["p_run"]
    width, step = max(width, 2.0 * chamber.step), max(step, chamber.step)
    grid = np.arange(0.1, min(end, chamber.time[-1], run.time[-1]), step)
    excess = np.interp(grid, chamber.time, chamber.smooth(width)) - ambient
    drop = np.interp(grid, run.time, run.smooth(width)) - ambient - excess
    fire = (excess > LOWEST_EXCESS) & (drop > 0.2e5)
    if fire.sum() < 20:
        return None
    stop = min(int(np.flatnonzero(fire)[-1]) + round(WINDOW / step), grid.size)
    drop = np.maximum(drop[:stop], 0.2e5)
    value = excess[:stop] * np.sqrt(np.median(drop) / drop)
    time, seen = grid[:stop], np.ones(stop, dtype=bool)
    for start, until in (*chamber.holes(0.0, end), *run.holes(0.0, end)):
        seen &= (time <= start) | (time >= until)
    return Response(time[seen], value[seen], sample_noise(value), width)


def thrust_falls(
    signals: Mapping[str, Signal], early: tuple[float, float], late: tuple[float, float], share: float
) -> bool:
    """Whether the thrust, where it is measured, falls by this share between two intervals [s], beyond scatter."""
    if "thrust" not in signals:
        return True
    thrust = signals["thrust"]
    before, after = thrust.between(*early).value, thrust.between(*late).value
    if before.size < 4 or after.size < 4:
        return True
    error = 2.0 * np.hypot(before.std() / np.sqrt(before.size), after.std() / np.sqrt(after.size))
    return bool(before.mean() - after.mean() > max(share * abs(before.mean()), error))
