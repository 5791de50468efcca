"""Block means of a signal: which blocks of the grid count, and which are averaged further."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array, Integers
from hfanalysis.inference.observations.channel import averaged
from hfanalysis.inference.observations.frame import AROUND_CHANGE, BLOCK, Frame
from hfanalysis.inference.observations.recorded import LONGEST_RECORD
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import MAD_TO_STD, Signal

MERGED, NEAR = 5, 0.4
"""Blocks that are merged into one farther than NEAR [s] from any change: the noise there is coherent anyway."""

TANK_AT_REST, TANK_REST = ("p_tank", "m_tank"), 1.2
"""Channels that show the tank at rest before the opening, and the time of it that is looked at [s]: a tank is filled
before, and warms."""

STEADY, JUMP = 3.0, 4.5
"""Standard deviations that the halves of a rest may differ by, and neighboring blocks of it: an igniter may burn."""

AT_REST = ("p_chamber", "thrust")
"""Channels whose true value is known once the flow has ended."""


@dataclass(frozen=True)
class Blocks:
    """Block means of a signal: the points of the grid (``first``, ``count``) that each averages.

    ``fine`` means of all blocks while something flows, ``good`` ones among them or not.

    ``time`` (blocks,) [s after the opening]; ``value`` (blocks,) and ``fine`` in the signal's SI unit, and so is
    ``untimed`` (blocks,): standard deviation of a mean by the errors of its samples' times.
    """

    signal: Signal
    time: Array
    value: Array
    first: Integers
    count: Integers
    fine: Array
    good: NDArray[np.bool_]
    untimed: Array


def blocks_of(signal: Signal, frame: Frame, zeroed: bool, start: float = 0.0) -> Blocks | None:
    """The block means (blocks,) of a signal [SI] whose times [s] count from the opening; None where too few are left.

    Blocks without enough samples, and those near a change of phase, are left out. ``zeroed``: what it reads before the
    opening is known to be nothing, or the open air. ``start`` [s]: nothing is compared before.
    """
    flowing = frame.flowing
    n = flowing.stop - flowing.start
    edges = np.arange(n + 1) * BLOCK
    at = np.searchsorted(signal.time, edges)
    sums = np.concatenate([[0.0], np.cumsum(signal.value)])
    samples, centers = np.diff(at), frame.grid[flowing]
    means = np.where(samples > 0, np.diff(sums[at]) / np.maximum(samples, 1), 0.0)
    means, unsure = centered(signal, centers, means, samples, at)
    filled = (samples > 0) & (samples >= 0.5 * BLOCK / max(signal.step, 1e-9))
    good = filled & (centers > max(frame.start, start)) & (centers < frame.end(signal.name))
    for name, (instant, deviation) in frame.changes.items():
        berth = 2.0 * deviation if name == "t_v" else min(2.0 * deviation, AROUND_CHANGE)
        good &= np.abs(centers - instant) > AROUND_CHANGE + berth
        if name == "t_v" and frame.hidden > 0.0:
            good &= (centers < instant - frame.hidden - AROUND_CHANGE) | (centers > instant)
    if good.sum() < 10:
        return None
    first, count = _merged(good, centers, frame)
    time, value, first = averaged(centers, first, count), averaged(means, first, count), first + flowing.start
    before, after = _before(signal, frame, zeroed), _after(signal, frame)
    rest = [_wide(signal, frame, rows) for rows in (before, after)]
    return Blocks(
        signal,
        np.r_[frame.grid[before], time, frame.grid[after]],
        np.r_[rest[0], value, rest[1]],
        np.r_[before, first, after],
        np.r_[np.ones_like(before), count, np.ones_like(after)],
        means,
        good,
        np.r_[
            np.zeros(before.size),
            np.sqrt(averaged(unsure**2, first - flowing.start, count) / count),
            np.zeros(after.size),
        ],
    )


def centered(signal: Signal, centers: Array, means: Array, samples: Integers, at: Integers) -> tuple[Array, Array]:
    """Means of blocks (blocks,) carried to the middles of the blocks by the slope there, and by how much (blocks,) they
    are unsure, both in the signal's SI unit: |dy/dt| times the error of a stamp, and what the slope is unsure of.

    A block of a slow log holds one sample, which may lie anywhere in it: at the opening a chamber fills by half a bar
    from one end of the block to the other. ``centers`` (blocks,) [s]; ``samples`` (blocks,) in each; ``at`` (blocks +
    1,): the first sample of each and the one after the last.

    >>> time = np.array([0.004, 0.026, 0.045])
    >>> ramp = Signal("p", time, 10.0 * time, 0.0, 0.02)
    >>> middles, one = np.array([0.01, 0.03, 0.05]), np.ones(3, dtype=int)
    >>> centered(ramp, middles, ramp.value, one, np.arange(4))[0].round(9).tolist()
    [0.1, 0.3, 0.5]
    """
    there = samples > 0
    if there.sum() < 3:
        return means, np.zeros(means.size)
    sums = np.concatenate([[0.0], np.cumsum(signal.time)])
    middle = np.diff(sums[at])[there] / samples[there]
    slope = np.gradient(means[there], middle)
    moved = centers[there] - middle
    bend = np.gradient(slope, middle)
    out, unsure = means.copy(), np.zeros(means.size)
    out[there] += slope * moved
    stamp = stamp_error(signal) / np.sqrt(samples[there])
    unsure[there] = np.hypot(slope * stamp, bend * moved * np.diff(middle, append=middle[-1]))
    return out, unsure


def stamp_error(signal: Signal) -> float:
    """Standard deviation [s] of the time of a sample about its stamp.

    A clock that jitters by what its stamps show is off by as much again between the reading and the stamp. It is the
    deviation of the intervals from their usual length, by the median, over the root of two: each has two ends.
    """
    steps = np.diff(signal.time)
    return float(MAD_TO_STD * np.median(np.abs(steps - np.median(steps))) / np.sqrt(2.0)) if steps.size else 0.0


def _before(signal: Signal, frame: Frame, zeroed: bool) -> Integers:
    """Blocks of the rest before the opening that count: of the tank's last second, or of a sensor with a zero."""
    rows = np.arange(frame.before)
    if signal.name in TANK_AT_REST:
        rows = rows[frame.grid[rows] - 0.5 * frame.width[rows] >= -TANK_REST]
    elif not zeroed:
        return rows[:0]
    rows = rows[np.isfinite(_wide(signal, frame, rows))]
    if rows.size and signal.name not in TANK_AT_REST and not _stands(signal, frame, rows):
        return rows[:0]
    return rows


def _stands(signal: Signal, frame: Frame, rows: Integers) -> bool:
    """Whether a sensor's reading stands still from the first to the last of these blocks."""
    begin, end = (frame.grid[rows] + side * frame.width[rows] for side in (-0.5, 0.5))
    half = float(0.5 * (begin[0] + end[-1]))
    noise = Noise.of(signal, signal.between(-LONGEST_RECORD, half))

    def same(one: tuple[float, float], two: tuple[float, float], most: float) -> bool:
        return abs(signal.mean(*one) - signal.mean(*two)) <= most * noise.difference_std(one, two)

    blocks = [(float(a), float(b)) for a, b in zip(begin, end, strict=True)]
    halves = same((float(begin[0]), half), (half, float(end[-1])), STEADY)
    return halves and all(same(one, two, JUMP) for one, two in pairwise(blocks))


def _after(signal: Signal, frame: Frame) -> Integers:
    """Blocks of the rest after the flow: all of them, of a channel whose true value is known there, or none."""
    rows = np.arange(frame.after.start, frame.after.stop)
    known = signal.name in AT_REST and bool(np.isfinite(_wide(signal, frame, rows)).all())
    return rows if known else rows[:0]


def _wide(signal: Signal, frame: Frame, rows: Integers) -> Array:
    """Means over wide blocks of the grid; nan where a log has too few samples in one."""
    out = np.full(rows.size, np.nan)
    for i, row in enumerate(rows):
        half = 0.5 * frame.width[row]
        inside = signal.between(float(frame.grid[row] - half), float(frame.grid[row] + half)).value
        if inside.size >= max(2.0, half / max(signal.step, 1e-9)):
            out[i] = inside.mean()
    return out


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
