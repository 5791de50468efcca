"""What an ingested log holds, channel by channel, in a few numbers each."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.products.ingest import ChannelSummary, Ingest
from hfanalysis.record.log import Channel, Flag, TestLog


def summary(log: TestLog) -> Ingest:
    """The content of ``ingest.json``: ``channels`` by name, and the warnings of the ingest."""
    channels = {name: channel_summary(channel) for name, channel in log.channels.items()}
    return Ingest(channels=channels, warnings=tuple(log.warnings))


def channel_summary(channel: Channel) -> ChannelSummary:
    """One channel in a few numbers [SI]."""
    good = channel.values[channel.good]
    return ChannelSummary(
        label=channel.label,
        unit=channel.unit,
        samples=int(channel.values.size),
        good=int(good.size),
        rate=rate(channel.time),
        start=_number(channel.time, np.nanmin),
        end=_number(channel.time, np.nanmax),
        least=_number(good, np.min),
        largest=_number(good, np.max),
        flags=flag_counts(channel),
        accuracy=channel.accuracy,
        accuracy_stated=channel.accuracy_stated,
        zero=channel.zero,
        zero_std=channel.zero_std,
        drift=channel.drift,
        history=tuple(channel.history),
    )


def rate(time: Array) -> float | None:
    """Samples per second [1/s]: the inverse of the median step between increasing stamps ``time`` (n,) [s]; None
    without any.

    >>> rate(np.array([0.0, 0.002, 0.004, 0.004, 0.006]))
    500.0
    """
    steps = np.diff(time)
    steps = steps[steps > 0.0]
    return float(f"{1.0 / np.median(steps):.4g}") if steps.size else None


def flag_counts(channel: Channel) -> dict[str, int]:
    """How many samples carry each flag; flags that no sample carries are left out."""
    counts = {(flag.name or "").lower(): int(np.count_nonzero(channel.flags & flag)) for flag in Flag}
    return {name: count for name, count in counts.items() if count}


def _number(values: Array, of: Any) -> float | None:
    found = float(of(values)) if values.size else np.nan
    return found if np.isfinite(found) else None
