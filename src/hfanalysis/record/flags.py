"""Quality flags per sample. Nothing is repaired: a flag says why a reading is not to be trusted.

The rules compare a channel with itself, so that a quantized, quiet or clamped channel is not flagged wholesale, and a
fast step (valve opening, liquid depletion) or an oscillation is no spike. What is doubtful is left alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record import flag_kernels
from hfanalysis.record.log import Flag, Flags

SENTINELS = (999.0, 9999.0, 999.9, 99999.0, -999.0, -9999.0, -99999.0, 32767.0, -32768.0, 65535.0)
"""Readings that loggers write where there is none. Source: the ends of 16-bit numbers; rows of nines by custom."""
DETACHED = 0.2
"""Share of a channel's range by which an exact level must stand apart from its neighbors to be no reading. Evidence:
test_flags.py: an open thermocouple drops out, zeros of a quantized cell at rest are readings."""
CUT_OFF = ("pressure", "force", "mass")
"""Dimensions of sensors whose readings are cut off at the end of their range; an open thermocouple stays at its end."""
RAIL_SHARE = 0.05
"""Share of the log from which on its highest level is a rail, not a code for no reading [-]. Evidence: a chamber gauge
cut off at 12 bar through a burn that one sample begins and one ends (test_detectors.py)."""
IMPOSSIBLE = {"temperature": (1.0, 6000.0), "pressure": (-5e5, 1e9), "force": (-1e8, 1e8), "mass": (-1e6, 1e6)}
"""[SI] outside of which no sensor reads, however badly zeroed: 1 to 6000 K, -5 bar to 10,000 bar, the thrust of the
largest rockets, and a thousand tons."""


def flag_readings(readings: Array, dimension: str, missing: Sequence[float] = ()) -> Flags:
    """The flags (n,) of a channel's readings (n,) as logged (before unit, zero and tare).

    ``dimension`` is that of the channel, ``missing`` the readings that stand for none, in the unit of the log.
    """
    flags = np.zeros(len(readings), dtype=np.uint8)
    if len(readings) and not np.isfinite(readings.min() + readings.max()):
        flags[~np.isfinite(readings)] = Flag.DROPOUT
    for value in missing:
        flags[readings == value] = Flag.DROPOUT
    if dimension == "dimensionless":
        return flags
    _flag_unread(readings, flags)
    if dimension in CUT_OFF:
        _flag_cut_off(readings, flags)
    _flag_live(readings, flags)
    return flags


def flag_impossible(values: Array, dimension: str, flags: Flags) -> None:
    """Flags samples [SI] that no sensor of this dimension can read; ``values`` and ``flags`` have shape (n,)."""
    if dimension in IMPOSSIBLE:
        low, high = IMPOSSIBLE[dimension]
        wild = (values < low) | (values > high)
        if wild.any():
            flags[wild] |= np.uint8(Flag.DROPOUT)


def _flag_unread(readings: Array, flags: Flags) -> None:
    """Flags exact levels that stand for no reading: sentinels, zeros and extremes apart from all else.

    Once one is found the next extreme is looked at, which may be another.
    """
    for _ in range(3):
        live = readings[flags == 0] if flags.any() else readings
        if not len(live):
            return
        low, high = float(live.min()), float(live.max())
        if low == high and low in SENTINELS:
            flags[readings == low] = Flag.DROPOUT
        doubtful = {low, high, 0.0} if low < 0.0 < high else {low, high}
        levels = [level for level in sorted(doubtful) if _may_be_none(level, live)]
        if low == high or not levels:
            return
        gap = _gap(readings, flags)
        if not sum(_flag_detached(readings, level, gap, flags) for level in levels):
            return


def _flag_cut_off(readings: Array, flags: Flags) -> None:
    """The highest level, apart from all else as a code is, but read for long: the channel is cut off there."""
    lost = (flags == Flag.DROPOUT) & np.isfinite(readings)
    if not lost.any() or not (flags == 0).any():
        return
    top = float(readings[lost].max())
    long = np.count_nonzero(readings == top) > RAIL_SHARE * len(readings)
    if long and top not in SENTINELS and top > readings[flags == 0].max():
        flags[lost & (readings == top)] = Flag.SATURATED


def _may_be_none(level: float, live: Array) -> bool:
    count = int(np.count_nonzero(live == level))
    return count >= 3 or (count > 0 and (level == 0.0 or level in SENTINELS))


def _flag_detached(readings: Array, level: float, gap: float, flags: Flags) -> int:
    """Flags runs of ``level``; a mere extreme must stand apart from every other reading, not only from those next."""
    sentinel = level in SENTINELS
    if not sentinel and level != 0.0 and flag_kernels.nearest(readings, level, flags) <= gap:
        return 0
    return int(flag_kernels.detached(readings, level, gap, sentinel, flags))


def _gap(readings: Array, flags: Flags) -> float:
    """The jump that sets a level apart: a good part of the channel's usual range, and many of its usual steps."""
    every = max(1, len(readings) // 20_000)
    sample = readings[::every][flags[::every] == 0]
    some = readings[:20_000]
    steps = np.abs(np.diff(some[np.isfinite(some)]))
    steps = steps[steps > 0]
    low, high = np.percentile(sample, (5, 95)) if len(sample) else (0.0, 0.0)
    return float(max(DETACHED * (high - low), 10.0 * np.median(steps) if len(steps) else 0.0, 1e-300))


def _flag_live(readings: Array, flags: Flags) -> None:
    """Stuck, saturated and spiking samples among those that are readings."""
    whole = not flags.any()
    live = slice(None) if whole else flags == 0
    values = readings[live]
    if len(values) < 20:
        return
    found = np.zeros(len(values), dtype=np.uint8)
    flag_kernels.repeats(values, float(values.min()), float(values.max()), found)
    flag_kernels.spikes(values, flag_kernels.local_noise(values), _quantum(values), found)
    flags[live] |= found


def _quantum(values: Array) -> float:
    """The usual size of a change of reading, which for a quantized channel is its resolution."""
    steps = np.abs(np.diff(values[:20_000]))
    steps = steps[steps > 0]
    return float(np.percentile(steps, 10)) if len(steps) else 0.0
