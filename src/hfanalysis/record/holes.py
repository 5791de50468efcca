"""Holes of a log: stretches in which a channel that goes on afterwards has no good sample."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.log import Channel, Flag

SHORTEST_HOLE = 0.1
"""[s] that a hole lasts at least."""

HOLE_STEPS = 10.0
"""Usual steps between samples that it lasts at least. Evidence: test_holes.py: a log without holes has none, whatever
its rate."""

LEAP = 1.5
"""Usual steps from which on a step of an even clock is a leap. Source: by choice: half way to a lost sample."""

LEAPS = 3
"""Leaps that are told; a clock with more of them is not even, and its logger is known to lose samples."""

EVEN = 0.05
"""Share of the usual step by which steps of an even clock differ. Source: by choice: jitter is more."""

UNEVEN = 0.01
"""Share of steps that may differ by more. Source: by choice."""

LEAST_STEPS = 8
"""Steps that tell of an even clock."""

STEPS_ASKED = 20_000
"""Steps, spread over a long log, whose median is the usual one. Evidence: its error is that of 20,000 samples, 1 %."""

HOLES_TOLD = 3
"""Holes that a warning places; of more it gives the number."""


def holes(time: Array) -> Array:
    """From when to when [s] the instants ``time``, which increase, leave a hole: (holes, 2).

    >>> holes(np.array([0.0, 0.1, 0.2, 3.0, 3.1])).tolist()
    [[0.2, 3.0]]
    """
    steps = np.diff(time)
    if not steps.size or steps.max() <= SHORTEST_HOLE:
        return np.empty((0, 2))
    usual = float(np.median(steps[:: max(1, steps.size // STEPS_ASKED)]))
    places = np.flatnonzero(steps > max(SHORTEST_HOLE, HOLE_STEPS * usual))
    return np.column_stack([time[places], time[places + 1]])


def leaps(time: Array) -> Array:
    """Where [s] an even clock ``time`` (n,) steps by more than it usually does, though by less than a hole, and by how
    much more [s], (leaps, 2); none where it is not even, or where that happens all the time.

    >>> leaps(np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.9, 1.0])).round(3).tolist()
    [[0.7, 0.1]]
    """
    steps = np.diff(time)
    if steps.size < LEAST_STEPS:
        return np.empty((0, 2))
    usual = float(np.median(steps[:: max(1, steps.size // STEPS_ASKED)]))
    places = np.flatnonzero(steps > LEAP * usual)
    uneven = np.count_nonzero(np.abs(steps - usual) > EVEN * usual) - places.size
    if not usual > 0.0 or not 0 < places.size <= LEAPS or uneven > UNEVEN * steps.size:
        return np.empty((0, 2))
    places = places[steps[places] <= max(SHORTEST_HOLE, HOLE_STEPS * usual)]
    return np.column_stack([time[places], steps[places] - usual])


def leap_warnings(file: str, time: Array) -> Iterator[str]:
    """One line for the leaps of a file's clock ``time`` (n,) [s]."""
    found = leaps(time)
    if found.size:
        places = ", ".join(f"{by:.3g} s at {at:.2f} s" for at, by in found.tolist())
        yield (
            f"{file}: its clock is even but for a step that is longer by {places} of log time: samples are missing "
            "there, or the clock jumped and all that follows is so much late"
        )


def not_excluded(channel: Channel) -> Array:
    """The holes [s] (holes, 2) of a channel that are not stretches which the engineer excluded."""
    found = holes(channel.time[channel.good] if channel.flags.any() else channel.time)
    if not found.size:
        return found
    left_out = channel.time[(channel.flags & Flag.EXCLUDED) != 0]
    asked = [bool(((left_out > start) & (left_out < end)).any()) for start, end in found]
    return found[~np.array(asked, dtype=bool)] if asked else found


def hole_warnings(found: Iterable[tuple[str, str, Array]], channels: dict[str, int]) -> Iterator[str]:
    """One line for every set of holes.

    Args:
        found: file, channel, and the channel's holes [s], (holes, 2).
        channels: how many channels each file has.
    """
    together: dict[tuple[str, tuple[tuple[float, float], ...]], list[str]] = defaultdict(list)
    for file, name, places in found:
        if places.size:
            together[file, tuple((round(a, 2), round(b, 2)) for a, b in places.tolist())].append(name)
    for (file, places_), names in together.items():
        whose = file if len(names) == channels[file] > 1 else ", ".join(names)
        longest = sorted(sorted(places_, key=lambda hole: hole[0] - hole[1])[:HOLES_TOLD])
        spans = ", ".join(f"{a:.2f} to {b:.2f} s" for a, b in longest)
        more = f" and in {len(places_) - HOLES_TOLD} shorter stretches" if len(places_) > HOLES_TOLD else ""
        yield f"{whose}: no good samples from {spans} of log time{more}; what happens there is not known"
