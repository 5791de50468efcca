"""Coarse estimates of a channel: its rest, its plateau, its peak, as the sensor says them.

They rest on nothing but the channel's own samples, so that no finding can hang on a later stage's answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.log import Channel
from hfanalysis.record.quiet import MARGIN, Trace, find_firing, spread

FEW = 8
"""Good samples below which a channel says nothing coarse either."""
MIDDLE = (0.25, 0.75)
"""Part of the firing whose mean is the plateau: neither ignition nor the fall is in it. Source: definition."""
BEFORE = 5.0
"""[s] before the firing that are its rest: filling the tank is over by then. Source: definition."""
TAIL = 1.0
"""[s] at the log's end whose mean is the last level. Source: definition."""
HIGH, LOW = 99.5, 0.5
"""Percentiles that count as peak and trough, so that single wild samples do not. Source: definition."""
STEPS = 20_000
"""Differences between neighbors that are looked at for the least one."""

Span = tuple[float, float]
"""From when to when [s, log time]."""


@dataclass(frozen=True)
class Level:
    """A level that is held: mean [SI], the deviation of a single sample about it [SI], and from when to when [s]."""

    value: float
    noise: float
    span: Span


@dataclass(frozen=True)
class Coarse:
    """One channel in a few numbers [SI, before zero and tare], from its good samples.

    Attributes:
        samples, good: how many there are, and how many carry no flag.
        rate: samples per second [1/s]: the inverse of the median step; 0 where there are no two.
        start, end: of the log on the channel's clock [s].
        live: from when to when it is away from its rest [s], by itself; None where it never leaves it.
        rest: in the last seconds before the firing (of a log without one: throughout); None where the log begins later.
        plateau: mean over the middle half of the firing; None where there is none.
        peak, trough: the highest and lowest level in all.
        last: the level at the end of the log.
        quantum: the least change of reading, its resolution.
        repetition: share of samples that equal the one before [-].
    """

    samples: int
    good: int
    rate: float
    start: float
    end: float
    live: Span | None
    rest: Level | None
    plateau: float | None
    peak: float
    trough: float
    last: Level | None
    quantum: float
    repetition: float

    @property
    def rise(self) -> float | None:
        """From rest to plateau [SI]; None where either is unknown. A zero that is off is not in it."""
        if self.rest is None or self.plateau is None:
            return None
        return self.plateau - self.rest.value


def coarse(channel: Channel, live: Span | None, fire: Span | None) -> Coarse:
    """The estimates of one channel; it is ``live`` [s] by itself, and the firing lasts ``fire`` [s] by all channels."""
    said = as_said(channel)
    good = channel.good
    trace = Trace(channel.time[good], said[good])
    rate, start, end = _clock(channel.time)
    quantum, repetition = _steps(said[np.isfinite(said)])
    clock = (len(said), len(trace.time), rate, start, end)
    if len(trace.time) < FEW:
        return Coarse(*clock, None, None, None, 0.0, 0.0, None, quantum, repetition)
    rest = level(trace, max(start, fire[0] - BEFORE), fire[0] - MARGIN) if fire else level(trace, start, end)
    trough, peak = (float(x) for x in np.percentile(trace.values, (LOW, HIGH)))
    middle = plateau(trace, fire) if fire else None
    return Coarse(*clock, live, rest, middle, peak, trough, level(trace, end - TAIL, end), quantum, repetition)


def as_said(channel: Channel) -> Array:
    """What the sensor said (n,) [SI], before zero and tare."""
    return channel.values if channel.raw is None else channel.raw


def live_span(channel: Channel) -> Span | None:
    """From when to when [s] a channel is away from its rest, by itself and its good samples."""
    good = channel.good
    found = find_firing(channel.name, Trace(channel.time[good], as_said(channel)[good]))
    return None if found is None else (found.start, found.end)


def plateau(trace: Trace, fire: Span) -> float | None:
    """Mean [SI] over the middle half of a span [s]; None where it has no sample."""
    a, b = (fire[0] + share * (fire[1] - fire[0]) for share in MIDDLE)
    values = trace.between(a, b).values
    return float(values.mean()) if len(values) else None


def level(trace: Trace, start: float, end: float) -> Level | None:
    """The median and the noise over a span [s]; None where it has too few samples."""
    part = trace.between(start, end)
    if len(part.time) < FEW:
        return None
    return Level(float(np.median(part.values)), spread(part.values), (float(part.time[0]), float(part.time[-1])))


def _clock(time: Array) -> tuple[float, float, float]:
    if len(time) < 2:
        return 0.0, float(time[0]) if len(time) else 0.0, float(time[0]) if len(time) else 0.0
    steps = np.diff(time)
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    return (1.0 / step if step else 0.0), float(time.min()), float(time.max())


def _steps(values: Array) -> tuple[float, float]:
    """The least change between neighbors, and the share of neighbors that are equal."""
    if len(values) < 2:
        return 0.0, 0.0
    steps = np.abs(np.diff(values))
    moved = steps[steps > 0.0]
    return (float(moved[:STEPS].min()) if len(moved) else 0.0), float(1.0 - len(moved) / len(steps))
