"""Courses: an effect that is larger or smaller than its closure says, from one second to the next.

A real effect never has quite the shape that its closure gives it. What it may be off by is linear: hats over the time
of each phase, times what the effect adds to the channels.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.hypothesis import OF_COURSE, Free, Hypothesis
from hfanalysis.inference.fitting.predict import signatures
from hfanalysis.inference.observations.observed import Observed

SHAPE_ERROR = 0.2
"""By how much, relative to itself, an effect may be larger or smaller than its closure says."""

SHAPE_TIME = 1.5
"""Seconds between the knots of that error."""

SOONEST, DENSER = 0.1, 3.0
"""Seconds from the beginning of a phase to the second knot, and the ratio of distances from there until they are
SHAPE_TIME: what begins with a phase, a line that fills or a layer that is drawn off, is over in tenths of a second."""


def courses(hypothesis: Hypothesis, observed: Observed, x: Array) -> Array | None:
    """What a standard deviation at each knot adds to the blocks of all channels [SI], (blocks, knots), at ``x``
    (parameters,); None where the engine cannot be run."""
    try:
        signature = signatures(hypothesis, observed, x)
    except (ValueError, ArithmeticError):
        return None
    return SHAPE_ERROR * _over_time(signature, observed) if signature.shape[1] else None


def with_courses(hypothesis: Hypothesis, observed: Observed, x: Array) -> tuple[Hypothesis, Observed]:
    """The hypothesis with the courses of its effects free beside its departures, and the observations with what these
    add at ``x`` (parameters,); both as they are where the engine cannot be run or no effect is free."""
    columns = courses(hypothesis, observed, x)
    if columns is None:
        return hypothesis, observed
    count, channels, at = columns.shape[1], [], 0
    for channel in observed.channels:
        own, at = columns[at : at + channel.time.size], at + channel.time.size
        channels.append(replace(channel, courses=own))
    free = tuple(Free(f"{OF_COURSE}{i}", 0.0, 1.0) for i in range(count))
    return replace(hypothesis, free=(*hypothesis.free, *free)), replace(observed, channels=tuple(channels))


def _knots(start: float, end: float) -> Array:
    """Instants [s] between which slack is linear: dense where a phase begins.

    >>> _knots(0.0, 4.0).round(2).tolist()
    [0.0, 0.1, 0.4, 1.3, 2.65, 4.0]
    """
    knots, step = [start], SOONEST
    while step < SHAPE_TIME and knots[-1] + 2.0 * step < end:
        knots.append(knots[-1] + step)
        step *= DENSER
    rest = max(int(np.ceil((end - knots[-1]) / SHAPE_TIME)), 1)
    return np.concatenate([knots[:-1], np.linspace(knots[-1], end, rest + 1)])


def _over_time(signature: Array, observed: Observed) -> Array:
    """Columns: each signature times hats over the time of each phase."""
    time = np.concatenate([c.time for c in observed.channels])
    ends = [0.0, *(t for name, t in observed.phases.items() if name == "vapor"), float(time.max())]
    columns = []
    for start, end in pairwise(ends):
        knots = _knots(start, end)
        inside = (time >= start) & (time < end)
        for k in range(knots.size):
            hat = np.interp(time, knots, np.eye(knots.size)[k]) * inside
            columns += [signature[:, j] * hat for j in range(signature.shape[1])]
    out = np.column_stack(columns)
    return np.asarray(out[:, np.abs(out).max(axis=0) > 0.0])
