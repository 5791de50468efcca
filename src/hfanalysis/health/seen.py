"""What a detector sees: one channel, one test, the other tests of its stand. And the forms a detector has.

A detector is a module with ``find``; its name is that of the kind or the tie, and its first line says what it looks
for::

    # kinds/dead.py                                   # ties/chamber_and_thrust.py, stand/scale.py
    def find(seen: Seen) -> Iterable[Finding]: ...    def find(test: SeenTest) -> Iterable[Finding]: ...

Findings of a channel may leave ``channels`` to :meth:`Seen.finding`, which fills it in; those of ties and of the stand
name the channels that they point to: each of these gets the finding among its own. What the stand says only ever makes
suspect.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.coarse import Coarse, Span, as_said, coarse, live_span
from hfanalysis.products.health import Finding
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, Flag, TestLog
from hfanalysis.record.logspec import ChannelSpec
from hfanalysis.record.quiet import Trace
from hfanalysis.record.signals import Signal
from hfanalysis.segment.firings import LEADS, find_flows, largest
from hfanalysis.sentences import Text, said
from hfanalysis.wording.numbers import people_unit

FIRING = ("p_chamber", "thrust", "p_run", "p_tank")
"""Channels that say when the firing is, the most telling first."""
TOGETHER = 1.5
"""[s] within which channels agree on the beginning of the firing: ignition may be late by a second. Evidence:
test_seen.py: a chamber gauge that is dead until seconds into the burn is outvoted."""


@dataclass(frozen=True)
class Seen:
    """One channel: its samples, what test.toml says of it, coarse estimates, and the firing's span by all channels."""

    channel: Channel
    spec: ChannelSpec
    coarse: Coarse
    definition: TestDefinition
    fire: Span | None

    @property
    def name(self) -> str:
        """Its canonical name."""
        return self.channel.name

    @property
    def dimension(self) -> str:
        """pressure, force, mass, temperature …"""
        return self.spec.dimension

    @property
    def ambient(self) -> float:
        """Ambient pressure [Pa]."""
        return self.definition.ambient_pressure.value

    @cached_property
    def said(self) -> Array:
        """What the sensor said (n,) [SI], before zero and tare, every sample in the log's order; NaN: no reading."""
        none = (self.channel.flags & np.uint8(Flag.DROPOUT)) != 0
        return np.where(none, np.nan, as_said(self.channel)) if none.any() else as_said(self.channel)

    @cached_property
    def heard(self) -> Trace:
        """All its numbers [SI], those too that no sensor can read: of a reversed or dying one they are the signal."""
        values = as_said(self.channel)
        kept = np.isfinite(values) & ((self.channel.flags & np.uint8(Flag.TIME | Flag.EXCLUDED)) == 0)
        return Trace(self.channel.time[kept], values[kept])

    @cached_property
    def trace(self) -> Trace:
        """The same for the good samples only."""
        good = self.channel.good
        return Trace(self.channel.time[good], self.said[good])

    @cached_property
    def logged(self) -> Array:
        """The readings (n,) as the logger wrote them, in the log's unit (to name a code such as 999)."""
        scale, offset = self.spec.factor
        ambient = self.ambient if self.spec.gauge else 0.0
        return (self.said - ambient - offset) / scale * self.spec.scale + self.spec.offset

    def amount(self, value: float, form: str = ".4g") -> Text:
        """A value or a difference [SI] in the unit of people at a stand, as findings say it."""
        factor, unit = people_unit(self.channel.unit)
        return said(value, unit, form, size=1.0 / factor) if unit else Text(f"{value:{form}}")

    def finding(self, kind: str, verdict: Any, **about: Any) -> Finding:
        """A finding of this channel alone."""
        return Finding(kind=kind, verdict=verdict, channels=(self.name,), **about)


@dataclass(frozen=True)
class Sister:
    """Another test of the stand: what its test.toml says, and its channels' coarse estimates."""

    definition: TestDefinition
    channels: Mapping[str, Coarse]

    @property
    def name(self) -> str:
        """Of the test."""
        return self.definition.test.id


@dataclass(frozen=True)
class SeenTest:
    """All channels of a test, when the firing is by most of them, and the other tests of the stand."""

    channels: Mapping[str, Seen]
    definition: TestDefinition
    fire: Span | None
    sisters: tuple[Sister, ...] = ()
    found: tuple[Finding, ...] = field(default=())
    """What the channels showed by themselves (in ties), and what ties showed too (in the stand's comparison)."""

    def get(self, name: str) -> Seen | None:
        """A channel that can be compared: None where the log has none of that name, or it is unusable throughout."""
        lost = any(f.verdict == "unusable" and f.whole and name in f.channels for f in self.found)
        return None if lost else self.channels.get(name)

    @property
    def ambient(self) -> float:
        """Ambient pressure [Pa]."""
        return self.definition.ambient_pressure.value


def look(log: TestLog, definition: TestDefinition) -> SeenTest:
    """All channels of a log with their coarse estimates, each computed once."""
    live = {name: live_span(channel) for name, channel in log.channels.items()}
    fire = _taken(log, definition, firing_of(live))
    estimates = {name: coarse(channel, live[name], fire) for name, channel in log.channels.items()}
    seen = {
        name: Seen(channel, definition.channels[name], estimates[name], definition, fire)
        for name, channel in log.channels.items()
    }
    return SeenTest(seen, definition, fire)


def _taken(log: TestLog, definition: TestDefinition, whole: Span | None) -> Span | None:
    """From when to when [s, log time] the firing lasts that is taken of those in the ``whole``.

    By the rule by which the phases take theirs, with no product of theirs: a mean over two firings is one of neither.
    """
    signals = {name: Signal.of(log[name]) for name in LEADS if name in log}
    flows = find_flows({name: signal for name, signal in signals.items() if not signal.dead})
    if whole is None or len(flows) < 2:
        return whole
    place = definition.log.firing - 1 if definition.log.firing else largest(flows, signals, fire=True)
    if place >= len(flows):
        return whole
    start, end = max(flows[place].start, whole[0]), whole[1] if place == len(flows) - 1 else flows[place].end
    # what begins after all channels are at rest again is no firing that a plateau could be taken of
    return (start, end) if start < end else whole


def firing_of(live: Mapping[str, Span | None]) -> Span | None:
    """From when to when [s, log time] the firing lasts, by the channel that most others agree with on its beginning.

    A tank's pressure, which filling raises long before, is asked only where no other channel moves, or where as many
    are for one as for another.
    """
    there = [span for span in map(live.get, FIRING[:-1]) if span is not None]
    if not there:
        return live.get(FIRING[-1])
    tank = live.get(FIRING[-1])

    def votes(span: Span) -> tuple[int, bool]:
        agree = sum(abs(start - span[0]) <= TOGETHER for start, _ in there)
        return agree, tank is not None and abs(tank[0] - span[0]) <= TOGETHER

    return max(there, key=votes)
