"""A channel that shows nothing of a firing which others show: dead, throughout or for a while."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.cures import exclude
from hfanalysis.health.firing import EMPTY_LINE, STEP, own_zero, usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.shape import stretches
from hfanalysis.health.words import called, level
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import in_blocks
from hfanalysis.sentences import text

FIRES = {"p_chamber": 3e5, "thrust": 100.0, "p_run": 5e5}
"""Rise [Pa, N] from which on a channel shows a firing, not interference. Evidence: 0.1 bar of interference on a dead
chamber gauge; a chamber that is not choked (1 bar above ambient) may leave others unmoved."""
NOISES = 5.0
"""Deviations of its levels' means that a channel has to have moved to show something [-]."""
INTERFERENCE = 0.5e5
"""[Pa] up to which a rise may be interference on a dead gauge. Evidence: 0.1 bar seen; a chamber that is not choked
rises by less than 1 bar."""
WIDEST = 5e-3
"""[m^2] of a throat that no such stand has (80 mm across): thrust over a smaller pressure than this is no thrust's."""
HELD = 75.0
"""Percentile of the firing that a channel holds for a good part of it [-]: fuel or liquid may be gone early in it."""
AT_REST = 0.05
"""Part of what it should be at least within which a pressure counts as at rest [-]."""
SHORTEST = 0.1
"""[s] for which a channel is dead at least."""

EMPTIED = 0.3
"""Part of its pressure that a tank loses at least when it is emptied through its line [-]. Source: health/ties/sign.py:
one that is empty of liquid has lost a third to a half."""
NEEDS = {
    "p_chamber": ("thrust", "p_run"), "thrust": ("p_chamber",), "p_run": ("p_chamber",),
    "p_tank": ("p_run", "p_chamber"),
}  # fmt: skip
"""Channel -> those that cannot rise without it."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Dead throughout, or where a line reads ambient while the chamber behind it is under pressure."""
    if test.fire is None:
        return
    for name, others in NEEDS.items():
        seen = test.get(name)
        if seen is None:
            continue
        shown = next((o for o in others if _shows(test, o) and (o != "p_run" or _fed(test, name))), None)
        if shown is not None and _nothing(test, seen, test.channels[shown]):
            yield _dead(test, seen, test.channels[shown])
    yield from _gone_for_a_while(test)


def _shows(test: SeenTest, name: str) -> bool:
    seen = test.get(name)
    return seen is not None and (_rise(test, seen) or 0.0) > FIRES[name]


def _fed(test: SeenTest, name: str) -> bool:
    """Whether what the line shows reaches a channel behind the injector: the tank is emptied, into a stated fire.

    Of a fire that is only stated, and a line that is only filled, a chamber shows nothing.
    """
    tank = test.get("p_tank")
    if name == "p_tank":
        return True
    if test.definition.test.kind != "hot_fire" or tank is None or tank.coarse.rest is None or tank.coarse.last is None:
        return False
    run = test.channels["p_run"].coarse
    falls = run.last is not None and run.plateau is not None and run.last.value < run.plateau
    return falls and tank.coarse.last.value < (1.0 - EMPTIED) * tank.coarse.rest.value


def _rise(test: SeenTest, seen: Seen) -> float | None:
    """From rest to what it holds for a good part of the firing [SI]."""
    assert test.fire is not None
    start, end = test.fire
    part = in_blocks(usable(test, seen).between(start, end), STEP * 5.0).values
    if not len(part) or seen.coarse.rest is None:
        return None
    fall = seen.name == "p_tank"
    return float(np.percentile(part, 100.0 - HELD if fall else HELD)) - seen.coarse.rest.value


def _nothing(test: SeenTest, seen: Seen, other: Seen) -> bool:
    """Whether a channel is where it rests all the while, or lower."""
    rise, rest = _rise(test, seen), seen.coarse.rest
    if rise is None or rest is None:
        return False
    noise = NOISES * rest.noise / sqrt(10.0)
    if seen.name == "p_tank":
        # a regulated tank does not fall, but what it feeds is never above it
        other_level = (_rise(test, other) or 0.0) + test.ambient
        return bool(abs(rise) < max(noise, 0.02 * other_level)) and rest.value + rise < 0.7 * other_level
    if seen.name == "p_chamber":
        # a low gauge rises with the thrust, a dead one does not: the throat that the two would need tells
        small = rise < max(noise, seen.channel.accuracy)
        return small or (other.name == "thrust" and rise < INTERFERENCE and (_rise(test, other) or 0.0) / rise > WIDEST)
    if seen.name == "thrust":
        return abs(rise) < max(noise, 1e-6 * (_rise(test, other) or 0.0))
    # a line that is filled up to its valve falls in the firing, but not below the chamber
    held = rest.value > EMPTY_LINE and rest.value + rise > (_rise(test, other) or 0.0)
    return not held and rise < max(noise, AT_REST * (_rise(test, other) or 0.0))


def _dead(test: SeenTest, seen: Seen, other: Seen) -> Finding:
    rise, more = _rise(test, seen) or 0.0, _rise(test, other) or 0.0
    words = "moves by {rise} in the firing, in which {other} rises by {more}"
    evidence = text(
        words, rise=level(rise, seen.dimension), other=called(other.name), more=level(more, other.dimension)
    )  # fmt: skip
    means = "dead: not connected, blocked, or another channel's column; it measures nothing of this firing"
    return seen.finding("dead", "unusable", evidence=evidence, means=means, cure=None)


def _gone_for_a_while(test: SeenTest) -> Iterator[Finding]:
    """A line at ambient with a chamber under pressure behind it."""
    run, chamber = test.get("p_run"), test.get("p_chamber")
    if run is None or chamber is None or test.fire is None or not _shows(test, "p_chamber"):
        return
    trace = in_blocks(usable(test, run).between(*test.fire), STEP)
    behind = in_blocks(usable(test, chamber), STEP)
    if len(trace.time) < 8 or len(behind.time) < 8:
        return
    p_c = np.interp(trace.time, behind.time, behind.values) - own_zero(chamber) - test.ambient
    p_run = trace.values - own_zero(run) - test.ambient
    dead = (p_c > FIRES["p_chamber"]) & (p_run < np.maximum(AT_REST * p_c, 3.0 * _noise(run)))
    for a, b in stretches(dead, bridge=2):
        start, end = float(trace.time[a]), float(trace.time[b - 1])
        # a slow gauge that still fills up, and a chamber that empties more slowly than its line, are other kinds
        there = all(len(part) and part.max() > p_c[a:b].mean() for part in (p_run[:a], p_run[b:]))
        if end - start >= SHORTEST and there:
            yield _for_a_while(run, start, end, p_c[a:b])


def _noise(seen: Seen) -> float:
    return seen.coarse.rest.noise if seen.coarse.rest else 0.0


def _for_a_while(run: Seen, start: float, end: float, p_c: Array) -> Finding:
    words = "reads ambient from {start:.2f} to {end:.2f} s while the chamber behind it stands {p_c} above ambient"
    evidence = text(words, start=start, end=end, p_c=level(float(p_c.mean()), "pressure"))
    means = "its signal is lost for a while: no line is below the chamber that it feeds"
    cure = exclude([run.name], start, end)
    return run.finding("dead", "unusable", start=start, end=end, evidence=evidence, means=means, cure=cure)
