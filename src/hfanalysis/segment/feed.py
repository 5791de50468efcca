"""t_feed: the feed line is full, when the smoothed run-line pressure first reaches 98 % of its maximum before t_v."""

from __future__ import annotations

import numpy as np

from hfanalysis.record.signals import Signal

FULL = 0.98
"""Part of the run line's largest smoothed pressure [-] at which the line counts as full (docs/phases.md)."""
RUN_SMOOTHING = 0.06
"""Running mean [s] that takes the sensor noise out of the maximum."""


def find_line_full(run: Signal, t_v: float) -> tuple[float, float] | str:
    """t_feed [s] and its standard deviation [s], from the run-line pressure [Pa] with time counted from the opening.

    ``t_v`` [s]: until when it is looked for. Where the line is full at once (as fast as the smoothing can see) there is
    no filling, and the reason is returned.
    """
    part = run.between(0.0, t_v)
    if part.time.size < 8:
        return "too few good samples of p_run before the liquid is gone"
    width = max(RUN_SMOOTHING, 3.0 * run.step)
    smooth = part.smooth(width)
    base = _ambient(run)
    top = float(smooth.max())
    target = FULL * top
    first = int(np.argmax(smooth >= target))
    time = float(part.time[first])
    if time <= max(width, 2.0 * run.step):
        return f"p_run is at its full value within {1e3 * max(time, run.step):.0f} ms of the opening: no filling to see"
    slope = max(_slope_at(part.time, smooth, first), 1e-9)
    noise = run.noise / np.sqrt(max(width / run.step, 1.0))
    std = float(np.hypot(FULL * 2.0 * noise / slope, max(run.step, 0.25 * width)))
    if top - base < 5.0 * run.noise:
        return "p_run does not rise"
    return time, std


def _ambient(run: Signal) -> float:
    before = run.between(-1.0, -0.02).value
    return float(np.median(before)) if before.size else 0.0


def _slope_at(time: np.ndarray, value: np.ndarray, index: int) -> float:
    a, b = max(index - 5, 0), min(index + 6, time.size - 1)
    return float((value[b] - value[a]) / max(time[b] - time[a], 1e-9))
