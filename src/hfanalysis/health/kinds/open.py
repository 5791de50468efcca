"""An open or broken thermocouple: no reading, temperatures that the place cannot have, noise no bead can follow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.health.coarse import FEW
from hfanalysis.health.cures import exclude
from hfanalysis.health.seen import Seen
from hfanalysis.health.shape import Mask, by_blocks, running_median, stretches
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import Trace
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import text

OXIDIZER = (150.0, 400.0)
"""[K] outside of which tank and line cannot be: below the triple point of nitrous oxide (182 K) and its dry ice, above
a heated bottle that would have burst. Source: CoolProp; a saturated tank reaches its critical point at 309.5 K."""
ANYWHERE = (150.0, 3800.0)
"""[K] outside of which no gas of such an engine is. Source: flame temperature of nitrous oxide and paraffin, 3300 K."""
JUMPY = 8.0
"""[K] of noise between neighboring samples that no bead with a heat capacity shows [-]. Source: interference on a sound
thermocouple is a degree or two; tolerance class 2 is 2.5 K."""
NEARLY = 0.9
"""Part of the log from which on a stretch is all of it [-]. Source: definition."""
BLOCKS = 60
"""Blocks whose noise is asked for."""
LASTING = 0.02
"""Share of the readings in an impossible stretch from which on it is one, not single spikes [-]."""


def find(seen: Seen) -> Iterator[Finding]:
    """Throughout, or from an instant on."""
    if seen.dimension != "temperature" or len(seen.said) < FEW:
        return
    finite = np.isfinite(seen.said)
    values, time = seen.said[finite], seen.channel.time[finite]
    if len(values) < 0.1 * len(seen.said):
        yield _open(seen, "unusable", text("{share:.0f} % of its readings are none", share=100.0 * np.mean(~finite)))
        return
    lost = np.flatnonzero(~finite)
    if len(lost) > LASTING * len(seen.said) and lost[-1] - lost[0] < 2 * len(lost):
        yield _lost(seen, lost)
    low, high = OXIDIZER if seen.name in ("T_tank", "T_run") else ANYWHERE
    level_ = running_median(values)
    outside = (level_ < low) | (level_ > high)
    if outside.mean() > LASTING:
        yield _outside(seen, time, level_, outside)
    elif (found := _jumping(seen, Trace(time, values))) is not None:
        yield found


def _jumping(seen: Seen, trace: Trace) -> Finding | None:
    """From when to when its readings jump as no bead does; throughout where that is most of the log."""
    blocks = by_blocks(trace, BLOCKS)
    noise = np.array([sample_noise(block.values) for block in blocks])
    parts = [(a, b) for a, b in stretches(noise > JUMPY, bridge=2) if b - a >= min(2, len(blocks))]
    if not parts:
        return None
    words = "its readings jump by {noise:.0f} K from one sample to the next, which no bead can follow"
    evidence = text(words, noise=float(np.median(noise[noise > JUMPY])) * np.sqrt(2.0))
    if np.mean(noise > JUMPY) > 0.5 and parts[0][0] == 0:
        return _open(seen, "unusable", evidence)
    start, end = float(blocks[parts[0][0]].time[0]), float(blocks[parts[-1][1] - 1].time[-1])
    return _open(seen, "unusable", evidence, start=start, end=end, cure=exclude([seen.name], start, end))


def _lost(seen: Seen, lost: NDArray[np.intp]) -> Finding:
    """A stretch in which it has no reading, or only the code for an open one."""
    start, end = (float(seen.channel.time[i]) for i in (lost[0], lost[-1]))
    words = "has no reading, or the code for none, from {start:.2f} to {end:.2f} s"
    evidence = text(words, start=start, end=end)
    cure = exclude([seen.name], start, end)
    return _open(seen, "unusable", evidence, start=start, end=end, cure=cure)


def _outside(seen: Seen, time: np.ndarray, values: np.ndarray, outside: Mask) -> Finding:
    parts = list(stretches(outside, bridge=len(values) // 20))
    first, last = parts[0][0], parts[-1][1] - 1
    worst = float(values[outside][np.argmax(np.abs(values[outside] - 300.0))])
    evidence = text(
        "{share:.0f} % of its readings are of temperatures that the place cannot have, up to {worst}",
        share=100.0 * outside.mean(), worst=level(worst, "temperature"),
    )  # fmt: skip
    if time[last] - time[first] > NEARLY * np.ptp(time):
        return _open(seen, "unusable", evidence)
    start, end = float(time[first]), float(time[last])
    return _open(seen, "unusable", evidence, start=start, end=end, cure=exclude([seen.name], start, end))


def _open(seen: Seen, verdict: str, evidence: str, **about: object) -> Finding:
    means = "the thermocouple is open or broken, or its unit is not the stated one: there is no temperature in it"
    return seen.finding("open", verdict, **{"evidence": evidence, "means": means, "cure": None, **about})
