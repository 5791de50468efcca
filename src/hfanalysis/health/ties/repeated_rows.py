"""Rows that repeat earlier rows exactly: a buffer that the logger wrote twice, or all channels held at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.health import cures
from hfanalysis.health.runs import Run, asked_for, certain, gap_edges, row_hashes, true_runs
from hfanalysis.health.seen import FIRING, Seen, SeenTest
from hfanalysis.products.health import UNUSABLE, Finding
from hfanalysis.record.log import Flag

NOT_READ = Flag.TIME | Flag.EXCLUDED
"""Rows that are none, or that were left out already."""
SHORTEST = 3
"""Rows that a repeated block has at least [rows]."""
LAGS = 8
"""Lags that are looked at. Evidence: a log has few blocks of which another is a copy."""
RIGHT_AFTER = 8
"""Rows after a block of quiet ones in which a firing under way was opened in it [rows]."""
AROUND = 32
"""Rows on either side of held ones that say how often rows repeat there [rows]."""
AWAY = 0.1
"""Share of its range by which a channel is away from its rest [-]. Evidence: a cell that ignition has shifted by some
per cent is at rest."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Of every clock's channels together: a row of many noisy readings does not come twice."""
    for seen in _by_clock(test):
        kept = np.logical_and.reduce([(s.channel.flags & np.uint8(NOT_READ)) == 0 for s in seen])
        kept &= np.logical_or.reduce([np.isfinite(s.said) for s in seen])
        if kept.sum() < 2 * SHORTEST:
            continue
        time, rows = seen[0].channel.time[kept], row_hashes([s.said[kept] for s in seen])
        blocks = (run for run in _blocks(rows) if run.length % run.lag == 0 and _live(test, time, run))
        for run in (*blocks, *_held(rows)):
            if asked_for(test.fire, time[run.first], time[run.last]) and not _told(test, seen, run, time):
                yield _finding(seen, time, run)


def _by_clock(test: SeenTest) -> Iterator[list[Seen]]:
    """Channels that share their time stamps: what one logger writes in one row."""
    groups: list[list[Seen]] = []
    for seen in test.channels.values():
        for group in groups:
            if group[0].channel.time is seen.channel.time or np.array_equal(group[0].channel.time, seen.channel.time):
                group.append(seen)
                break
        else:
            groups.append([seen])
    yield from groups


def _blocks(rows: NDArray[np.uint64]) -> list[Run]:
    """Blocks of rows (n,) that are those of a while before, and by chance would not be; none within another."""
    found: list[Run] = []
    for run in sorted((run for lag in _likely(rows) for run in _at(rows, lag)), key=lambda r: -r.length):
        if not any(run.first <= other.last and run.last >= other.first for other in found):
            found.append(run)
    return sorted(found, key=lambda run: run.first)


def _likely(rows: NDArray[np.uint64]) -> list[int]:
    """The lags at which rows in a row were there before, those of the most rows first."""
    lag = _lags(rows)
    runs = _same(lag)
    length = runs[:, 1] - runs[:, 0] + 1
    long = (length >= SHORTEST) & (lag[runs[:, 0]] > 1)
    if not long.any():
        return []
    total = np.bincount(lag[runs[long, 0]], weights=length[long])
    return [int(place) for place in np.argsort(-total)[:LAGS] if total[place]]


def _at(rows: NDArray[np.uint64], lag: int) -> Iterator[Run]:
    """The blocks that are those of so many rows before."""
    equal = np.r_[np.zeros(lag, dtype=bool), rows[lag:] == rows[:-lag]]
    for first, last in true_runs(equal):
        length = int(last - first + 1)
        if length < SHORTEST:
            continue
        others, count = np.count_nonzero(equal) - length, len(rows) - lag - length
        chance = max((others + 1.0) / (count + 2.0), 1.0 / len(rows))
        distinct = len(np.unique(rows[first : last + 1]))
        if chance < 1.0 and certain(distinct, chance, float(len(rows)) ** 2):
            yield Run(int(first), int(last), lag)


def _live(test: SeenTest, time: Array, run: Run) -> bool:
    """Whether anything happens in the rows, or right after them. Quiet time that comes twice was pasted in to fill up a
    log, as people do; no number rests on it where it does not hide an opening."""
    asked = [test.channels[name] for name in FIRING if name in test.channels]
    spans = [(run.first, run.last), (run.last + 1, run.last + RIGHT_AFTER)]
    inside = [(float(time[a]), float(time[min(b, len(time) - 1)])) for a, b in spans if a < len(time)]
    return any(_away(seen, *span) for seen in asked[:2] for span in inside)


def _away(seen: Seen, start: float, end: float) -> bool:
    """Whether a channel is away from its rest between two instants [s]."""
    rest, part = seen.coarse.rest, seen.trace.between(start, end).values
    if rest is None or not len(part):
        return True
    departure = abs(float(np.median(part)) - rest.value)
    return departure > AWAY * (seen.coarse.peak - seen.coarse.trough)


def _lags(rows: NDArray[np.uint64]) -> NDArray[np.int64]:
    """How many rows (n,) before each the same row was last; 0 where it was not."""
    order = np.argsort(rows, kind="stable")
    again = np.r_[False, rows[order][1:] == rows[order][:-1]]
    lag = np.zeros(len(rows), dtype=np.int64)
    places = np.flatnonzero(again)
    lag[order[places]] = order[places] - order[places - 1]
    return lag


def _same(lag: NDArray[np.int64]) -> NDArray[np.int64]:
    """First and last place (runs, 2) of runs of one lag that is not 0."""
    starts = np.flatnonzero(np.r_[True, np.diff(lag) != 0])
    ends = np.r_[starts[1:], len(lag)] - 1
    some = lag[starts] > 0
    return np.column_stack([starts[some], ends[some]])


def _held(rows: NDArray[np.uint64]) -> Iterator[Run]:
    """Rows that all equal the one before, between others that do not."""
    equal = np.r_[False, rows[1:] == rows[:-1]]
    for first, last in true_runs(equal):
        length = int(last - first + 1)
        if length < SHORTEST or last == len(rows) - 1:
            continue
        around = max(AROUND, length)
        before, after = equal[max(0, first - around) : first], equal[last + 1 : last + 1 + around]
        if min(len(before), len(after)) < AROUND:
            continue
        chance = max((np.count_nonzero(side) + 1.0) / (len(side) + 2.0) for side in (before, after))
        if certain(length, float(chance), len(rows)):
            yield Run(int(first), int(last), 1)


def _told(test: SeenTest, seen: list[Seen], run: Run, time: Array) -> bool:
    """Whether every channel showed it by itself."""
    stuck = [f for f in test.found if f.kind == "stuck"] if run.lag == 1 else []
    start, end = gap_edges(time, run.first, run.last)
    having = {name for f in stuck if f.span[0] <= end and f.span[1] >= start for name in f.channels}
    return having >= {s.name for s in seen}


def _finding(seen: list[Seen], time: Array, run: Run) -> Finding:
    start, end = gap_edges(time, run.first, run.last)
    names = tuple(s.name for s in seen)
    whose = f"all {len(names)} channels" if len(names) > 1 else names[0]
    if run.lag == 1:
        kind, means = "stuck", "the logger stood still: what was measured in that time is lost"
        evidence = f"{run.length} rows repeat the one before them exactly, in {whose}"
    else:
        kind, means = "repeated", "a buffer of the logger was written twice: what was measured in that time is lost"
        of = time[run.first - run.lag], time[run.last - run.lag]
        evidence = (
            f"{run.length} rows are exactly those of {of[0]:.3f} to {of[1]:.3f} s, in {whose}; noise does not repeat"
        )
    return Finding(
        kind=kind, channels=names, verdict=UNUSABLE, start=start, end=end, evidence=evidence, means=means,
        cure=cures.exclude(names, start, end),
    )  # fmt: skip
