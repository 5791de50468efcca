"""Stretches without a reading: codes that stand for none, a transmitter's fault current, pressures below vacuum."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.cures import exclude
from hfanalysis.health.seen import Seen
from hfanalysis.health.shape import Mask, running_median, stretches
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.holes import holes
from hfanalysis.record.log import Flag
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import text

MEASURED = ("pressure", "force", "mass")
"""Dimensions of sensors whose readings are looked at one by one."""
LOST = "a code for no reading, or a signal that is lost for a while"
BELOW = 3.0
"""Deviations of the sensor's accuracy below vacuum from which on a pressure is none [-]."""
FEWEST = 3
"""Samples that a stretch below vacuum lasts at least: fewer are spikes."""
HELD = 5
"""Equal readings in a row that noise does not make [samples]."""
OFTEN_EQUAL = 0.3
"""Share of readings that equal the one before from which on a channel may well hold a level [-]."""
JUMP = 20.0
"""Deviations of a sample from the one before that a jump has at least [-]."""
QUIET, FEW_QUIET = 0.2, 8
"""Part of its usual noise below which a channel is quieter than it ever is by chance, over so many samples [-]. Source:
eight normal samples scatter by so little once in ten thousand times, and these lie between two jumps."""
AT_ONCE = 0.02
"""[s] in which no valve moves: where samples are so close, a level between two jumps is no flow's. Source: the fastest
solenoid valves open in 10 to 20 ms, ball valves in 50 ms and more."""
FLAT, CONTINUED, AWAY = 0.01, 0.15, 0.1
"""Parts of its jumps by which such a level scatters at most, by which the channel goes on elsewhere than where it was
at most, and by which it is not the channel's rest at least [-]."""
MAJORITY = 0.5
"""Part of the firing for which a cell is so far below that it is no drop-out but its sign [-]. Source: definition."""
STILL, STILL_OF = 5, 0.25
"""Samples of a firing that are to be left in a channel without those that are far above all others, away from its rest
by so much of what it ranges over: a tank falls by a third."""
BRIDGED = 0.1
"""[s] between two stretches below which they are told as one."""
TOLD = 5
"""Stretches that are told one by one."""


def find(seen: Seen) -> Iterator[Finding]:
    """Below vacuum, where every reading of a stretch stands for none, between two jumps, and far from all else."""
    if not _reversed(seen):
        if seen.dimension == "pressure":
            yield from _below_vacuum(seen)
        yield from _coded(seen)
    yield from _between_jumps(seen)
    yield from _apart(seen)


def _below_vacuum(seen: Seen) -> Iterator[Finding]:
    time, values = _read(seen)
    if len(values) < 4 * FEWEST:
        return
    rest = seen.coarse.rest.value if seen.coarse.rest else seen.ambient
    limit = min(0.0, rest) - BELOW * seen.channel.accuracy
    bridge = max(FEWEST, round(BRIDGED * seen.coarse.rate))
    found = [(a, b) for a, b in stretches(running_median(values) < limit, bridge) if b - a >= FEWEST]
    for a, b in found[:TOLD]:
        start, end = float(time[a]), float(time[b - 1])
        mean = float(np.median(values[a:b]))
        words = "reads {value} absolute from {start:.2f} to {end:.2f} s ({n} samples), and no pressure is below vacuum"
        evidence = text(words, value=level(mean, "pressure"), start=start, end=end, n=b - a)
        yield _none(seen, start, end, evidence, "a code for no reading, a transmitter's fault current or a broken wire")


def _reversed(seen: Seen) -> bool:
    """Whether a pressure goes below vacuum as far as others go up, and comes back: a reversed sign is another kind."""
    rest, last = seen.coarse.rest, seen.coarse.last
    if seen.fire is None or seen.dimension != "pressure" or rest is None or last is None:
        return False
    part = seen.heard.between(*seen.fire).values
    if len(part) < 4 * FEWEST:
        return False
    low, high = np.percentile(part, (10.0, 90.0))
    falls = rest.value - low
    return bool(low < 0.0 and high - rest.value < 0.3 * falls and last.value - low > 0.5 * falls)


def _read(seen: Seen) -> tuple[Array, Array]:
    """Time and values (n,) of all that is a number: what ingest takes for stuck or cut off is a reading still."""
    lost = (seen.channel.flags & np.uint8(Flag.DROPOUT | Flag.TIME | Flag.EXCLUDED)) != 0
    kept = np.isfinite(seen.said) & ~lost
    return seen.channel.time[kept], seen.said[kept]


def _between_jumps(seen: Seen) -> Iterator[Finding]:
    """A level between two jumps that the channel does not hold by itself: to the last digit, or quieter than its noise
    ever is, or flat in the middle of a curve that goes on after it as if nothing had been."""
    time, values = _read(seen)
    if seen.dimension not in MEASURED or len(values) < 20 * HELD:
        return
    step = max(sample_noise(values), seen.coarse.quantum)
    if seen.coarse.repetition > OFTEN_EQUAL or not step > 0.0:
        return
    jumps = np.diff(values)
    at = np.flatnonzero(np.abs(jumps) > max(JUMP * step, 3.0 * seen.channel.accuracy))
    for a, b in zip(at[:-1].tolist(), at[1:].tolist(), strict=True):
        part = values[a + 1 : b + 1]
        if len(part) < HELD or jumps[a] * jumps[b] > 0.0:
            continue
        if np.ptp(part) == 0.0 or _quieter(part, step) or _interrupts(seen, values, a, b):
            start, end = float(time[a + 1]), float(time[b])
            words = "stands at {value} from {start:.2f} to {end:.2f} s, stiller than ever, and jumps there and back"
            evidence = text(words, value=level(float(np.median(part)), seen.dimension), start=start, end=end)
            yield _none(seen, start, end, evidence, LOST)


def _quieter(part: Array, step: float) -> bool:
    return len(part) >= FEW_QUIET and float(np.std(part)) < QUIET * step


def _interrupts(seen: Seen, values: Array, a: int, b: int) -> bool:
    """Whether the readings after ``a`` and up to ``b`` are one level, not that at rest, in a curve that goes on."""
    part, rest = values[a + 1 : b + 1], seen.coarse.rest
    if seen.coarse.rate * AT_ONCE < 1.0 or len(part) < FEW_QUIET or rest is None or b + 1 >= len(values):
        return False
    size = min(abs(part[0] - values[a]), abs(values[b + 1] - part[-1]))
    flat = float(np.ptp(np.percentile(part, (5.0, 95.0)))) < FLAT * size
    away = abs(float(np.median(part)) - rest.value) > AWAY * size
    return bool(flat and away and abs(values[b + 1] - values[a]) < CONTINUED * size)


def _apart(seen: Seen) -> Iterator[Finding]:
    """Readings farther from all else than all else ranges; of pressures above it, for below is vacuum."""
    time, values = _read(seen)
    if seen.dimension not in MEASURED or len(values) < 20 * HELD or seen.fire is None:
        return
    for sign in (1.0,) if seen.dimension == "pressure" else (-1.0, 1.0):
        off = _far(seen, sign * values)
        firing = (time > seen.fire[0]) & (time < seen.fire[1])
        if off is None or not off[firing].any():
            continue
        rest = values[~off]
        if _rests_there(seen, values, off):
            continue
        if np.mean(off[firing]) > MAJORITY if sign < 0.0 else not _stands_out(seen, values, off, firing):
            continue
        for a, b in list(stretches(off))[:TOLD]:
            if b - a >= FEWEST and a >= FEWEST:
                start, end = float(time[a]), float(time[b - 1])
                words = "reads {value} from {start:.2f} to {end:.2f} s ({n} samples), and {low} to {high} otherwise"
                evidence = text(
                    words, value=level(float(np.median(values[a:b])), seen.dimension), start=start, end=end, n=b - a,
                    low=level(float(rest.min()), seen.dimension), high=level(float(rest.max()), seen.dimension),
                )  # fmt: skip
                yield _none(seen, start, end, evidence, LOST)


def _rests_there(seen: Seen, values: Array, off: Mask) -> bool:
    """Whether what is far from all else is where the channel rests: a firing that begins and ends at once."""
    rest = seen.coarse.rest
    if rest is None:
        return False
    gap = float(np.abs(np.median(values[~off]) - np.median(values[off])))
    return abs(float(np.median(values[off])) - rest.value) < AWAY * gap


def _far(seen: Seen, values: Array) -> Mask | None:
    """Which of the readings (n,) are above the widest gap in their upper half; None where it is no wider than what all
    others range over."""
    ordered = np.sort(values)
    first = len(ordered) // 2
    gap = first + int(np.argmax(np.diff(ordered[first:])))
    rest = ordered[: gap + 1]
    wide = ordered[gap + 1] - ordered[gap] > max(float(np.ptp(rest)), 6.0 * seen.channel.accuracy)
    return values > ordered[gap] if wide else None


def _stands_out(seen: Seen, values: Array, off: Mask, firing: Mask) -> bool:
    """Whether what is far above all others is one level, entered and left at once, and no firing: the others show that
    still, by a cell that is pushed or becomes lighter, not by a zero that has moved."""
    if seen.coarse.rest is None:
        return False
    moved = values[~off & firing] - seen.coarse.rest.value
    moved = {"force": moved, "mass": -moved}.get(seen.dimension, np.abs(moved))
    fires = np.count_nonzero(moved > STILL_OF * np.ptp(values[~off])) >= STILL
    gap = float(values[off].min() - values[~off].max())
    flat = float(np.ptp(np.percentile(values[off], (5.0, 95.0)))) < FLAT * gap
    edges = np.flatnonzero(np.diff(off.astype(np.int8)))
    return bool(fires and flat and (np.abs(np.diff(values))[edges] >= gap).all())


def _coded(seen: Seen) -> Iterator[Finding]:
    """Holes in which the log has rows, but no reading that is one."""
    none = (seen.channel.flags & np.uint8(Flag.DROPOUT)) != 0
    if seen.dimension in ("dimensionless", "temperature") or not none.any() or none.mean() > 0.9:
        return
    stamps = seen.channel.time[none]
    for start, end in holes(seen.trace.time)[:TOLD]:
        inside = int(np.count_nonzero((stamps > start) & (stamps < end)))
        if inside >= FEWEST:
            words = "its {n} readings between {start:.2f} and {end:.2f} s stand for none"
            evidence = text(words, n=inside, start=float(start), end=float(end))
            yield _none(seen, float(start), float(end), evidence, "the logger had no value there: a code or a blank")


def _none(seen: Seen, start: float, end: float, evidence: str, means: str) -> Finding:
    cure = exclude([seen.name], start, end)
    return seen.finding("dropout", "unusable", start=start, end=end, evidence=evidence, means=means, cure=cure)
