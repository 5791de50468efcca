"""By how much the chamber's pressure comes behind the thrust: a tube before its gauge, or a clock of its own.

Both follow the flow through the nozzle at once: where they rise and fall together, the shift by which one fits the
other best is the lag. Where nothing changes faster than a part of a second, there is none to see.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.performance.measured import Fire
from hfanalysis.performance.thrust import Thrust
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

LARGEST = 0.25
"""[s] that is looked for either way. Source: a tube of some meters, or a logger's filter, delays by less."""

SMOOTH = 0.5
"""[s], standard deviation of the Gaussian whose mean is the slow course, which tells no lag. Source: by choice: a burn
changes over seconds, its ends and its roughness within tenths."""

FINEST = 1e-3
"""[s] between samples that are compared. Source: a lag of less is none to a burn."""

ALIKE = 0.6
"""Correlation from which on both are taken to see the same. Source: by choice: below it most of what either sees is its
own."""


def pressure_lag(log: TestLog, segments: Segments, thrust: Thrust, fire: Fire) -> Quantity:
    """[s]; None with a reason where either does not show it."""
    if "p_chamber" not in log:
        return Quantity.absent(log.lacks("p_chamber"))
    origin = segments.t_open.value or 0.0
    chamber, cell = Signal.of(log["p_chamber"]).shifted(origin), thrust.signal
    start, end = -LARGEST, min(fire.end + LARGEST, float(min(chamber.time[-1], cell.time[-1])) - LARGEST)
    step = max(chamber.step, cell.step, FINEST)
    if not end - start > 4.0 * SMOOTH or step > 0.5 * LARGEST:
        return Quantity.absent("too few samples of p_chamber and thrust at one time")
    shifts = np.arange(-round(LARGEST / step), round(LARGEST / step) + 1)
    clock = np.arange(start, end, step)
    pressure, force = (_fast(signal, clock, step) for signal in (chamber, cell))
    inside = slice(shifts[-1], clock.size - shifts[-1])
    of_force = force[inside]
    alike = np.array([_correlation(of_force, np.roll(pressure, -int(k))[inside]) for k in shifts])
    best = int(alike.argmax())
    if alike[best] < ALIKE or best in (0, alike.size - 1):
        return Quantity.absent("p_chamber and thrust do not rise and fall together fast enough to tell")
    bend = alike[best - 1] - 2.0 * alike[best] + alike[best + 1]
    part = 0.5 * (alike[best - 1] - alike[best + 1]) / bend if bend < 0.0 else 0.0
    # neighbors in time are alike: of a band of 1 / SMOOTH each second holds so many that are not
    independent = max((end - start) / SMOOTH, 2.0)
    scatter = step * float(np.sqrt((1.0 - alike[best] ** 2) / max(-bend * independent, 1e-12)))
    std = float(np.hypot(min(scatter, LARGEST), step / np.sqrt(12.0)))
    return Quantity(float(step * (shifts[best] + part)), "s", std, why="shift by which both rise and fall together")


def _fast(signal: Signal, clock: Array, step: float) -> Array:
    """A signal on the clock (n,) less its slow course."""
    from scipy.ndimage import gaussian_filter1d

    reduced = signal.reduced(step) if step > 1.5 * signal.step else signal
    value = reduced.at(clock)
    return np.asarray(value - gaussian_filter1d(value, SMOOTH / step, mode="nearest"))


def _correlation(one: Array, other: Array) -> float:
    a, b = one - one.mean(), other - other.mean()
    return float(a @ b / max(float(np.sqrt((a @ a) * (b @ b))), 1e-300))
