"""t_feed: the feed line is full, when the smoothed run-line pressure first reaches 98 % of its maximum before t_v."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.crossing import NODES

FULL = 0.98
"""Part of the run line's largest smoothed pressure [-] at which the line counts as full (docs/phases.md)."""
RUN_SMOOTHING = 0.06
"""Running mean [s] that takes the sensor noise out of the maximum."""
BY_WIDTH = 0.25
"""Part of what a slow log has to smooth more than that, by which its crossing may come late: a line that fills nears
its maximum ever more slowly."""


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
    if top - base < 5.0 * run.noise:
        return "p_run does not rise"
    noise = Noise.of(run, run.between(-3.0, -0.05))
    single = float(np.sqrt(max(noise.white, run.noise) ** 2 * run.step / width + noise.flicker))
    near = np.count_nonzero(smooth > top - 3.0 * single) * run.step / width
    target = FULL * (top - single * _largest_of(near))
    first = float(part.time[int(np.argmax(smooth >= target))])
    if first <= max(width, 2.0 * run.step):
        return (
            f"p_run is at its full value within {1e3 * max(first, run.step):.0f} ms of the opening: no filling to see"
        )
    apart = max(float(part.time[int(np.argmax(smooth))]) - first, width)
    error = float(np.sqrt((1.0 + FULL**2) * single**2 + noise.flicker * np.log(apart / width)))
    times = np.array([part.time[int(np.argmax(smooth >= min(one, top)))] for one in target + error * NODES])
    wider = BY_WIDTH * (width - RUN_SMOOTHING)
    half = 0.5 * run.step  # the first sample above is as much late in the mean
    return float(times.mean()) - half, float(np.linalg.norm([times.std(), wider, run.step / np.sqrt(12.0)]))


def _largest_of(number: float) -> float:
    """By how many standard deviations the largest of so many normal errors is too high (Blom's approximation)."""
    return NormalDist().inv_cdf((number - 0.375) / (number + 0.25)) if number > 1.0 else 0.0


def _ambient(run: Signal) -> float:
    before = run.between(-1.0, -0.02).value
    return float(np.median(before)) if before.size else 0.0
