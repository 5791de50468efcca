"""How long the fuel takes to be gone: a fall of chamber pressure and thrust that is slower than a chamber empties.

A grain that burns through everywhere at once leaves a chamber that flushes within milliseconds; one that does not
leaves a fire that dies with its surface. A slow line to the chamber's sensor makes the pressure's fall slow as well,
but not that of the thrust: the faster of the two counts.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.inference.observations.recorded import LONGEST_RECORD, TOGETHER
from hfanalysis.products.segments import Segments
from hfanalysis.record.signals import Signal

BEFORE, AFTER, CLEAR = 0.3, 0.5, 0.05
"""Seconds looked at before and after the end of the fuel, and kept clear of the end of the liquid."""

EARLIEST, LATEST, INSTANTS = -0.06, 0.14, 41
"""Where a fall may begin, after the fuel's end as it was segmented [s], and how many instants are tried."""

DURATIONS = np.geomspace(1e-3, 0.5, 28)
"""Seconds that a fall may take."""

RESOLVED = 3.0
"""Sample intervals that a fall takes at least to have a duration."""

SHORTEST = 10
"""Samples ahead of all falls that are tried, and behind them."""

SHARP = 0.05
"""Standard deviation [s] of the fuel's end above which it is no fall but a slope that blocks show."""

UNSURE, LAG = 1.5, 5e-3
"""Standard deviation of the log of a fall's duration; and the seconds by which what is between the chamber and both
sensors may slow a fall, the line to the one and the mount of the other. Source: what is left in pores and on walls
burns on, and a chamber without a flame turns cold, within 6 ms to 1 s, and nobody knows how fast on a stand: the
deviation of logarithms spread evenly over that. A slow fall is worth a note; a name needs more."""


def fade_of(signals: Mapping[str, Signal], segments: Segments) -> tuple[float, float] | None:
    """Time [s] in which chamber pressure and thrust fall as the fuel ends, and the standard deviation of its log [-].

    None where that does not show. ``signals``: with times after the opening [s].
    """
    gone, t_v = segments.time("t_fuel_gone"), segments.time("t_v")
    if gone is None or gone > LONGEST_RECORD or segments.std("t_fuel_gone") > SHARP:
        return None
    if not set(TOGETHER) <= set(signals):
        return None
    read = [signals[name].between(*about(gone, t_v)) for name in TOGETHER]
    found = [fall_of(part, gone) for part in read]
    if None in found:
        return None
    seconds = min(d for d in found if d is not None)
    slowed = float(np.hypot(LAG, 2.0 * max(part.step for part in read)))
    return seconds, float(np.hypot(UNSURE, slowed / seconds))


def about(gone: float, liquid_out: float | None) -> tuple[float, float]:
    """What is looked at about the end of the fuel ``gone``, clear of that of the liquid: from and to; all [s after the
    opening]."""
    start, end = gone - BEFORE, gone + AFTER
    if liquid_out is None:
        return start, end
    return (max(start, liquid_out + CLEAR), end) if liquid_out < gone else (start, min(end, liquid_out - CLEAR))


def fall_of(part: Signal, gone: float) -> float | None:
    """Duration [s] of the ramp between two straight lines that fits best about ``gone`` [s after the opening]; None
    where it is not resolved."""
    starts = gone + np.linspace(EARLIEST, LATEST, INSTANTS)
    if (part.time < starts[0]).sum() < SHORTEST or (part.time > starts[-1]).sum() < SHORTEST:
        return None
    best = float(min(DURATIONS, key=lambda duration: min(_misfit(part, at, duration) for at in starts)))
    return best if best > RESOLVED * part.step else None


def _misfit(part: Signal, at: float, duration: float) -> float:
    """Sum of squares left by a ramp that begins ``at`` an instant [s]."""
    x = part.time - at
    columns = np.stack(
        [np.ones_like(x), np.clip(x / duration, 0.0, 1.0), np.minimum(x, 0.0), np.maximum(x - duration, 0.0)], axis=1
    )
    return float(np.sum((part.value - columns @ np.linalg.lstsq(columns, part.value)[0]) ** 2))
