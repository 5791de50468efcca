"""What an ingested log holds, channel by channel, in a few numbers each."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.record.log import Channel, Flag, Floats, TestLog


def summary(log: TestLog) -> dict[str, Any]:
    """The content of ``ingest.json``: ``channels`` by name, and the warnings of the ingest."""
    return {
        "channels": {name: channel_summary(channel) for name, channel in log.channels.items()},
        "warnings": list(log.warnings),
    }


def channel_summary(channel: Channel) -> dict[str, Any]:
    """One channel: label, unit, samples, rate [Hz], range of the good samples [SI], flags, accuracy, zero, drift."""
    good = channel.values[channel.good]
    return {
        "label": channel.label,
        "unit": channel.unit,
        "samples": int(channel.values.size),
        "good": int(good.size),
        "rate": rate(channel.time),
        "start": _number(channel.time, np.nanmin),
        "end": _number(channel.time, np.nanmax),
        "least": _number(good, np.min),
        "largest": _number(good, np.max),
        "flags": flag_counts(channel),
        "accuracy": channel.accuracy,
        "accuracy_stated": channel.accuracy_stated,
        "zero": channel.zero,
        "zero_std": channel.zero_std,
        "drift": channel.drift,
        "history": list(channel.history),
    }


def rate(time: Floats) -> float | None:
    """Samples per second: the inverse of the median step between increasing stamps; None where there is none."""
    steps = np.diff(time)
    steps = steps[steps > 0.0]
    return float(f"{1.0 / np.median(steps):.4g}") if steps.size else None


def flag_counts(channel: Channel) -> dict[str, int]:
    """How many samples carry each flag; flags that no sample carries are left out."""
    counts = {(flag.name or "").lower(): int(np.count_nonzero(channel.flags & flag)) for flag in Flag}
    return {name: count for name, count in counts.items() if count}


def _number(values: Floats, of: Any) -> float | None:
    found = float(of(values)) if values.size else np.nan
    return found if np.isfinite(found) else None
