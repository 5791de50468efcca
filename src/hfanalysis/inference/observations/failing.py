"""Does the flow fail before the liquid is gone? Chamber pressure and thrust at the end of the liquid tell.

A vortex, or a bulk that sloshes off the outlet, brings gas into the feed while there is liquid left: chamber pressure
and thrust fall some hundredths of a second before the tank's pressure shows the end of the liquid. While they do, no
blocks are compared: no name could be judged by them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.inference.observations.recorded import TOGETHER
from hfanalysis.products.segments import Segments
from hfanalysis.record.signals import Signal

Array = NDArray[np.float64]

COURSE, LOOKED_AT = 1.5, 0.3
"""Seconds before the end of the liquid over which the course is a straight line, up to where it may begin to fail."""

BIN, CLEAR = 0.01, 0.004
"""Seconds that are averaged, and kept clear of the end of the liquid, beside its own deviation."""

DATED = 2e-3
"""Standard deviation [s] of the end of the liquid up to which something can be said to come before it."""

DURATIONS = np.geomspace(0.02, 0.25, 12)
"""Seconds before the end of the liquid at which the flow may begin to fail."""

LEAST_FALL = 0.04
"""Part of pressure and thrust that is lost at least: a line misses a curved course by less."""

UNEVEN = 0.02
"""Part of itself by which a channel departs from a straight course and a straight fall at any instant."""

LEAST_GAIN = 8.0
"""Log evidence from which on a fall is plain."""

HIDDEN = 0.05
"""Seconds before the end of the liquid in which every sample has to be good."""


@dataclass(frozen=True)
class FailingFlow:
    """The flow begins to fail ``seconds`` before the end of the liquid at ``t_v`` [s], when chamber pressure and thrust
    have lost a ``share`` of themselves; the log evidence of that."""

    t_v: float
    seconds: float
    share: float
    log_evidence: float


def failing_flow(signals: Mapping[str, Signal], segments: Segments) -> FailingFlow | None:
    """How long before the end of the liquid chamber pressure and thrust fall; None where they do not, or that does not
    show.

    ``signals``: by channel, their times [s] after the opening; ``segments`` date the end of the liquid by the tank.
    """
    t_v, gone = segments.time("t_v"), segments.time("t_fuel_out")
    if t_v is None or segments.std("t_v") > DATED or "p_tank" not in signals or not set(TOGETHER) <= set(signals):
        return None
    if t_v < COURSE + LOOKED_AT or (gone is not None and gone < t_v + LOOKED_AT):
        return None
    time = np.arange(-COURSE, -CLEAR - segments.std("t_v") - BIN, BIN) + 0.5 * BIN
    time -= time[-1] + 0.5 * BIN + CLEAR + segments.std("t_v")
    lost = [_lost(signals[name], t_v, time) for name in TOGETHER]
    if any(part is None for part in lost):
        return None
    together = np.mean([part for part in lost if part is not None], axis=0)
    steady = time < -LOOKED_AT
    noise = float(np.hypot(np.std(together[steady]), UNEVEN))
    gains, shares = np.array([_gain(together, time, seconds, noise) for seconds in DURATIONS]).T
    best = int(np.argmax(gains))
    if gains[best] < LEAST_GAIN or shares[best] < LEAST_FALL or best == DURATIONS.size - 1:
        return None  # a fall that takes longer than all that are tried is a course that blocks show
    return FailingFlow(t_v, float(DURATIONS[best]), float(shares[best]), float(gains[best]))


def _lost(signal: Signal, t_v: float, time: Array) -> Array | None:
    """Part of itself that a channel has lost at ``time`` (n,) [s after the end of the liquid], by a straight course."""
    still = signal.between(-np.inf, -0.1).value
    if not signal.step < 0.6 * BIN or still.size < 2:
        return None
    read = np.array([signal.mean(t_v + t - 0.5 * BIN, t_v + t + 0.5 * BIN) for t in time])
    good = np.isfinite(read)
    steady = good & (time < -LOOKED_AT)
    if steady.sum() < 0.5 * time.size or not good[time > -HIDDEN].all():
        return None
    course = np.polyval(np.polyfit(time[steady], read[steady], 1), time)
    level = course - float(np.median(still))
    if not level.min() > 0.1 * level.max() > 0.0:
        return None
    return np.where(good, (course - read) / level, 0.0)


def _ramp(time: Array, seconds: float) -> Array:
    return np.asarray(np.clip(1.0 + time / seconds, 0.0, 1.0))


def _gain(lost: Array, time: Array, seconds: float, noise: float) -> tuple[float, float]:
    """Log evidence of a fall within so many seconds before the end, one among all that are tried; and its size."""
    ramp = _ramp(time, seconds)
    share = max(float(ramp @ lost / (ramp @ ramp)), 0.0)
    return 0.5 * share**2 * float(ramp @ ramp) / noise**2 - float(np.log(DURATIONS.size)), share
