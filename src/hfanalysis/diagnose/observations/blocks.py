"""Block means of a signal: which blocks of the grid count, and which are averaged further."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.observations.frame import AROUND_CHANGE, BLOCK, Frame
from hfanalysis.diagnose.observations.observed import averaged
from hfanalysis.segment.signals import Signal

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MERGED, NEAR = 5, 0.4
"""Blocks that are merged into one farther than NEAR [s] from any change: the noise there is coherent anyway."""

BEFORE_OPENING, BEFORE = ("p_tank", "m_tank"), 1.0
"""Channels that show the tank at rest before the opening, and the seconds of it that are looked at."""

AT_REST = ("p_chamber", "thrust")
"""Channels whose true value is known once the flow has ended."""


@dataclass(frozen=True)
class Blocks:
    """Block means of a signal: the points of the grid (``first``, ``count``) that each averages.

    ``fine`` means of all blocks while something flows, ``good`` ones among them or not.
    """

    signal: Signal
    time: Array
    value: Array
    first: Integers
    count: Integers
    fine: Array
    good: NDArray[np.bool_]


def blocks_of(signal: Signal, frame: Frame) -> Blocks | None:
    """The block means of a signal whose times [s] count from the opening; None where too few are left.

    Blocks without enough samples, and those near a change of phase, are left out.
    """
    n = int((~frame.resting).sum())
    edges = np.arange(n + 1) * BLOCK
    at = np.searchsorted(signal.time, edges)
    sums = np.concatenate([[0.0], np.cumsum(signal.value)])
    samples, centers = np.diff(at), frame.grid[1 : 1 + n]
    means = np.where(samples > 0, np.diff(sums[at]) / np.maximum(samples, 1), 0.0)
    filled = (samples > 0) & (samples >= 0.5 * BLOCK / max(signal.step, 1e-9))
    good = filled & (centers > frame.start) & (centers < frame.end(signal.name))
    for name, (instant, deviation) in frame.changes.items():
        berth = 2.0 * deviation if name == "t_v" else min(2.0 * deviation, AROUND_CHANGE)
        good &= np.abs(centers - instant) > AROUND_CHANGE + berth
        if name == "t_v" and frame.failing > 0.0:
            good &= (centers < instant - frame.failing - AROUND_CHANGE) | (centers > instant)
    if good.sum() < 10:
        return None
    first, count = _merged(good, centers, frame)
    time, value, first = averaged(centers, first, count), averaged(means, first, count), first + 1
    one = np.ones(1, dtype=np.int64)
    before = signal.between(-BEFORE, -0.05).value
    if signal.name in BEFORE_OPENING and before.size > 4:
        time, value = np.r_[0.0, time], np.r_[before.mean(), value]
        first, count = np.r_[0 * one, first], np.r_[one, count]
    after = np.flatnonzero(frame.resting)[1:] if signal.name in AT_REST else np.zeros(0, dtype=np.int64)
    still = _still(signal, frame.grid[after])
    if np.isfinite(still).all():
        time, value = np.r_[time, frame.grid[after]], np.r_[value, still]
        first, count = np.r_[first, after], np.r_[count, np.ones(after.size, dtype=np.int64)]
    return Blocks(signal, time, value, first, count, means, good)


def _merged(good: NDArray[np.bool_], centers: Array, frame: Frame) -> tuple[Integers, Integers]:
    """Runs of good blocks: single near the opening and changes, MERGED of them elsewhere."""
    lively = centers < frame.start + NEAR
    for instant, _ in frame.changes.values():
        lively |= np.abs(centers - instant) < NEAR
    first, size = [], []
    i = 0
    while i < good.size:
        if not good[i]:
            i += 1
            continue
        span = 1
        while not lively[i] and span < MERGED and i + span < good.size and good[i + span] and not lively[i + span]:
            span += 1
        first.append(i)
        size.append(span)
        i += span
    return np.array(first, dtype=np.int64), np.array(size, dtype=np.int64)


def _still(signal: Signal, times: Array) -> Array:
    """Means about instants after the end of the flow."""
    half = 0.5 * float(times[1] - times[0]) if times.size > 1 else 0.0
    return np.array([signal.mean(t - half, t + half) for t in times])
