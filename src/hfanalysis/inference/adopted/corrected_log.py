"""A log with what adopted sensor effects did to its readings taken off again.

A distortion says what a sensor reads of the truth. What it changes is taken off the reading: exactly for what adds to a
reading (an offset, a drift), to second order for a lag: its change is first that of the reading (tau dp/dt of it), then
that of the truth found with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import CHANNELS, distorted
from hfanalysis.record.log import Channel, TestLog

TURNS = 2
"""Times that what a distortion changes is taken at the truth as far as it is known: the second takes a lag off to
second order."""


def corrected(log: TestLog, origin: float, effects: Sequence[Active]) -> TestLog:
    """The log without the distortions among ``effects``, in the units that it has; ``origin``: log time of the opening
    [s].

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
    true = dict(read)
    for _ in range(TURNS):
        true[name] = true[name] + read[name] - distorted(true, time - origin, effects)[name]
    change = read[name] - true[name]
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
