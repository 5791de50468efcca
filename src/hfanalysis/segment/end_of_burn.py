"""t_end: the chamber's pressure is below 1.8 times ambient for good.

That is a level, no more: a nozzle with a diverging part stays choked down to 1.03 times ambient in one dimension, 1.05
to 1.3 with losses, and what burns may burn on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.breaks import memory_length
from hfanalysis.sentences import said, text

CRITICAL_RATIO = 1.80
"""p_c / p_a [-] of t_end. Source: ((gamma + 1)/2)^(gamma/(gamma - 1)), 1.77 to 1.83 for gamma of 1.2 to 1.3: where a
nozzle without a diverging part would unchoke."""

SMOOTH = 0.1
"""Seconds over which the chamber's pressure is smoothed for a first look."""

APART = 1.0
"""Seconds for which the chamber rests below before what comes then counts as no part of the burn: a purge."""

WINDOWS = (0.15, 0.3, 0.6, 1.2, 2.4)
"""Seconds on either side of the end through which a parabola is laid: the widest that still fits."""

FITS = 1.05
"""A parabola fits as long as it leaves no more than this times what the narrowest one leaves. Evidence: with 1.15 the
95 % interval held 82 % of 28 simulated ends of burns, with this 96 %."""

CLEAR = 4.0
"""Standard deviations by which neighbors are above and below, so that no noise made them so. Source: one in 30,000."""

QUIET = (-3.0, -0.05)
"""Seconds before the opening from which the chamber's zero and the sensor's wander are known."""


def find_low_pressure(
    chamber: Signal, ambient: float, t_feed: float, offset: float = 0.0, bias: float = 0.0, noise: Noise | None = None
) -> tuple[float, float] | str:
    """t_end [s] and its standard deviation [s] from the chamber pressure with time from the opening; else the reason.

    ``ambient`` [Pa] is the air's, ``t_feed`` [s] from when on it is looked for, ``offset`` [Pa] how far the open
    chamber read from ambient, ``bias`` [Pa] the standard deviation of how the limit reads, ``noise`` the sensor's.
    """
    part = chamber.between(max(t_feed, 0.0), np.inf)
    if part.time.size < 8:
        return "the log ends before the chamber's pressure can fall"
    smooth = part.smooth(max(SMOOTH, 4.0 * chamber.step))
    limit = CRITICAL_RATIO * ambient + offset
    if not (smooth > limit).any():
        return "the chamber pressure never is above 1.8 times ambient"
    last = _last_of_burn(part.time, smooth - limit)
    if last >= smooth.size - 2:
        left = said(float(smooth[-1]) - offset, "bar", ".1f")
        return text("the log ends with {left} in the chamber, above 1.8 times ambient", left=left)
    quiet = chamber.between(QUIET[0], QUIET[1])
    noise = noise or Noise.of(chamber, quiet)
    since = float(quiet.time[0]) if quiet.time.size else QUIET[0]
    rough = float(part.time[last])
    return _at_once(part, rough, limit, bias) or _crossing(part, rough, limit, noise, bias, (since, QUIET[1]))


def pulses_after(chamber: Signal, limit: float, t_end: float) -> list[tuple[float, float]]:
    """From when to when [s] the chamber stands above the ``limit`` [Pa] again after ``t_end`` [s]: gas that is blown
    through, no burn."""
    part = chamber.between(t_end + APART, np.inf)
    if part.time.size < 8:
        return []
    above = part.smooth(max(SMOOTH, 4.0 * chamber.step)) > limit
    return [
        (float(part.time[a]), float(part.time[b]))
        for a, b in _runs(part.time, above)
        if part.time[b] - part.time[a] > SMOOTH
    ]


def _runs(time: Array, above: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each stretch above, those closer than APART together as one."""
    index = np.flatnonzero(above)
    if not index.size:
        return []
    cuts = np.flatnonzero(np.diff(time[index]) > APART)
    return list(zip(index[np.r_[0, cuts + 1]], index[np.r_[cuts, index.size - 1]], strict=True))


def _last_of_burn(time: Array, excess: Array) -> int:
    """The last index above of the stretch that holds the most pressure over time."""
    runs = _runs(time, excess > 0.0)
    sizes = [float(np.trapezoid(excess[a : b + 1], time[a : b + 1])) for a, b in runs]
    return int(runs[int(np.argmax(sizes))][1])


def _at_once(part: Signal, rough: float, limit: float, bias: float) -> tuple[float, float] | None:
    """Between which two samples about ``rough`` [s] the limit [Pa] is passed, where both are clear of it; else None."""
    near = part.between(rough - 2.0 * SMOOTH, rough + 2.0 * SMOOTH)
    above = near.value > limit
    last = int(above.argmin()) - 1
    if last < 0 or above[last + 1 :].any():
        return None
    sides = near.value[last] - limit, limit - near.value[last + 1]
    if min(sides) < CLEAR * max(part.noise, bias):
        return None
    step = float(near.time[last + 1] - near.time[last])
    return float(near.time[last]) + 0.5 * step, step / float(np.sqrt(12.0))


def _crossing(
    part: Signal, rough: float, limit: float, noise: Noise, bias: float, quiet: tuple[float, float]
) -> tuple[float, float]:
    """Where the parabola through what is around ``rough`` [s] passes the limit [Pa]; its error over its slope.

    The sensor has wandered since the ``quiet`` time [s] in which its zero was taken. A last crossing of noise alone
    comes too late, the later the more slowly the pressure falls.
    """
    best: tuple[float, float] | None = None
    narrowest = np.inf
    for wide in WINDOWS:
        near = part.between(rough - wide, rough + wide)
        if near.time.size < 8:
            continue
        x = near.time - rough
        curve = np.polynomial.Polynomial.fit(x, near.value, 2).convert()
        residual = near.value - curve(x)
        spread = float(np.sqrt(residual @ residual / (x.size - 3)))
        narrowest = min(narrowest, spread)
        passes = _root(curve, limit, wide)
        if spread > FITS * narrowest and best is not None:
            break
        if passes is not None:
            slope = abs(float(curve.deriv()(passes)))
            wander = noise.difference_std(quiet, (rough + passes - wide, rough + passes + wide))
            error = np.linalg.norm([_scatter(near, rough + passes, residual), wander, bias])
            best = rough + passes, float(np.hypot(error / max(slope, 1.0), part.step / np.sqrt(12.0)))
    return best if best is not None else (rough, max(SMOOTH, 4.0 * part.step))


def _root(curve: np.polynomial.Polynomial, limit: float, wide: float) -> float | None:
    roots = (curve - limit).roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    falling = [float(r) for r in real if abs(r) < wide and curve.deriv()(r) < 0.0]
    return min(falling, key=abs, default=None)


def _scatter(near: Signal, instant: float, residual: Array) -> float:
    """Standard deviation [Pa] of the parabola at an instant [s] from what it leaves."""
    x = near.time - instant
    weights = np.linalg.pinv(np.stack([np.ones_like(x), x, x**2], axis=1))[0]
    return float(residual.std() * np.sqrt(memory_length(residual)) * np.linalg.norm(weights))
