"""A channel that holds one reading where its own noise never lets it: stuck, also where it does not come back."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.health import cures
from hfanalysis.health.runs import asked_for, certain, gap_edges, true_runs
from hfanalysis.health.seen import Seen
from hfanalysis.products.health import UNUSABLE, Finding
from hfanalysis.record.log import Flag
from hfanalysis.record.signals import second_to_std
from hfanalysis.sentences import text

WINDOW = 32
"""Samples in which noise is asked for [samples]."""
NOISY = 1.0
"""Noise of the quietest window, in steps of the channel's resolution, from which on it cannot hold a reading for long:
below, its resolution swallows the noise, and a quiet sensor stands still. Evidence: test_repeats.py; a mass flow
controller that reads nothing below its cut-off, and a cell at rest, hold a reading for seconds."""
AT_REST = 5.0
"""Deviations of its noise within which a channel is at its rest. Source: normal noise is within, but for one sample
in a million."""
NOT_READ = Flag.DROPOUT | Flag.TIME | Flag.EXCLUDED
"""Samples that are none, or that were left out already."""


def find(seen: Seen) -> Iterator[Finding]:
    """Runs of equal readings that chance does not make, but for those at an end of the range, which are a rail's."""
    kept = ((seen.channel.flags & np.uint8(NOT_READ)) == 0) & np.isfinite(seen.said)
    time, values = seen.channel.time[kept], seen.said[kept]
    equal = np.r_[False, np.diff(values) == 0.0]
    runs = true_runs(equal)
    # most logs have no run that would be certain even if readings repeated next to never
    runs = runs[[certain(int(last - first + 1), 1.0 / len(values), len(values)) for first, last in runs]]
    noises = window_noises(values) if len(runs) else values[:0]
    for first, last in runs.tolist():
        start, end = float(time[first]), float(time[last])
        if not asked_for(seen.fire, start, end) or _idle(seen, float(values[first]), start, end):
            continue
        if _frozen(seen, values, equal, noises, (first, last)):
            yield _finding(seen, time, values, first, last)


def window_noises(values: Array) -> Array:
    """The noise of every window (k,), in the unit of ``values`` (n,)."""
    whole = len(values) // WINDOW
    second = np.abs(np.diff(values[: whole * WINDOW].reshape(whole, WINDOW), 2, axis=1))
    return second_to_std(np.median(second, axis=1))


def _frozen(seen: Seen, values: Array, equal: NDArray[np.bool_], noises: Array, run: tuple[int, int]) -> bool:
    """Whether a run of equal readings is none of the channel's own habits: everywhere else its noise shows, and
    readings repeat so seldom that this many do not by chance."""
    first, last = run
    others = np.r_[noises[: max(first - 1, 0) // WINDOW], noises[last // WINDOW + 1 :]]
    if _extreme(values, first) or not len(others) or others.min() < NOISY * seen.coarse.quantum:
        return False
    length = last - first + 1
    chance = (np.count_nonzero(equal) - length + 1.0) / (len(values) - length + 2.0)
    return certain(length, float(chance), len(values))


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
