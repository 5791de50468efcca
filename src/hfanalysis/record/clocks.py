"""Time stamps: where a channel's come from, and which of them run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array, Mask
from hfanalysis.compiled import compiled
from hfanalysis.errors import InputError
from hfanalysis.record.clock_repair import repaired
from hfanalysis.record.logspec import TimeSpec
from hfanalysis.record.spool import Spool
from hfanalysis.units import unit_factor

GROUPS = 3
"""Whole groups of samples with one stamp that show a rate. Evidence: UNEVEN."""
UNEVEN = 0.1
"""Share by which groups may differ, beside one sample. Evidence: test_clocks.py: whole seconds of a steady logger hold
as many samples but for one; a logger that repeats samples or pauses does not."""


@dataclass(frozen=True)
class Clock:
    """The stamps of a group of samples: ``time`` [s, log time] of the rows ``keep`` (their numbers, in the order of
    time; None: all as they are); ``stale`` where it stands or steps back. ``epoch``: the instant of its zero [s since
    1970, as written], where the log says so.

    ``stale`` marks samples whose stamp is not later than an earlier good one: of a group with one stamp all but the
    first; where time steps back, whichever side of the step leaves fewer samples out.
    """

    time: Array
    keep: NDArray[np.intp] | None
    stale: Mask
    warnings: tuple[str, ...] = ()
    epoch: float | None = None

    def good(self, readings: Array) -> tuple[Array, Array]:
        """Time [s] (k,) and readings (k,), in the unit of the log, of the samples that are not stale."""
        kept = readings if self.keep is None else readings[self.keep]
        return self.time[~self.stale], kept[~self.stale]


def read_clock(spool: Spool, column: int | None, spec: TimeSpec, rows: int, where: str) -> Clock:
    """The clock of a file's column, or of its sample rate; raises :class:`InputError` where no stamp can be read."""
    if column is None:
        return _regular(spec, rows)
    stamps = spool.look(column)
    keep = np.isfinite(stamps)
    if not keep.any():
        raise InputError(_no_stamps(spool, column, where))
    warnings = [f"{where}: {n} rows without a readable time stamp are left out"] if (n := int((~keep).sum())) else []
    written = spec.unit in ("datetime", "clock") or column in spool.written
    run = repaired(stamps if keep.all() else stamps[keep], turns=not written)
    rows_kept = None if keep.all() else np.flatnonzero(keep)
    if run.order is not None:
        rows_kept = run.order if rows_kept is None else rows_kept[run.order]
    warnings += [f"{where}: {note}" for note in run.notes]
    time = run.time * (1.0 if written else unit_factor(spec.unit, "time", where)[0])
    if spec.spread or (spec.spread is None and _evenly_shared(time)):
        time, note = _spread(time, where, bool(spec.spread))
        warnings += note
    stale = stale_stamps(time)
    warnings += _noted(time, stale, where)
    return Clock(time + _stated(spec), rows_kept, stale, tuple(warnings), spool.epochs.get(column))


def _stated(spec: TimeSpec) -> float:
    """The offset [s] that is stated, 0 where it is to be found."""
    return 0.0 if spec.offset is None else spec.offset.value


def _regular(spec: TimeSpec, rows: int) -> Clock:
    assert spec.rate is not None
    return Clock(np.arange(rows) / spec.rate.value + _stated(spec), None, np.zeros(rows, dtype=bool))


def _no_stamps(spool: Spool, column: int, where: str) -> str:
    text = spool.text.get(column)
    found = f"line {text.line} has {text.first!r}" if text else "the column is empty"
    return f"{where}, time: not one stamp can be read: {found}; expected numbers, dates or times of day"


def stale_stamps(time: Array) -> Mask:
    """Samples (n,) to leave out for the rest of ``time`` (n,) [s] to increase strictly, as few as can be.

    >>> stale_stamps(np.array([0.0, 1.0, 1.0, 2.0, 99.0, 3.0, 4.0]))
    array([False, False,  True, False,  True, False, False])
    """
    if _increases(time):
        return np.zeros(len(time), dtype=bool)
    return _outside_longest_rise(np.ascontiguousarray(time))


def _increases(time: Array) -> bool:
    return bool(np.all(time[1:] > time[:-1]))


@compiled
def _outside_longest_rise(time: Array) -> Mask:
    """Complement of a longest strictly increasing subsequence; among equal stamps the first is kept."""
    n = len(time)
    ends = np.empty(n, np.int64)
    before = np.full(n, -1)
    length = 0
    for i in range(n):
        low, high = 0, length
        while low < high:
            middle = (low + high) // 2
            if time[ends[middle]] < time[i]:
                low = middle + 1
            else:
                high = middle
        if low > 0:
            before[i] = ends[low - 1]
        if low == length or time[i] < time[ends[low]]:
            ends[low] = i
        length = max(length, low + 1)
    out = np.ones(n, np.bool_)
    i = ends[length - 1]
    while i >= 0:
        out[i] = False
        i = before[i]
    return out


def _noted(time: Array, stale: Mask, where: str) -> list[str]:
    """What to say about stamps that do not run."""
    if not stale.any():
        return []
    repeated = int(np.count_nonzero(np.diff(time) == 0.0))
    back = int(np.count_nonzero(np.diff(time) < 0.0))
    count = int(stale.sum())
    notes = [f"{where}: {count} samples flagged time ({repeated} repeated stamps, {back} steps back)"]
    if repeated > 0.05 * len(time):
        notes.append(f"{where}: stamps look truncated; spread = true beside its time column spreads them evenly")
    return notes


def _groups(time: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where groups of samples with one stamp begin, and how many samples each has."""
    starts = np.flatnonzero(np.diff(time, prepend=-np.inf) != 0.0)
    return starts, np.diff(np.append(starts, len(time)))


def _evenly_shared(time: Array) -> bool:
    """Whether stamps are truncated and a steady rate shows: as many samples, but for one, share each whole stamp."""
    _, counts = _groups(time)
    whole = counts[1:-1]
    if len(whole) < GROUPS or np.median(whole) < 2 or (np.diff(time) < 0.0).any():
        return False
    return bool((np.abs(whole - np.median(whole)) <= np.maximum(1.0, UNEVEN * np.median(whole))).all())


def _spread(time: Array, where: str, asked: bool) -> tuple[Array, list[str]]:
    """Samples that share a stamp spread evenly up to the next stamp; a first stamp's end at it."""
    starts, counts = _groups(time)
    if len(starts) < 2:
        return time, []
    steps = np.diff(time[starts])
    usual = np.median(steps)
    steps = np.append(steps, usual) / counts
    place = np.arange(len(time)) - np.repeat(starts, counts)
    spread = np.repeat(time[starts], counts) + place * np.repeat(steps, counts)
    if len(counts) > 2:
        pace, first, last = usual / np.median(counts[1:-1]), int(counts[0]), int(starts[-1])
        if first * pace < steps[0] * first:
            spread[:first] = time[first] - pace * np.arange(first, 0, -1)
        spread[last:] = np.minimum(spread[last:], time[last] + pace * place[last:])
    why = "as test.toml asks" if asked else "since as many share each (spread = false leaves them)"
    return spread, [f"{where}: samples that share a stamp are spread evenly, {why}"]
