"""Stretches without a reading: codes that stand for none, a transmitter's fault current, pressures below vacuum."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.cures import exclude
from hfanalysis.health.seen import Seen
from hfanalysis.health.shape import running_median, stretches
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.holes import holes
from hfanalysis.record.log import Flag
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import text

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
MAJORITY = 0.5
"""Part of the firing for which a cell is so far below that it is no drop-out but its sign [-]. Source: definition."""
BRIDGED = 0.1
"""[s] between two stretches below which they are told as one."""
TOLD = 5
"""Stretches that are told one by one."""


def find(seen: Seen) -> Iterator[Finding]:
    """Below vacuum, and where every reading of a stretch stands for none."""
    if seen.dimension == "pressure":
        yield from _below_vacuum(seen)
    yield from _coded(seen)
    yield from _held(seen)
    yield from _below(seen)


def _below_vacuum(seen: Seen) -> Iterator[Finding]:
    time, values = _read(seen)
    if len(values) < 4 * FEWEST:
        return
    rest = seen.coarse.rest.value if seen.coarse.rest else seen.ambient
    if _reversed(seen, rest):
        return
    limit = min(0.0, rest) - BELOW * seen.channel.accuracy
    bridge = max(FEWEST, round(BRIDGED * seen.coarse.rate))
    found = [(a, b) for a, b in stretches(running_median(values) < limit, bridge) if b - a >= FEWEST]
    for a, b in found[:TOLD]:
        start, end = float(time[a]), float(time[b - 1])
        mean = float(np.median(values[a:b]))
        words = "reads {value} absolute from {start:.2f} to {end:.2f} s ({n} samples), and no pressure is below vacuum"
        evidence = text(words, value=level(mean, "pressure"), start=start, end=end, n=b - a)
        yield _none(seen, start, end, evidence, "a code for no reading, a transmitter's fault current or a broken wire")


def _reversed(seen: Seen, rest: float) -> bool:
    """Whether it goes below vacuum as far as others go up, and comes back: a reversed sign, which is another kind."""
    if seen.fire is None:
        return False
    part = seen.trace.between(*seen.fire).values
    if len(part) < 4 * FEWEST:
        return False
    low, high = np.percentile(part, (10.0, 90.0))
    last = seen.coarse.last
    return bool(high - rest < 0.3 * (rest - low) and last is not None and last.value - low > 0.5 * (rest - low))


def _read(seen: Seen) -> tuple[Array, Array]:
    """Time and values (n,) of all that is a number: what ingest takes for stuck or cut off is a reading still."""
    lost = (seen.channel.flags & np.uint8(Flag.DROPOUT | Flag.TIME | Flag.EXCLUDED)) != 0
    kept = np.isfinite(seen.said) & ~lost
    return seen.channel.time[kept], seen.said[kept]


def _held(seen: Seen) -> Iterator[Finding]:
    """One level to the last digit between two jumps, in a channel that is never twice the same otherwise."""
    time, values = _read(seen)
    if seen.dimension not in ("pressure", "force", "mass") or len(values) < 20 * HELD:
        return
    step = max(sample_noise(values), seen.coarse.quantum)
    if seen.coarse.repetition > OFTEN_EQUAL or not step > 0.0:
        return
    jump = np.abs(np.diff(values)) > max(JUMP * step, 3.0 * seen.channel.accuracy)
    for a, b in stretches(np.diff(values) == 0.0):
        if b - a >= HELD and a > 0 and b < len(jump) and jump[a - 1] and jump[b]:
            start, end = float(time[a]), float(time[b])
            words = "stands at {value} to the last digit from {start:.2f} to {end:.2f} s, and jumps there and back"
            evidence = text(words, value=level(float(values[a]), seen.dimension), start=start, end=end)
            yield _none(seen, start, end, evidence, "a code for no reading, or a signal that is lost for a while")


def _below(seen: Seen) -> Iterator[Finding]:
    """Forces and masses farther below all else than all else ranges: a cell that is pulled comes back slower."""
    time, values = _read(seen)
    if seen.dimension not in ("force", "mass") or len(values) < 20 * HELD or seen.fire is None:
        return
    ordered = np.sort(values)
    gap = int(np.argmax(np.diff(ordered[: len(ordered) // 3])))
    rest = ordered[gap + 1 :]
    if ordered[gap + 1] - ordered[gap] < max(float(np.ptp(rest)), 6.0 * seen.channel.accuracy):
        return
    low = values < ordered[gap + 1]
    if np.mean(low[(time > seen.fire[0]) & (time < seen.fire[1])]) > MAJORITY:
        return
    for a, b in list(stretches(low))[:TOLD]:
        if b - a >= FEWEST and a >= FEWEST:
            start, end = float(time[a]), float(time[b - 1])
            words = "reads {value} from {start:.2f} to {end:.2f} s ({n} samples), and {low} to {high} otherwise"
            evidence = text(
                words, value=level(float(np.median(values[a:b])), seen.dimension), start=start, end=end, n=b - a,
                low=level(float(rest[0]), seen.dimension), high=level(float(rest[-1]), seen.dimension),
            )  # fmt: skip
            yield _none(seen, start, end, evidence, "a code for no reading, or a signal that is lost for a while")


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
