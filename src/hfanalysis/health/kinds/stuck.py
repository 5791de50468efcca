"""A channel that holds one reading where its own noise never lets it: stuck, also where it does not come back."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.health import cures
from hfanalysis.health.runs import certain, gap_edges, true_runs
from hfanalysis.health.seen import Seen
from hfanalysis.products.health import UNUSABLE, Finding
from hfanalysis.record.log import Flag
from hfanalysis.record.signals import second_to_std
from hfanalysis.sentences import text

WINDOW = 64
"""Samples in which noise is asked for [samples]."""
QUIETEST = 0.1
"""Share of the windows that may be quieter than what counts as the channel's noise [-]."""
NOISY = 1.0
"""Noise in steps of its resolution from which on a channel cannot hold a reading for long: below, its resolution
swallows the noise, and a quiet sensor stands still. Source: with a deviation of one step two readings are equal with a
probability of 0.28."""
AT_REST = 5.0
"""Deviations of its noise within which a channel is at its rest. Source: normal noise is within, but for one sample
in a million."""
NOT_READ = Flag.DROPOUT | Flag.TIME | Flag.EXCLUDED
"""Samples that are none, or that were left out already."""


def find(seen: Seen) -> Iterator[Finding]:
    """Runs of equal readings that chance does not make, but for those at an end of the range, which are a rail's."""
    kept = ((seen.channel.flags & np.uint8(NOT_READ)) == 0) & np.isfinite(seen.said)
    time, values = seen.channel.time[kept], seen.said[kept]
    if len(values) < 2 * WINDOW or seen.coarse.repetition == 1.0:
        return
    equal = np.r_[False, np.diff(values) == 0.0]
    runs = true_runs(equal)
    if not any(certain(int(last - first + 1), 1.0 / len(values), len(values)) for first, last in runs):
        return  # not even if readings repeated next to never
    chance = _chance(values, equal, runs, seen.coarse.quantum)
    if chance is None:
        return
    for first, last in runs:
        if not certain(int(last - first + 1), chance, len(values)) or _extreme(values, int(first)):
            continue
        if not _idle(seen, float(values[first]), float(time[first]), float(time[last])):
            yield _finding(seen, time, values, int(first), int(last))


def _chance(values: Array, equal: NDArray[np.bool_], runs: NDArray[np.int64], quantum: float) -> float | None:
    """The chance [-] that a reading equals the one before, from what is noise outside the long runs; None where the
    channel's resolution swallows its noise."""
    outside = np.ones(len(values), dtype=bool)
    for first, last in runs:
        if last - first + 1 >= WINDOW // 8:
            outside[first - 1 : last + 1] = False
    rest = values[outside]
    whole = len(rest) // WINDOW
    if whole < 1:
        return None
    second = np.abs(np.diff(rest[: whole * WINDOW].reshape(whole, WINDOW), 2, axis=1))
    noises = np.sort(second_to_std(np.median(second, axis=1)))
    if noises[int(QUIETEST * whole)] < NOISY * quantum:
        return None
    return float((np.count_nonzero(equal & outside) + 1.0) / (outside.sum() + 2.0))


def _idle(seen: Seen, value: float, start: float, end: float) -> bool:
    """Whether a channel stands still at its rest [SI] while there is no firing: somebody filled up the log."""
    rest, fire = seen.coarse.rest, seen.fire
    if rest is None or fire is None or (start < fire[1] and end > fire[0]):
        return False
    return abs(value - rest.value) <= AT_REST * max(rest.noise, seen.coarse.quantum)


def _extreme(values: Array, place: int) -> bool:
    return bool(values[place] in (values.min(), values.max()))


def _finding(seen: Seen, time: Array, values: Array, first: int, last: int) -> Finding:
    start, end = gap_edges(time, first, last)
    for_good = last == len(values) - 1
    evidence = text(
        "reads exactly {level} for {count} samples, {until}; between other neighbors its noise always shows",
        level=seen.amount(values[first]),
        count=last - first + 2,
        until="to the end of the log" if for_good else f"{end - start:.3g} s",
    )
    means = (
        "the channel is frozen: what it measured in that time is lost; numbers across it would be those of one reading"
    )
    return seen.finding(
        "stuck", UNUSABLE, start=start, end=end, evidence=evidence, means=means,
        cure=cures.exclude([seen.name], start, end),
    )  # fmt: skip
