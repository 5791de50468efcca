"""t_end: the chamber unchokes, and with that the burn as an engine is over."""

from __future__ import annotations

import numpy as np

from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text

CRITICAL_RATIO = 1.80
"""p_c / p_a [-] at which a nozzle unchokes: 1.77 to 1.83 for gamma of 1.2 to 1.3. Source: ((gamma + 1)/2)^(gamma/(gamma
- 1)), the isentropic flow of a convergent throat."""

RATIO_STD = 0.02
"""Standard deviation of that ratio [-]. Source: its range for gamma of 1.2 to 1.3, over sqrt(12)."""


def find_unchoking(chamber: Signal, ambient: float, t_feed: float, offset: float = 0.0) -> tuple[float, float] | str:
    """t_end [s] and its standard deviation [s] from the chamber pressure with time from the opening; else the reason.

    ``ambient`` [Pa] is the air's, ``t_feed`` [s] from when on it is looked for, ``offset`` [Pa] how far the open
    chamber read from ambient.
    """
    part = chamber.between(max(t_feed, 0.0), np.inf)
    if part.time.size < 8:
        return "the log ends before the chamber can unchoke"
    smooth = part.smooth(max(0.1, 4.0 * chamber.step))
    limit = CRITICAL_RATIO * ambient + offset
    if not (smooth > limit).any():
        return "the chamber pressure never chokes the nozzle"
    last = int(np.flatnonzero(smooth > limit)[-1])
    if last >= smooth.size - 2:
        left = said(float(smooth[-1]) - offset, "bar", ".1f")
        return text("the log ends with the nozzle still choked ({left} in the chamber)", left=left)
    time = float(part.time[last])
    nearby = np.abs(part.time - time) < max(0.3, 6.0 * chamber.step)
    slope = abs(float(np.polyfit(part.time[nearby] - time, smooth[nearby], 1)[0]))
    error = np.hypot(RATIO_STD * ambient, chamber.noise / np.sqrt(max(0.1 / chamber.step, 1.0)))
    return time, float(np.hypot(error / max(slope, 1.0), chamber.step))
