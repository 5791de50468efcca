"""Do thrust and chamber pressure share a clock? A second logger, or a filter, makes one of them late.

While the engine starts, thrust rises with the chamber's pressure. No model is needed to see by how much later it does,
to a millisecond, and no effect on the engine makes it late. A chamber pressure that lags behind is something else: it
rises slower, not later, and an effect of the library.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.record.signals import Signal

Array = NDArray[np.float64]

BEFORE, AFTER = 0.05, 0.45
"""Seconds before and after the opening between which thrust is laid over the chamber's pressure."""

MOST, LEAST = 0.2, 5e-3
"""The largest delay that is looked for, and the least that is one [s]."""

FINEST = 1e-3
"""Seconds between delays that are tried."""

FEWEST = 40
"""Samples of that stretch from which on a delay shows."""

CLEAR = 6.0
"""Times that thrust lies closer to the delayed pressure than to the other: a slow rise, or a lag, stays below 6."""


BLOCK = 0.02
"""Seconds of samples that count as one observation: their noise goes together."""


@dataclass(frozen=True)
class Delay:
    """``seconds`` by which a channel is read later than another, and the log evidence for it, without any model."""

    seconds: float
    log_evidence: float


def thrust_delay(signals: Mapping[str, Signal]) -> Delay | None:
    """By how much thrust is read later than the chamber's pressure; None where it is not, or does not show.

    ``signals``: by channel, their times [s] after the opening.
    """
    if not {"thrust", "p_chamber"} <= set(signals):
        return None
    thrust, chamber = signals["thrust"], signals["p_chamber"]
    step = max(thrust.step, chamber.step, FINEST)
    time = np.arange(-BEFORE, AFTER, step)
    delays = step * np.arange(round(MOST / step) + 1)
    if time.size < FEWEST or thrust.between(-BEFORE, AFTER).time.size < FEWEST:
        return None
    read = thrust.at(time)
    apart = np.array([_misfit(read, chamber.at(time - delay)) for delay in delays])
    best = int(np.argmin(apart))
    if not LEAST <= delays[best] < MOST - step or apart[0] < CLEAR * apart[best]:
        return None
    closer = apart[0] / max(apart[best], 1e-12 * apart[0])
    return Delay(float(delays[best]), 0.5 * (BEFORE + AFTER) / BLOCK * float(np.log(closer)))


def _misfit(thrust: Array, pressure: Array) -> float:
    """Sum of squares of what a straight line from pressure to thrust leaves."""
    design = np.column_stack([np.ones_like(pressure), pressure])
    left = thrust - design @ np.linalg.lstsq(design, thrust, rcond=None)[0]
    return float(left @ left)
