"""A zero that drifts while nothing happens: what it does before the firing it does in it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.health.firing import EMPTY_LINE, usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.shape import by_blocks
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import MARGIN, Trace
from hfanalysis.sentences import text

LONGEST = 10.0
"""[s] before the firing that are looked at: earlier, a stand is still worked on."""
SHORTEST = 2.0
"""[s] of quiet below which no drift is told from noise."""
BLOCKS = 12
"""Blocks whose means a straight line is laid through."""
DEVIATIONS = 8.0
"""Deviations of its slope that a drift has to have [-]."""
SHARE = 0.02
"""Part of its rise by which a drift has to change the channel through the firing [-]."""
ACCURACIES = 3.0
"""Deviations of the stated accuracy by which it has to; where none is stated, the share alone counts [-]."""
STRAIGHT = 0.9
"""Part of the blocks' variance that the line has to explain [-]: a step or a knock is no drift."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Of the thrust cell, the chamber and an empty run line: nothing else changes them before the firing."""
    for name in ("thrust", "p_chamber", "p_run"):
        seen = test.get(name)
        if seen is None or test.fire is None or seen.coarse.rest is None or not seen.coarse.rise:
            continue
        if name == "p_run" and seen.coarse.rest.value > EMPTY_LINE:
            continue
        found = _drift(test, seen)
        if found is not None:
            yield found


def _drift(test: SeenTest, seen: Seen) -> Finding | None:
    assert test.fire is not None
    assert seen.coarse.rise is not None
    start, end = test.fire
    quiet = usable(test, seen).between(start - LONGEST, start - MARGIN)
    fitted = _line(quiet)
    if fitted is None:
        return None
    slope, error = fitted
    through = slope * (end - start)
    stated = ACCURACIES * seen.channel.accuracy if seen.channel.accuracy_stated else 0.0
    least = max(SHARE * abs(seen.coarse.rise), stated)
    if abs(slope) < DEVIATIONS * error or abs(through) < least:
        return None
    words = "drifts by {rate} a second over {quiet:.1f} s before the firing: by {through} through it, were it to go on"
    evidence = text(
        words, rate=level(slope, seen.dimension), quiet=float(np.ptp(quiet.time)),
        through=level(through, seen.dimension),
    )  # fmt: skip
    means = "its zero drifts: warmed, leaking, or a cell under a load that creeps"
    return seen.finding("drift", "suspect", evidence=evidence, means=means, cure=None, bias=abs(through))


def _line(quiet: Trace) -> tuple[float, float] | None:
    """Slope of the blocks' means [SI/s] and its deviation; None where they are few or no line."""
    blocks = by_blocks(quiet, BLOCKS, least=2)
    if len(blocks) < BLOCKS or float(np.ptp(quiet.time)) < SHORTEST:
        return None
    time = np.array([b.time.mean() for b in blocks])
    means = np.array([b.values.mean() for b in blocks])
    (slope, level_), covariance = np.polyfit(time - time.mean(), means, 1, cov=True)
    rest = means - level_ - slope * (time - time.mean())
    straight = 1.0 - float(np.var(rest)) / max(float(np.var(means)), 1e-300)
    return (float(slope), float(np.sqrt(covariance[0, 0]))) if straight > STRAIGHT else None
