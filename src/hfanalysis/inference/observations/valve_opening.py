"""Does the valve open at once? The run line's pressure at the start tells, without a model.

Behind a valve that opens at once it leaps to what the flow leaves of the tank's, or nearly so, and creeps up with the
chamber's pressure, or as the line fills. Behind one that takes its time it comes up gradually from the beginning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.record.signals import Signal

Array = NDArray[np.float64]

BEFORE, AFTER = 0.15, 0.6
"""Seconds before and after the opening between which the run line's pressure is looked at."""

FINEST = 1e-3
"""Seconds between samples that are looked at."""

GRADUAL = 3
"""Samples that the first part of the rise (EARLY) takes at least where it is gradual: a leap takes one or two."""

EARLY = 0.05, 0.2
"""Parts of the rise between which it tells a gradual opening: a line that fills begins with its steepest rise."""

NEARLY = 0.95
"""Part of the rise at which the valve counts as open."""

NOISE = 0.01
"""Of the rise: noise of a sample above which nothing can be told."""

SLOW_LOG = 5e-3
"""Seconds between samples above which nothing can be told."""

AROUND = 0.02
"""Seconds before and after the rise that are compared with a leap and with a gradual one."""

BLOCK = 2e-3
"""Seconds of samples that count as one observation."""


@dataclass(frozen=True)
class SlowOpening:
    """``seconds`` from the first rise of the run line's pressure until the valve is open, and the log evidence that it
    does not open at once, without any model."""

    seconds: float
    log_evidence: float


def slow_opening(signals: Mapping[str, Signal]) -> SlowOpening | None:
    """How long the valve takes; None where it opens at once, or where that does not show.

    ``signals``: by channel, their times [s] after the opening.
    """
    if "p_run" not in signals or not signals["p_run"].step <= SLOW_LOG:
        return None
    line = signals["p_run"]
    step = max(line.step, FINEST)
    time = np.arange(-BEFORE, AFTER, step)
    still, open_ = line.between(-5.0 * BEFORE, -BEFORE).value, line.between(0.7 * AFTER, AFTER).value
    if min(still.size, open_.size) < GRADUAL:
        return None
    closed, level = float(np.median(still)), float(np.median(open_))
    if not line.noise < NOISE * (level - closed):
        return None
    risen = np.maximum.accumulate(_median_of_three((line.at(time) - closed) / (level - closed)))
    first, second, last = (float(time[int(np.argmax(risen >= part))]) for part in (*EARLY, NEARLY))
    if second - first < (GRADUAL - 0.5) * step or line.between(first, second).time.size < GRADUAL - 1:
        return None  # a leap, or one in a hole of the log
    begins = first - EARLY[0] / (EARLY[1] - EARLY[0]) * (second - first)
    near = (time > begins - AROUND) & (time < last + AROUND)
    at_once = min(_misfit(risen[near], time[near] >= instant) for instant in time[near])
    gradually = _misfit(risen[near], np.clip((time[near] - begins) / max(last - begins, step), 0.0, 1.0))
    closer = np.log(at_once / max(gradually, 1e-12 * at_once))
    return SlowOpening(last - begins, 0.5 * float(closer) * (last - begins + 2.0 * AROUND) / BLOCK)


def _misfit(one: Array, other: Array) -> float:
    return float(np.sum((one - other) ** 2))


def _median_of_three(values: Array) -> Array:
    """Single wild samples are left out."""
    neighbours = np.stack([np.r_[values[:1], values[:-1]], values, np.r_[values[1:], values[-1:]]])
    return np.asarray(np.median(neighbours, axis=0))
