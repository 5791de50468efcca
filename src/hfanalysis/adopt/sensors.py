"""A log with what adopted sensor effects did to its readings taken off again.

A distortion says what a sensor reads of the truth. Its change to what was read is taken off: exactly for what adds to a
reading (an offset, a drift), to first order for a lag (p + tau dp/dt of the reading).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import CHANNELS, Array, distorted
from hfanalysis.testdata.log import Channel, TestLog


def corrected(log: TestLog, origin: float, effects: Sequence[Active]) -> TestLog:
    """The log without the distortions among ``effects``; ``origin``: log time of the opening [s].

    The same log where none distorts a channel that it has.
    """
    acting = [active for active in effects if active.effect.of_sensor and not active.idle]
    names = {name for active in acting for name in active.effect.sites if name in log}
    if not names:
        return log
    channels = {name: _corrected(log, name, origin, acting) for name in names}
    return replace(log, channels={**log.channels, **channels})


def _corrected(log: TestLog, name: str, origin: float, effects: Sequence[Active]) -> Channel:
    channel = log[name]
    good = channel.good
    if good.sum() < 2:
        return channel
    time = channel.time[good]
    read = {other: _on(log, other, time) for other in CHANNELS}
    change = distorted(read, time - origin, effects)[name] - read[name]
    change = np.interp(channel.time, time, change)
    raw = None if channel.raw is None else channel.raw - change
    said = f"corrected for {', '.join(sorted(a.effect.name for a in effects if name in a.effect.sites))}"
    return replace(channel, values=channel.values - change, raw=raw, history=(*channel.history, said))


def _on(log: TestLog, name: str, time: Array) -> Array:
    """Another channel's good samples on this clock; 0 where the log does not have it."""
    channel = log.get(name)
    if channel is None or not channel.good.any():
        return np.zeros(time.size)
    return np.asarray(np.interp(time, channel.time[channel.good], channel.values[channel.good]))
