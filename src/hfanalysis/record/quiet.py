"""The quiet time before a firing and after it, and the zeros taken there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array

QUIET_BLOCK = 0.02
"""[s] over which samples are averaged to look for the firing."""
SUSTAINED = 0.1
"""[s] that a departure must last to be one."""
MARGIN = 0.2
"""[s] kept clear before the firing."""
LONGEST_QUIET = 30.0
"""[s] of quiet time used at most, so that filling the tank does not count."""
SHORTEST_QUIET = 0.3
"""[s] of quiet time below which no zero is taken."""
SETTLED = 1.0
"""[s] of settled level needed after the firing."""
SETTLING = 0.5
"""[s] after the firing before a zero may be taken."""
SHIFTED = 0.4
"""Part of the range of a channel by which its level may be shifted between the beginning and the end of a log.
Evidence: a transducer that ignition shifted down rests lower in the end, and its beginning was taken for the firing
(test_zero.py)."""
LEAST_DEPARTURE = {"thrust": 10.0}
"""[N] a departure must reach to be a firing; pressures: 0.3 bar."""
REFERENCES = ("p_chamber", "thrust", "p_run", "p_tank")
"""Channels that say when the firing is, the most telling first."""


@dataclass(frozen=True)
class Trace:
    """A channel's good samples: time [s], values [SI]."""

    time: Array
    values: Array

    def between(self, start: float, end: float) -> Trace:
        """The samples in a window, from ``start`` to ``end`` [s], both included."""
        inside = (self.time >= start) & (self.time <= end)
        return Trace(self.time[inside], self.values[inside])


@dataclass(frozen=True)
class Level:
    """A level held for a while: mean and its standard deviation [SI], and the middle of the time [s]."""

    value: float
    std: float
    time: float


@dataclass(frozen=True)
class FiringSpan:
    """When the log departs from rest and when it is back [s, log time], and which channel said so."""

    start: float
    end: float
    channel: str


def find_firing(name: str, trace: Trace) -> FiringSpan | None:
    """The first sustained departure of a channel from rest; None where it shows none."""
    found = _departure(trace, LEAST_DEPARTURE.get(name, 30e3))
    return FiringSpan(*found, name) if found else None


def _departure(trace: Trace, least: float) -> tuple[float, float] | None:
    """First and last time [s] a channel is away from rest; None where it never leaves by ``least`` [SI]."""
    blocks = in_blocks(trace, QUIET_BLOCK)
    if len(blocks.time) < 10:
        return None
    low = float(np.percentile(blocks.values, 5))
    top = float(_smoothed(blocks.values).max())
    if top - low < max(least, 10.0 * spread(np.diff(blocks.values))):
        return None
    rest = blocks.values[blocks.values < low + 0.1 * (top - low)]
    base, noise = float(np.median(rest)), spread(rest)
    away = blocks.values > _threshold(base, top, noise)
    step = float(np.median(np.diff(blocks.time)))
    base = max(base, _at_first(blocks, low + SHIFTED * (top - low), step))
    first = _first_run(blocks.values > _threshold(base, top, noise), max(3, round(SUSTAINED / step)))
    if first is None:
        return None
    while first > 0 and blocks.values[first - 1] > base + 3.0 * noise:
        first -= 1
    return float(blocks.time[first]), float(blocks.time[np.flatnonzero(away)[-1]])


def _threshold(base: float, top: float, noise: float) -> float:
    """What a channel that rests at ``base`` and reaches ``top`` has to exceed to be away from rest."""
    return base + max(0.05 * (top - base), 6.0 * noise)


def _at_first(blocks: Trace, most: float, step: float) -> float:
    """The level that a log begins at, where it is one of rest, at ``most`` so high: a sensor that ignition has shifted
    down rests lower in the end. Minus infinity where it begins higher."""
    level = float(np.median(blocks.values[: max(3, round(SHORTEST_QUIET / step))]))
    return level if level < most else -np.inf


def _first_run(mask: NDArray[np.bool_], length: int) -> int | None:
    """Where the first run of at least ``length`` trues begins."""
    edges = np.flatnonzero(np.diff(mask.astype(np.int8), prepend=0, append=0))
    starts, ends = edges[::2], edges[1::2]
    long = np.flatnonzero(ends - starts >= length)
    return int(starts[long[0]]) if len(long) else None


def in_blocks(trace: Trace, width: float) -> Trace:
    """Means over blocks of about ``width`` [s] (single samples where they are further apart)."""
    if len(trace.time) < 2:
        return trace
    every = max(1, len(trace.time) // 20_000)
    step = float(np.median(trace.time[1::every] - trace.time[:-1:every]))
    per = round(float(np.clip(width / step, 1.0, len(trace.time)))) if step > 0 else 1
    count = len(trace.time) // per
    shape = (count, per)
    return Trace(trace.time[: count * per].reshape(shape).mean(1), trace.values[: count * per].reshape(shape).mean(1))


def _smoothed(values: Array) -> Array:
    """Running median of five."""
    if len(values) < 5:
        return values
    smooth: Array = np.median(np.lib.stride_tricks.sliding_window_view(values, 5), axis=1)
    return smooth


def spread(values: Array) -> float:
    """Robust standard deviation, in the unit of ``values`` (n,): 1.4826 times the median absolute deviation.

    >>> round(spread(np.array([1.0, 2.0, 3.0, 4.0, 100.0])), 4)
    1.4826
    """
    return float(1.4826 * np.median(np.abs(values - np.median(values)))) if len(values) else 0.0


def level(trace: Trace) -> Level | None:
    """Robust mean of a quiet stretch; None where it is too short.

    The standard deviation is that of block means where it is the larger: neighboring samples are not independent.
    """
    if len(trace.time) < 5 or trace.time[-1] - trace.time[0] < SHORTEST_QUIET:
        return None
    limit = max(4.0 * spread(trace.values), 1e-12)
    near = np.abs(trace.values - np.median(trace.values)) <= limit
    kept = trace.values[near]
    blocks = np.array([part.mean() for part in np.array_split(kept, min(12, max(2, len(kept) // 5)))])
    std = max(_std_of_mean(kept), _std_of_mean(blocks))
    return Level(float(kept.mean()), std, float(trace.time[near].mean()))


def _std_of_mean(values: Array) -> float:
    return float(values.std(ddof=1) / np.sqrt(len(values))) if len(values) > 1 else 0.0


def before(trace: Trace, firing: FiringSpan) -> Trace:
    """The quiet stretch before a firing, cut where the channel itself departs earlier."""
    window = trace.between(firing.start - LONGEST_QUIET, firing.start - MARGIN)
    blocks = in_blocks(window, 5 * QUIET_BLOCK)
    if len(blocks.time) < 5:
        return window
    limit = 4.0 * max(spread(blocks.values), 1e-12)
    calm = np.flatnonzero(np.abs(blocks.values - np.median(blocks.values)) <= limit)
    return window.between(-np.inf, float(blocks.time[calm[-1]]) + QUIET_BLOCK)


def after(trace: Trace, firing: FiringSpan) -> Trace | None:
    """The longest stretch after a firing over which the channel is flat; None where there is none."""
    if not len(trace.time):
        return None
    largest = float(np.percentile(np.abs(trace.values - np.median(trace.values)), 99))
    start, end = firing.end + SETTLING, float(trace.time[-1])
    while end - start >= SETTLED:
        window = trace.between(start, min(end, start + LONGEST_QUIET))
        if is_settled(window, largest):
            return window
        start += 0.25 * (end - start)
    return None


def is_settled(trace: Trace, largest: float) -> bool:
    """Whether a stretch has no trend that matters against the channel's ``largest`` departure from rest [SI].

    Either the trend carried on for ten seconds is within 1 % of it, or it is within its own scatter and that is small.
    """
    blocks = in_blocks(trace, 5 * QUIET_BLOCK)
    if len(blocks.time) < 5:
        return False
    reach = max(10.0, float(blocks.time[-1] - blocks.time[0]))
    (slope, _), covariance = np.polyfit(blocks.time - blocks.time.mean(), blocks.values, 1, cov=True)
    scatter = 3.0 * float(np.sqrt(covariance[0, 0]))
    if abs(slope) * reach <= 0.01 * largest:
        return True
    return bool(abs(slope) <= scatter and scatter * reach <= 0.03 * largest)
