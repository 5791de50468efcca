"""A channel at the end of its range: readings above (or below) it are cut off.

A noisy channel reaches its extreme once; one that is cut off reads the same extreme again and again while it is alive.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.seen import Seen
from hfanalysis.health.shape import stretches
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import text

OFTEN = 8
"""Times that a reading has to come back exactly to be a rail [samples]. Evidence: benchmarks/health_rates.py."""
CROWD = 8.0
"""How many times more often a rail is read than the levels below it [-]: at the top of a smooth curve a level is read
two or three times as often as on its flank, where a distribution is cut off everything above falls on one level."""
MOSTLY = 0.9
"""Share of readings at one level from which on a channel does nothing else [-]; the others are spikes. Source:
definition."""
SPIKES = 0.1
"""Spikes beyond a rail for each reading at it, at most [-]. Evidence: benchmarks/health_rates.py."""
NOISY = 2.0
"""Noise in steps of its resolution from which on a channel does not stand at one level [-]. Source: with a deviation of
two steps, one reading in five is the most frequent."""
CUT = (0.15, 0.95)
"""Share of readings at rest that are cut off, from what to what [-]: fewer are chance, and more may be a quiet
sensor's, of which a knock moves some."""
DIFFER = 0.5
"""Part of the others that are different readings [-]: of noise within few steps of the resolution, few are."""
NEIGHBORS = 12
"""Levels beside a rail that say how often a level is read usually."""


def find(seen: Seen) -> Iterator[Finding]:
    """At either end while the engine fires; or throughout, but for spikes."""
    if seen.dimension not in ("pressure", "force", "mass", "temperature"):
        return
    finite = np.isfinite(seen.said)
    time, values = seen.channel.time[finite], seen.said[finite]
    if len(values) < 10 * OFTEN or np.ptp(values) == 0.0:
        return
    yield from _but_for_spikes(seen, values) or _clipped(seen, time, values) or _cut_at_rest(seen, time, values)


def _but_for_spikes(seen: Seen, values: Array) -> list[Finding]:
    """Nearly all readings are one level, and the others are far from it: a quantized quiet channel flickers to the
    level beside, which is within its accuracy."""
    levels, counts = np.unique(values, return_counts=True)
    most = levels[np.argmax(counts)]
    if counts.max() < MOSTLY * len(values):
        return []
    away = np.abs(values[values != most] - most)
    if float(np.median(away)) <= max(seen.channel.accuracy, 1e-3 * abs(most)):
        return []
    words = "{share:.1f} % of its readings are {value} to the last digit, the other {n} are spikes of up to {far}"
    evidence = text(
        words, share=100.0 * counts.max() / len(values), value=level(float(most), seen.dimension), n=len(away),
        far=level(float(away.max()), seen.dimension),
    )  # fmt: skip
    means = "at the end of its range or not connected, with interference on it: it measures nothing in this test"
    return [seen.finding("railed", "unusable", evidence=evidence, means=means, cure=None)]


def _clipped(seen: Seen, time: Array, values: Array) -> list[Finding]:
    if seen.fire is None:
        return []
    live = (time >= seen.fire[0]) & (time <= seen.fire[1])
    found = []
    for sign, side in ((1.0, "highest"), (-1.0, "lowest")):
        rail = _rail(sign * values[live]) if live.any() else None
        if rail is None or np.count_nonzero(sign * values > rail) > SPIKES * np.count_nonzero(sign * values == rail):
            continue
        if not _shows_noise(seen, values, sign * rail):
            continue
        # at rest a channel may well stand at its lower end: only what is cut off of the firing matters
        if sign > 0.0 or _in_the_middle(seen, time, values == -rail):
            found.append(_finding(seen, time, values, sign * rail, side))
    return found or _held_up(seen, time, values) or _held_down(seen, time, values)


def _held_down(seen: Seen, time: Array, values: Array) -> list[Finding]:
    """Nothing is seen above a level, which a full tank stands at before the firing, though its noise is seen below."""
    rail = _rail(values)
    if rail is None or not _noisy(seen, values, rail):
        return []
    return [_finding(seen, time, values, rail, "highest")]


def _held_up(seen: Seen, time: Array, values: Array) -> list[Finding]:
    """Nothing is seen of what empties below a level at which it never rests, though its noise is seen above."""
    rail = _rail(-values)
    if rail is None or not _of_no_rest(seen, -rail) or not _noisy(seen, values, -rail):
        return []
    return [_finding(seen, time, values, -rail, "lowest")]


def _cut_at_rest(seen: Seen, time: Array, values: Array) -> list[Finding]:
    """The lower part of its noise at rest is missing: what it reads there is no zero."""
    if seen.fire is None:
        return []
    lowest = float(values.min())
    levels = [level for level in (seen.coarse.rest, seen.coarse.last) if level is not None]
    if not any(_half_cut(values[(time >= at.span[0]) & (time <= at.span[1])], lowest) for at in levels):
        return []
    at, middle = values == lowest, 0.5 * sum(seen.fire)
    parts = [at & (time < middle), at & (time > middle)]
    return [_finding(seen, time[part], values[part], lowest, "lowest") for part in parts if part.any()]


def _half_cut(values: Array, lowest: float) -> bool:
    """Whether many readings (n,) are the lowest one to the last digit, and the others hardly ever the same."""
    above = values[values != lowest]
    often = len(values) - len(above)
    return often >= OFTEN and CUT[0] < often / len(values) < CUT[1] and len(np.unique(above)) > DIFFER * len(above)


def _rail(values: Array) -> float | None:
    """The level (of ``values`` (n,), looked at from above) at which they are cut off; None where they are not."""
    levels, counts = np.unique(values, return_counts=True)
    if not len(levels) or counts.max() < OFTEN:
        return None
    top = int(np.argmax(np.where(counts >= max(OFTEN, 0.005 * len(values)), np.arange(len(levels)), -1)))
    above, count = int(counts[top + 1 :].sum()), int(counts[top])
    if count < max(OFTEN, 0.005 * len(values)) or above > SPIKES * count:
        return None
    below = counts[max(0, top - NEIGHBORS) : top]
    usual = float(np.mean(below)) if len(below) else 0.0
    return float(levels[top]) if count > CROWD * usual + 4.0 * np.sqrt(max(usual, 1.0)) else None


def _shows_noise(seen: Seen, values: Array, rail: float) -> bool:
    """Whether the channel has noise where it is not at the rail, or comes from far below: a quiet sensor of few bits
    stands at one level for long."""
    rest = seen.coarse.rest
    if rest is not None and abs(rail - rest.value) > max(3.0 * seen.channel.accuracy, 10.0 * seen.coarse.quantum):
        return True
    return _noisy(seen, values, rail)


def _noisy(seen: Seen, values: Array, rail: float) -> bool:
    return sample_noise(values[values != rail]) >= NOISY * seen.coarse.quantum


def _in_the_middle(seen: Seen, time: Array, at: Array) -> bool:
    """Whether a third of the middle half of the firing reads it."""
    assert seen.fire is not None
    start, end = seen.fire
    middle = (time > start + 0.25 * (end - start)) & (time < end - 0.25 * (end - start))
    return bool(middle.any()) and float(np.mean(at[middle])) > 1.0 / 3.0


def _of_no_rest(seen: Seen, rail: float) -> bool:
    """Whether a channel stands at a level where it rests neither before the firing nor, emptied, after it."""
    rest, off = seen.coarse.rest, max(3.0 * seen.channel.accuracy, 10.0 * seen.coarse.quantum)
    empty = (0.0, seen.ambient) if seen.dimension == "pressure" else (0.0,)
    return rest is not None and all(abs(rail - level) > off for level in (rest.value, *empty))


def _finding(seen: Seen, time: Array, values: Array, rail: float, side: str) -> Finding:
    at = values == rail
    near = list(stretches(at, bridge=max(5, len(values) // 200)))
    start, end = float(time[near[0][0]]), float(time[near[-1][1] - 1])
    words = "reads its {side} level, {value}, {n} times to the last digit between {start:.2f} and {end:.2f} s"
    evidence = text(
        words, side=side, value=level(rail, seen.dimension), n=int(at.sum()), start=start, end=end
    )  # fmt: skip
    means = f"at the end of its range: the truth was {'higher' if side == 'highest' else 'lower'}, nobody knows how far"
    return seen.finding("railed", "unusable", start=start, end=end, evidence=evidence, means=means, cure=None)
