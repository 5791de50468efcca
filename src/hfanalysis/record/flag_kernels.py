"""Compiled passes over a channel's samples, a few nanoseconds each.

They are written out number by number: what NumPy offers within compiled code takes seconds to compile.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled

Flags = NDArray[np.uint8]

DROPOUT, STUCK, SATURATED, SPIKE = np.uint8(1), np.uint8(2), np.uint8(4), np.uint8(8)
"""The bits of :class:`hfanalysis.record.log.Flag`, as compiled code takes them. Source: definition."""

CONTEXT = 30
"""Runs looked at on either side to tell how long this channel usually repeats itself [runs]."""
STUCK_RUN, STUCK_FACTOR = 20, 20.0
"""Least run of equal readings that may be stuck [samples], and how many times longer than the channel's usual runs it
is. Evidence: with looser rules quantized slow sensors and random dwells were flagged; test_flags.py has both, and a
stalled logger, which is."""
CLIPPED_RUN, CLIPPED_FACTOR = 4, 8.0
"""The same for a run at the channel's exact extreme [samples], which needs less: noise does not meet its extreme often.
Evidence: test_flags.py: a clipped plateau is saturated, noise alone is never flagged."""
NOISE_BLOCK = 256
"""Samples over which noise is estimated [samples]. Evidence: test_flags.py: noise that changes in a log is measured
block by block."""
WINDOW = 8
"""Samples on either side of a spike that say where the channel is without it [samples]."""
LONGEST_SPIKE = 3
"""Samples that a spike has at most [samples]. Evidence: test_flags.py: a sharp pulse of many samples is no spike."""
OUTLYING = 8.0
"""Local standard deviations by which a spike stands out. Evidence: test_flags.py: oscillation and a step with overshoot
are no spikes."""
JUMP = 6.0
"""Standard deviations by which a spike begins: a sample is worth a closer look only then."""
ALONE = 16
"""Samples around a spike in which there may be few others: many are a signal [samples]. Evidence: test_flags.py:
regular pulses are a signal, not spikes."""
COMMON = 0.02
"""Share of samples above which spikes are how this channel reads, not events."""


@compiled(nogil=True)
def nearest(readings: Array, level: float, flags: Flags) -> float:
    """The distance from ``level`` to the nearest other value without a flag, in the unit of the readings.

    ``readings`` and ``flags`` have shape (n,); infinite where there is no other value.
    """
    least = np.inf
    for i in range(len(readings)):
        if not flags[i] and readings[i] != level:
            least = min(least, abs(readings[i] - level))
    return least


@compiled(nogil=True)
def _mark(flags: Flags, start: int, end: int, flag: np.uint8) -> None:
    for i in range(start, end):
        flags[i] |= flag


@compiled(nogil=True)
def _insert(value: float, ordered: Array, count: int) -> None:
    """Puts a value into its place among the first ``count``, which are in order."""
    k = count
    while k > 0 and ordered[k - 1] > value:
        ordered[k] = ordered[k - 1]
        k -= 1
    ordered[k] = value


@compiled(nogil=True)
def _median(ordered: Array, count: int) -> float:
    return float(0.5 * (ordered[(count - 1) // 2] + ordered[count // 2]))


@compiled(nogil=True)
def detached(readings: Array, level: float, gap: float, edges: bool, flags: Flags) -> int:
    """Flags runs of exactly ``level`` entered and left by jumps of more than ``gap``; returns how many samples.

    ``readings`` (n,), ``level`` and ``gap`` are in the channel's logged unit; ``flags`` (n,) is changed. Runs at the
    log's ends have one neighbor only and count where ``edges``.
    """
    n, count, i = len(readings), 0, 0
    while i < n:
        if readings[i] != level:
            i += 1
            continue
        start = i
        while i < n and readings[i] == level:
            i += 1
        before, after = start > 0, i < n
        far = edges or (before and after)
        if before and abs(readings[start - 1] - level) <= gap:
            far = False
        if after and abs(readings[i] - level) <= gap:
            far = False
        if far:
            _mark(flags, start, i, DROPOUT)
            count += i - start
    return count


@compiled(nogil=True)
def _runs(values: Array) -> NDArray[np.int64]:
    """Where runs of exactly equal values start, and the end of the last."""
    n = len(values)
    count = 1
    for i in range(1, n):
        count += values[i] != values[i - 1]
    starts = np.empty(count + 1, np.int64)
    starts[0] = 0
    k = 1
    for i in range(1, n):
        if values[i] != values[i - 1]:
            starts[k] = i
            k += 1
    starts[count] = n
    return starts


@compiled(nogil=True)
def _repeats_at_length(values: Array, low: float, high: float) -> bool:
    """Whether any run is long enough to be looked at."""
    length = 1
    for i in range(1, len(values)):
        if values[i] != values[i - 1]:
            length = 1
            continue
        length += 1
        if length >= STUCK_RUN or (length >= CLIPPED_RUN and (values[i] == low or values[i] == high)):
            return True
    return False


@compiled(nogil=True)
def _usual_run(starts: NDArray[np.int64], first: int, last: int, ordered: Array) -> float:
    """The length that nine in ten of the runs first..last-1 do not exceed; ``ordered`` is overwritten."""
    for k in range(first, last):
        _insert(float(starts[k + 1] - starts[k]), ordered, k - first)
    return float(ordered[int(0.9 * (last - first - 1))])


@compiled(nogil=True)
def _step(values: Array, starts: NDArray[np.int64], k: int) -> float:
    """From the level of run ``k`` to the next one's."""
    return float(abs(values[starts[k + 1]] - values[starts[k]]))


@compiled(nogil=True)
def _usual_step(values: Array, starts: NDArray[np.int64], first: int, last: int, ordered: Array) -> float:
    """The median of the steps after the runs first..last-1; ``ordered`` is overwritten."""
    for k in range(first, last):
        _insert(_step(values, starts, k), ordered, k - first)
    return _median(ordered, last - first)


@compiled(nogil=True)
def repeats(values: Array, low: float, high: float, flags: Flags) -> None:
    """Flags stuck runs, and clipped ones at the channel's exact extremes, against the runs around them.

    ``values`` (n,), its least ``low`` and largest ``high`` are in the channel's logged unit; ``flags`` (n,) is changed.
    A run needs enough others on both sides to be compared with: an idle channel before and after a firing is not stuck.
    Nor is a channel whose noise its resolution swallows: its resolution is its least change.
    """
    if not _repeats_at_length(values, low, high):
        return
    starts = _runs(values)
    runs = len(starts) - 1
    resolution = np.inf if runs > 1 else 0.0
    for k in range(runs - 1):
        resolution = min(resolution, _step(values, starts, k))
    ordered = np.empty(2 * CONTEXT)
    clipped_low = clipped_high = False
    for k in range(5, runs - 5):
        length = starts[k + 1] - starts[k]
        extreme = values[starts[k]] == low or values[starts[k]] == high
        if length < (CLIPPED_RUN if extreme else STUCK_RUN):
            continue
        before = _usual_run(starts, max(0, k - CONTEXT), k, ordered)
        usual = max(before, _usual_run(starts, k + 1, min(runs, k + 1 + CONTEXT), ordered))
        if _usual_step(values, starts, max(0, k - CONTEXT), min(runs - 1, k + CONTEXT), ordered) < 2.0 * resolution:
            continue
        if extreme and length >= CLIPPED_FACTOR * usual:
            clipped_low |= values[starts[k]] == low
            clipped_high |= values[starts[k]] == high
        elif length >= STUCK_FACTOR * usual:
            _mark(flags, starts[k], starts[k + 1], STUCK)
    if clipped_low or clipped_high:
        for i in range(len(values)):
            if (clipped_low and values[i] == low) or (clipped_high and values[i] == high):
                flags[i] |= SATURATED


def local_noise(values: Array) -> Array:
    """Standard deviation of the noise by blocks of NOISE_BLOCK samples, from every fourth difference of neighbors.

    ``values`` (n,) gives (ceil(n / NOISE_BLOCK),), in the same unit. The factor 1.0484 is 1 / (0.6745 sqrt(2)): the
    median of |difference| of two normal samples to the deviation of one. The median of a block is that of sorted
    numbers, which NumPy sorts faster than any code here picks it out.
    """
    steps = np.abs(values[1::4] - values[:-1:4])
    per = NOISE_BLOCK // 4
    whole = len(steps) // per
    noise = np.empty((len(values) + NOISE_BLOCK - 1) // NOISE_BLOCK)
    noise[whole:] = np.median(steps[-per:])
    blocks = np.sort(steps[: whole * per].reshape(whole, per), axis=1)
    noise[:whole] = 0.5 * (blocks[:, per // 2 - 1] + blocks[:, per // 2])
    return 1.0484 * noise


@compiled(nogil=True)
def _middle(values: Array, start: int, end: int, ordered: Array) -> tuple[float, float]:
    """Median, and standard deviation from the median absolute deviation; ``ordered`` is overwritten."""
    for i in range(start, end):
        _insert(values[i], ordered, i - start)
    middle = _median(ordered, end - start)
    for i in range(start, end):
        _insert(abs(values[i] - middle), ordered, i - start)
    return middle, 1.4826 * _median(ordered, end - start)


@compiled(nogil=True)
def _spike_length(values: Array, i: int, noise: float, ordered: Array) -> int:
    """How many samples from ``i`` on stand out alone; 0 where they do not, or the level changes with them."""
    n = len(values)
    left, left_noise = _middle(values, max(0, i - WINDOW), i, ordered)
    for length in range(1, LONGEST_SPIKE + 1):
        after = i + length
        if after + 3 > n:
            return 0
        right, right_noise = _middle(values, after, min(n, after + WINDOW), ordered)
        base, usual = 0.5 * (left + right), max(noise, left_noise, right_noise)
        height = np.inf
        up = values[i] > base
        for j in range(i, after):
            height = min(height, values[j] - base if up else base - values[j])
        back = abs(values[after] - base) < 0.5 * height
        if height > OUTLYING * usual and back and abs(right - left) < 0.3 * height:
            return length
    return 0


@compiled(nogil=True)
def spikes(values: Array, noise: Array, quantum: float, flags: Flags) -> None:
    """Flags groups of up to three samples that stand out of the level they return to, unless they are many.

    ``values`` (n,), ``noise`` (blocks,) of :func:`local_noise` and ``quantum``, the least change, are in the channel's
    logged unit; ``flags`` (n,) is changed.
    """
    n = len(values)
    places = np.empty(64, np.int64)
    lengths = np.empty(64, np.int64)
    ordered = np.empty(WINDOW)
    count, i = 0, 3
    while i < n:
        usual = max(noise[i // NOISE_BLOCK], quantum)
        end, jump = min(n, (i // NOISE_BLOCK + 1) * NOISE_BLOCK), JUMP * usual
        while i < end and abs(values[i] - values[i - 1]) <= jump:
            i += 1
        if i == end:
            continue
        length = _spike_length(values, i, usual, ordered)
        if length == 0:
            i += 1
            continue
        if count == len(places):
            places, lengths = _doubled(places), _doubled(lengths)
        places[count], lengths[count] = i, length
        count += 1
        i += length
    _flag_lonely(places, lengths, count, flags)


@compiled(nogil=True)
def _doubled(numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """The same numbers with room for as many again."""
    made = np.empty(2 * len(numbers), np.int64)
    for i in range(len(numbers)):
        made[i] = numbers[i]
    return made


@compiled(nogil=True)
def _flag_lonely(places: NDArray[np.int64], lengths: NDArray[np.int64], count: int, flags: Flags) -> None:
    total = 0
    for k in range(count):
        total += lengths[k]
    if total > COMMON * len(flags):
        return
    for k in range(count):
        others = 0
        for j in range(max(0, k - 4), min(count, k + 5)):
            others += j != k and abs(places[j] - places[k]) <= ALONE
        if others <= 2:
            _mark(flags, places[k], places[k] + lengths[k], SPIKE)
