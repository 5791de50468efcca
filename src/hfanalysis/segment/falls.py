"""Abrupt falls of a signal, told apart where two events follow each other within tenths of a second."""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal

FALL_WINDOW = 0.03
"""Seconds over which the level is taken before and after a fall. Evidence: two falls of the chamber, of liquid and
fuel, confused the date of t_v; test_events.py tells them apart from 0.08 s on."""

RELAXATION = 0.02
"""Seconds in which most of a fall is over: the chamber has emptied to what still feeds it."""

LEAST_FALL = 0.15
"""Part of the level above ``floor`` that an abrupt fall takes; ripple of a rough fire is less over FALL_WINDOW."""

LASTING_PART = 0.5
"""Part of a fall that must still be there at the next fall, or ten windows later: a swing comes back. Evidence:
test_events.py: a tail or a swing is no fall."""

STEADY = 0.5
"""Largest part of a fall that may go on within the window before it. Evidence: test_events.py: the tail of an earlier
fall is no second one."""

CLEAR_OF_NOISE = 8.0
"""Least size of a fall in standard deviations of a window's mean."""


def abrupt_falls(signal: Signal, floor: float, start: float, end: float) -> list[float]:
    """Instants [s] in [``start``, ``end``] [s] at which a signal falls at once and stays down, in order of time.

    ``floor`` is the value of the signal, in its unit, where nothing drives it. Falls closer than FALL_WINDOW +
    RELAXATION count as one; where the samples are few, a window holds four of them.
    """
    width = max(FALL_WINDOW, 4.0 * signal.step)
    times = signal.between(start, end).time
    before = _levels(signal, times - width, times) - floor
    after = _levels(signal, times + RELAXATION, times + RELAXATION + width) - floor
    fall = np.where((before > 0.0) & np.isfinite(after), (before - after) / np.where(before > 0.0, before, 1.0), 0.0)
    found: list[tuple[float, float]] = []
    for k in np.argsort(-fall):
        if not fall[k] >= LEAST_FALL:
            break
        if all(abs(times[k] - t) > width + RELAXATION for t, _ in found):
            found.append((float(times[k]), float(before[k] - after[k])))
    found.sort()
    following = [*(t for t, _ in found), np.inf][1:]
    return [t for (t, size), then in zip(found, following, strict=True) if _is_step(signal, t, size, then, width)]


def _levels(signal: Signal, first: Array, last: Array) -> Array:
    """Means over many intervals [s] at once; NaN where one holds no sample."""
    total = np.concatenate(([0.0], np.cumsum(signal.value)))
    a, b = np.searchsorted(signal.time, first), np.searchsorted(signal.time, last)
    return np.asarray(np.where(b > a, (total[b] - total[a]) / np.maximum(b - a, 1), np.nan))


def _is_step(signal: Signal, time: float, size: float, following: float, width: float) -> bool:
    """Whether a fall stands out of the noise, starts from a steady level, and lasts until the ``following`` one [s]."""
    level = signal.mean(time - width, time)
    going_on = signal.mean(time - width, time - 0.5 * width) - signal.mean(time - 0.5 * width, time)
    until = max(min(time + 10.0 * width, following), time + RELAXATION + 0.5 * width)
    left = level - signal.mean(time + RELAXATION, until)
    error = signal.noise * np.sqrt(2.0 * signal.step / width)
    return bool(size > CLEAR_OF_NOISE * error and going_on < STEADY * size and left > LASTING_PART * size)
