"""A channel that turns to noise at an instant and stays so: a cell or gauge that dies, a cable that burns.

Burning shakes a cell and a chamber too, but a burn ends, and what is measured in it can be.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.cures import exclude
from hfanalysis.health.seen import Seen
from hfanalysis.health.shape import by_blocks, spread_about_neighbors
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import Trace
from hfanalysis.sentences import text

BLOCKS, LEAST = 80, 8
"""Blocks whose noise is compared, and samples in one at least: a deviation of eight is known to a third."""
LOUDER = 4.0
"""Times the noise of the channel before (in a firing that has begun: of that firing) that noise without a signal has at
least [-]. Evidence: benchmarks/health_rates.py; a tank cell on a shaking stand has seven times that of its rest."""
OF_RANGE = 0.2
"""Part of what the channel ranges over before that such noise has at least [-]: below, a signal may still be in it.
Source: chamber oscillation of an unstable motor, 10 % of the mean and more."""
MOVED = ("p_run", "p_chamber", "thrust", "m_tank", "p_tank")
"""Channels that a firing moves: noise that begins within one, with nothing else in it, is no flow's."""
STAYS, AS_LOUD = 0.9, 1.0 / 3.0
"""Share of the blocks after the instant that are as loud as so much of the usual one there [-]. Source: a deviation of
eight samples, by differences, is known to a third."""
LASTING = 5
"""Blocks at the end of the log that it lasts at least."""


def find(seen: Seen) -> Iterator[Finding]:
    """From an instant to the end of the log."""
    if seen.dimension not in ("pressure", "force", "mass"):
        return
    blocks = by_blocks(seen.heard, BLOCKS, LEAST)
    if len(blocks) < 4 * LASTING:
        return
    noise = np.array([spread_about_neighbors(block.values) for block in blocks])
    at = _turn(noise)
    if at is not None and (told := _finding(seen, blocks, noise, at)) is not None:
        yield told


def _turn(noise: Array) -> int | None:
    """The first block from which on it is loud to the end; None where there is none.

    Of those from which on it stays so, where the contrast of the logarithms is greatest, as for a step in a noisy line:
    a stand that begins to shake with the firing is a step too, but the louder noise of a dead sensor comes after it.
    """
    loud = np.log(np.maximum(noise, 1e-9 * max(float(noise.max()), 1e-300)))
    n, total = len(loud), np.cumsum(loud)
    k = np.array([k for k in range(LASTING, n - LASTING + 1) if _stays(noise, k)], dtype=int)
    if not len(k):
        return None
    contrast = ((total[-1] - total[k - 1]) / (n - k) - total[k - 1] / k) * np.sqrt(k * (n - k))
    return int(k[np.argmax(contrast)])


def _stays(noise: Array, k: int) -> bool:
    """Whether the blocks from one on are all loud, and those before are not."""
    usual = float(np.median(noise[k:]))
    return bool(np.mean(noise[k:] > AS_LOUD * usual) >= STAYS and usual > LOUDER * np.median(noise[:k]))


def _finding(seen: Seen, blocks: list[Trace], noise: Array, at: int) -> Finding | None:
    usual, size = _usual(seen, noise[:at]), float(np.median(noise[at:]))
    if size < LOUDER * usual:
        return None
    levels = np.array([np.median(block.values) for block in blocks])
    start, end = float(blocks[at].time[0]), float(blocks[-1].time[-1])
    drowned = size > max(OF_RANGE * np.ptp(levels), 3.0 * seen.channel.accuracy)
    if not (drowned or (seen.name in MOVED and _within(seen, start) and _flat(blocks[at:], size))):
        return None
    evidence = text(
        "from {start:.2f} s to the end of the log its samples scatter by {size}, before by {usual}, and nothing else "
        "is in them",
        start=start, size=level(size, seen.dimension), usual=level(usual, seen.dimension),
    )  # fmt: skip
    means = "the sensor or its cable has died: what follows is noise, and no signal is in it"
    cure = exclude([seen.name], start, end)
    return seen.finding("noise", "unusable", start=start, end=end, evidence=evidence, means=means, cure=cure)


def _usual(seen: Seen, noise: Array) -> float:
    """The noise before: what is held or cut off has none, and says nothing."""
    rest = seen.coarse.rest
    return max(float(np.median(noise[noise > 0.0])) if (noise > 0.0).any() else 0.0, rest.noise if rest else 0.0)


def _flat(blocks: list[Trace], size: float) -> bool:
    """Whether the blocks' means scatter no more than those of the noise that is in them, some of it slow."""
    means = np.array([block.values.mean() for block in blocks])
    alone = size / np.sqrt(len(blocks[0].values))
    return bool(np.std(means) < 4.0 * alone + 0.1 * size)


def _within(seen: Seen, start: float) -> bool:
    """Whether it begins within the firing: not with it, as a stand's shaking does, nor after it, where nothing is to
    be seen anyway."""
    if seen.fire is None:
        return True
    first, last = seen.fire
    return bool(first + 0.1 * (last - first) + 0.3 < start < last or start < first - 0.1 * (last - first) - 0.3)
