"""The log that stages work with: without what is unusable, and with accuracies as wide as what is suspect may mean."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from hfanalysis.health.coarse import as_said
from hfanalysis.products.health import HEALTHY, UNUSABLE, ChannelHealth, Finding, Health
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, Flag, TestLog
from hfanalysis.record.quiet import REFERENCES, FiringSpan, Trace, find_firing
from hfanalysis.record.schema import changed
from hfanalysis.record.zero import Zero, ambient_zero, tare
from hfanalysis.sentences import joined, text
from hfanalysis.units import Value

LEVEL = 95.0
"""Percentile of a channel's departure from its median at which a factor that is off counts as an offset. Source:
definition: about its plateau."""

FIRST_ZERO = "that of the log's first firing is used"
"""What is said where the rest before the firing taken gives no zero."""


def usable(log: TestLog, health: Health, definition: TestDefinition) -> TestLog:
    """The log [SI] without its unusable stretches; a channel that has no other samples is not in it."""
    found = marked(log, health, definition)
    kept = {name: channel for name, channel in found.channels.items() if not _gone(channel, log[name])}
    reasons = {name: why(_enough(unusable_findings(health.of(name)))) for name in log.channels if name not in kept}
    return replace(found, channels=kept, unusable=reasons)


def marked(log: TestLog, health: Health, definition: TestDefinition) -> TestLog:
    """The log [SI] with its unusable stretches flagged.

    Zero and tare that were taken with such a stretch are taken anew without it.
    """
    cut = {name: _cut(channel, health.of(name)) for name, channel in log.channels.items()}
    touched = {name for name, channel in cut.items() if channel is not log[name]}
    return replace(log, channels=_zeroed(cut, touched, definition)) if touched else log


def of_firing(log: TestLog, start: float | None, end: float | None, definition: TestDefinition) -> TestLog:
    """The part of a log in which the firing taken lies, from ``start`` up to ``end`` [s, log time]; None: all there is.

    Where the log has several, zero and tare [SI] are those of the rest before this one, as far as there is one.
    """
    part = log.between(start, end)
    if part is log:
        return log
    firing = _firing(part.channels, set(), definition)
    return replace(part, channels={name: _zero_of(c, firing, definition) for name, c in part.channels.items()})


def zeros_of_firing(log: TestLog, part: TestLog) -> tuple[str, ...]:
    """What there is to say of the zeros of a firing's ``part`` of a ``log``."""
    with_zero = [c for c in part.channels.values() if c.raw is not None]
    anew = [c.name for c in with_zero if (c.zero, c.drift) != (log[c.name].zero, log[c.name].drift)]
    kept = [f"{c.name}: {line}" for c in with_zero for line in c.history if line.endswith(FIRST_ZERO)]
    told = (
        [f"{', '.join(anew)}: zero from the rest before the firing taken, not before the log's first"] if anew else []
    )
    return (*told, *kept)


def _zero_of(channel: Channel, firing: FiringSpan | None, definition: TestDefinition) -> Channel:
    """The channel with its zero taken anew; as it was, and saying so, where the rest before the firing has none."""
    anew = _with_zero(channel, firing, definition)
    if channel.raw is None or anew.zero_std is not None:
        return anew
    return replace(channel, history=(*channel.history, f"{anew.history[-1]}: {FIRST_ZERO}"))


def unusable_findings(health: ChannelHealth) -> list[Finding]:
    """The findings for which a channel is not used, throughout or from when to when."""
    return [f for f in health.findings if f.verdict == UNUSABLE and not f.overruled]


def _enough(findings: list[Finding]) -> list[Finding]:
    """What says why nothing is left of a channel: what holds throughout, where something does."""
    return [finding for finding in findings if finding.whole] or findings


def why(findings: Iterable[Finding]) -> str:
    """Findings in a sentence: kind and evidence of each."""
    return joined("; ", [text("{kind}: {what}", kind=f.kind.replace("_", " "), what=f.evidence) for f in findings])


def _cut(channel: Channel, health: ChannelHealth) -> Channel:
    """A channel whose unusable stretches are flagged; the same where it has none."""
    lost = np.zeros(len(channel.time), dtype=bool)
    for finding in unusable_findings(health):
        start, end = finding.span
        lost |= (channel.time >= start) & (channel.time <= end)
    if not lost.any():
        return channel
    flags = channel.flags.copy()
    flags[lost] |= np.uint8(Flag.UNUSABLE)
    return replace(channel, flags=flags)


def _gone(now: Channel, before: Channel) -> bool:
    """Whether nothing is left of what there was."""
    return bool(before.good.any()) and not bool(now.good.any())


def _zeroed(channels: Mapping[str, Channel], touched: set[str], definition: TestDefinition) -> dict[str, Channel]:
    """The channels with their zeros taken anew where a sample that they rested on, or told the firing by, is gone."""
    every = next((name for name in REFERENCES if name in channels), None) in touched
    firing = _firing(channels, touched, definition)
    return {
        name: _with_zero(channel, firing, definition) if every or name in touched else channel
        for name, channel in channels.items()
    }


def _firing(channels: Mapping[str, Channel], touched: set[str], definition: TestDefinition) -> FiringSpan | None:
    """When the log departs from rest by the first channel of which nothing was taken out; else by any."""
    stated = definition.segments.get("t_open")
    there = [name for name in REFERENCES if name in channels]
    for name in [*(n for n in there if n not in touched), *(n for n in there if n in touched)]:
        found = find_firing(name, _trace(channels[name]))
        if found:
            return found if stated is None else replace(found, start=stated.value)
    return None if stated is None else FiringSpan(stated.value, np.inf, "test.toml")


def _trace(channel: Channel) -> Trace:
    good = channel.good
    return Trace(channel.time[good], as_said(channel)[good])


def _with_zero(channel: Channel, firing: FiringSpan | None, definition: TestDefinition) -> Channel:
    """A channel whose zero or tare is taken anew from its good samples; the same where it has neither."""
    if channel.raw is None:
        return channel
    zero = _zero(channel, firing, definition)
    history = tuple(line for line in channel.history if not line.startswith(("zero:", "tare:")))
    return replace(
        channel, values=channel.raw - zero.at(channel.time), zero=zero.value, zero_std=zero.std, drift=zero.drift,
        history=(*history, *zero.history),
    )  # fmt: skip


def _zero(channel: Channel, firing: FiringSpan | None, definition: TestDefinition) -> Zero:
    spec = definition.channels[channel.name]
    if spec.zero == "ambient":
        return ambient_zero(spec, _trace(channel), firing, definition.ambient_pressure, channel.accuracy)
    return tare(spec, _trace(channel), firing)


def widened(log: TestLog, health: Health) -> TestLog:
    """The log with the accuracy of every suspect channel as wide as its findings may mean [SI].

    A factor that is off counts as an offset at the channel's plateau: that is what a mean over the firing sees of it.
    """
    channels = {name: _wider(channel, health.of(name)) for name, channel in log.channels.items()}
    return replace(log, channels=channels)


def _wider(channel: Channel, health: ChannelHealth) -> Channel:
    found = [f for f in health.findings if f.verdict != HEALTHY and not f.overruled and (f.bias or f.gain)]
    if not found or not channel.good.any():
        return channel
    values = channel.values[channel.good]
    level = float(np.percentile(np.abs(values - np.median(values)), LEVEL))
    offset = float(np.linalg.norm([[f.bias or 0.0, (f.gain or 0.0) * level] for f in found]))
    zero = None if channel.zero_std is None else float(np.hypot(channel.zero_std, offset))
    note = f"accuracy: widened by {offset:.4g} for what its findings may mean"
    wide = float(np.hypot(channel.accuracy, offset))
    return replace(channel, accuracy=wide, zero_std=zero, history=(*channel.history, note), doubt=offset)


def as_accurate(definition: TestDefinition, log: TestLog) -> TestDefinition:
    """test.toml with the accuracies [SI] that a widened log has, where it states one."""
    specs = {
        name: changed(spec, accuracy=Value(log[name].accuracy))
        if name in log and spec.accuracy is not None and spec.accuracy.value != log[name].accuracy
        else spec
        for name, spec in definition.channels.items()
    }
    return changed(definition, channels=specs)
