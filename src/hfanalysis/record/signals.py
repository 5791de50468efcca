"""What the searches for events look at: the good samples of a channel, and a few robust summaries of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.holes import holes
from hfanalysis.record.log import Channel, TestLog

LINE_FIT_TIME = 0.2
"""Seconds through which a straight line gives the pressure at the full line. Evidence: the mean over the next 50 ms of
a falling pressure put it 0.1 bar low."""
MAD_TO_STD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation. Source: 1 / 0.6745."""
ON_EDGE = 1e-3
"""Of the time between samples, within which one counts as on the edge of a stretch. Evidence: times counted from
another origin are rounded anew, and means changed with the last digits of a log."""

MOST_COUNTS = 20.0
"""Usual change of reading, in the least one, up to which that is a converter's step. Assumed: a finer one makes no
noise to speak of."""

BRIDGE = 0.1
"""[s] on either side of a hole over which a signal's mean is taken. Evidence: an impulse across a hole hung on two
single samples (test_performance.py)."""


@dataclass(frozen=True)
class Signal:
    """Good samples of one channel in order of time.

    ``time`` [s, log time], strictly increasing; ``value`` in the channel's SI unit; ``noise`` the standard deviation of
    a single sample about a smooth curve; ``step`` the typical time between samples [s].
    """

    name: str
    time: Array
    value: Array
    noise: float
    step: float

    @classmethod
    def of(cls, channel: Channel) -> Signal:
        """The good samples of a channel; later samples of a repeated time stamp are left out."""
        good = channel.good
        time, value = channel.time[good], channel.values[good]
        keep = np.r_[True, np.diff(np.maximum.accumulate(time)) > 0.0] if time.size else np.zeros(0, dtype=bool)
        time, value = time[keep], value[keep]
        step = float(np.median(np.diff(time))) if time.size > 1 else np.nan
        return cls(channel.name, time, value, sample_noise(value), step)

    @property
    def dead(self) -> bool:
        """Whether the channel holds too few samples to say anything, or never changes at all."""
        return self.time.size < 8 or float(np.ptp(self.value)) == 0.0

    @property
    def resolution(self) -> float:
        """The least change of reading [SI] where most of them are whole multiples of it, a converter's step; else 0.

        >>> Signal("p", np.arange(4.0), np.array([1.0, 1.5, 1.5, 3.0]), 0.0, 1.0).resolution
        0.5
        """
        steps = np.abs(np.diff(self.value))
        steps = steps[steps > 0.0]
        if steps.size == 0:
            return 0.0
        least = float(steps.min())
        return least if float(np.median(steps)) < MOST_COUNTS * least else 0.0

    def between(self, start: float, end: float) -> Signal:
        """The samples with start <= time < end [s], whatever the time of one on an edge was rounded to."""
        a, b = np.searchsorted(self.time, np.array([start, end]) - self._edge)
        return replace(self, time=self.time[a:b], value=self.value[a:b])

    def holes(self, start: float = -np.inf, end: float = np.inf) -> Array:
        """From when to when [s] (holes, 2) it has no samples, of holes that reach into a stretch from ``start`` to
        ``end`` [s].
        """
        found = holes(self.time)
        return found[(found[:, 1] > start) & (found[:, 0] < end)]

    def bridged(self) -> Signal:
        """The same, with the means on either side of every hole as its values at the hole's edges.

        An interpolation across a hole then does not hang on two single samples.
        """
        found = holes(self.time)
        if not found.size:
            return self
        before = [self.mean(a - BRIDGE, a + 2.0 * self._edge) for a in found[:, 0]]
        after = [self.mean(b, b + BRIDGE) for b in found[:, 1]]
        inside = np.column_stack([np.nextafter(found[:, 0], np.inf), np.nextafter(found[:, 1], -np.inf)])
        places = np.repeat(np.searchsorted(self.time, found[:, 1]), 2)
        time = np.insert(self.time, places, inside.ravel())
        return replace(self, time=time, value=np.insert(self.value, places, np.column_stack([before, after]).ravel()))

    def shifted(self, origin: float) -> Signal:
        """The same samples with times [s] counted from ``origin`` [s]."""
        return replace(self, time=self.time - origin)

    def smooth(self, width: float) -> Array:
        """Running mean (n,) in the channel's unit over ``width`` [s], centered on each sample and with those on its
        edges; narrower at the ends.
        """
        total = np.concatenate(([0.0], np.cumsum(self.value - self._level)))
        half = 0.5 * width + self._edge
        a = np.searchsorted(self.time, self.time - half, side="left")
        b = np.searchsorted(self.time, self.time + half, side="right")
        return np.asarray((total[b] - total[a]) / (b - a) + self._level)

    def at(self, times: Array) -> Array:
        """Values (k,), in the channel's unit, at given times (k,) [s] by linear interpolation between good samples."""
        return np.interp(times, self.time, self.value)

    def mean(self, start: float, end: float) -> float:
        """Mean over [start, end) [s], in the channel's unit; NaN where there is no sample."""
        part = self.between(start, end).value
        return float(part.mean()) if part.size else float("nan")

    def around(self, time: float, half: float) -> float:
        """Mean within ``half`` [s] of a ``time`` [s]; between the neighbors where there is no sample so near."""
        near = self.mean(time - half, time + half)
        return near if np.isfinite(near) else float(self.at(np.array([time]))[0])

    def reduced(self, width: float) -> Signal:
        """Block means over ``width`` [s] (the signal itself where its samples are no closer than that)."""
        if self.time.size < 2 or self.step >= width:
            return self
        block = np.floor((self.time - self.time[0] + self._edge) / width).astype(np.int64)
        start = np.flatnonzero(np.r_[True, np.diff(block) > 0])
        count = np.diff(np.r_[start, self.time.size])
        value = np.add.reduceat(self.value, start) / count
        time = np.add.reduceat(self.time, start) / count
        return Signal(self.name, time, value, sample_noise(value), width)

    @property
    def _edge(self) -> float:
        """How near to an edge a sample counts as on it [s]: a time counted from another origin is rounded anew."""
        return ON_EDGE * self.step if self.step > 0.0 else 0.0

    @property
    def _level(self) -> float:
        return float(self.value[0]) if self.value.size else 0.0


def live_signals(log: TestLog) -> dict[str, Signal]:
    """The channels of a log that say something; dead ones are left out."""
    signals = {name: Signal.of(channel) for name, channel in log.channels.items()}
    return {name: signal for name, signal in signals.items() if not signal.dead}


def sample_noise(value: Array) -> float:
    """Standard deviation of a sample about a locally straight line, from second differences by their median.

    In the unit of ``value`` (n,); a second difference of white noise has six times its variance, hence sqrt(6).
    """
    if value.size < 3:
        return 0.0
    return float(second_to_std(np.median(np.abs(np.diff(value, 2)))))


def second_to_std(median: Array) -> Array:
    """Standard deviation of samples from the ``median`` of the sizes of their second differences, both (n,) or one."""
    return np.asarray(MAD_TO_STD * median / np.sqrt(6.0))


def line_at(signal: Signal, instant: float) -> float:
    """Value of a signal, in its unit, at an ``instant`` [s], from a straight line through what follows."""
    head = signal.between(instant, instant + LINE_FIT_TIME + 8.0 * signal.step)
    if head.time.size > 3:
        return float(np.polyfit(head.time - instant, head.value, 1)[1])
    return signal.mean(instant, np.inf)
