"""Fewer points with nothing hidden: what a chart draws of a channel with a thousand samples per second."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array

BINS = 600
"""Across a chart: more would be finer than the screen. Evidence: test_envelope.py: three values each stay below two
thousand."""


@dataclass(frozen=True)
class Envelope:
    """Per bin of time: the mean and the extremes of the samples in it; NaN in bins that hold none, so lines break."""

    time: Array
    mean: Array
    low: Array
    high: Array

    @property
    def empty(self) -> bool:
        """Whether no bin holds a sample."""
        return not bool(np.isfinite(self.mean).any())


def envelope(time: Array, values: Array, start: float, end: float, bins: int = BINS) -> Envelope:
    """Reduce a channel to ``bins`` bins between ``start`` and ``end``; the envelope has the channel's unit.

    A log slower than the bins keeps its own points, and lines break only where samples are missing for longer than five
    of its usual steps.

    Args:
        time: [s], (n,), increasing.
        values: the good samples, (n,).
        start: [s] of the chart's left edge.
        end: [s] of its right edge.
        bins: how many.
    """
    inside = (time >= start) & (time <= end)
    time, values = time[inside], values[inside]
    if time.size <= bins:
        return _as_is(time, values)
    edges = np.linspace(start, end, bins + 1)
    first = np.searchsorted(time, edges[:-1])
    count = np.diff(np.append(first, time.size))
    held = count > 0
    starts = first[held]
    out = np.full((3, bins), np.nan)
    out[0, held] = np.add.reduceat(values, starts) / count[held]
    out[1, held] = np.minimum.reduceat(values, starts)
    out[2, held] = np.maximum.reduceat(values, starts)
    return Envelope(0.5 * (edges[1:] + edges[:-1]), out[0], out[1], out[2])


def _as_is(time: Array, values: Array) -> Envelope:
    if time.size > 2:
        steps = np.diff(time)
        gaps = np.flatnonzero(steps > 5.0 * np.median(steps)) + 1
        time = np.insert(time, gaps, 0.5 * (time[gaps] + time[gaps - 1]))
        values = np.insert(values, gaps, np.nan)
    return Envelope(time, values, values, values)
