"""t_purge without a purge line to look at: where the tank, emptying as vapor, begins to fall less and less.

Vapor that expands loses its pressure at a rate that hardly changes: ln p is smooth. Nitrogen that enters lets the fall
die away, so that the slope of ln p, or its curvature, jumps. A weak inflow is not told from the vapor.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal

BLOCK = 0.02
"""Block means of the tank's pressure [s]: fine against a vapor phase."""

SETTLED = 0.1
"""After the end of the liquid, from which on the fall is the vapor's [s]. Evidence: the corner at t_v takes some 0.1 s
(HF5)."""

BEFORE, AFTER = 0.25, 0.5
"""Seconds of vapor needed before the jump, and seconds after it that are looked at. Evidence: test_purge_by_tank.py."""

LONGEST = 0.6
"""Seconds of vapor before the jump that are looked at: over more, an expansion is no quadratic."""

LATEST = 4.0
"""Seconds after t_v up to which it is looked for."""

CLEAR = 2.0
"""By which factor the jump has to bring down the variance that a smooth curve leaves. Evidence: test_purge_by_tank.py:
a tank that empties by itself shows none; HF5 has 6."""

STEP = 0.01
"""Between the instants that are tried [s]."""

SHAPE = 2.0
"""By which the deviation from the noise alone is widened: a curve of second order is no expansion. Evidence:
test_purge_by_tank.py."""

NONE = "the log has no p_purge, and the tank's fall does not show where nitrogen enters"


def find_nitrogen_by_tank(tank: Signal, t_v: float | None) -> tuple[float, float] | str:
    """t_purge [s] and its standard deviation [s], counted from the opening; else the reason.

    ``tank``: its pressure [Pa]; ``t_v`` [s]: the liquid is gone.
    """
    if t_v is None:
        return "the log has no p_purge: nitrogen shows in its supply line"
    part = tank.between(t_v + SETTLED, t_v + LATEST).reduced(BLOCK)
    if part.time.size < 24 or part.value.min() <= 0.0:
        return NONE
    tried = np.arange(part.time[0] + BEFORE, part.time[-1] - AFTER, STEP)
    floor = part.noise**2 / part.value.min() ** 2
    told = np.array([_told(part.time, np.log(part.value), instant, floor) for instant in tried]).reshape(-1, 2)
    if not told.size or told.max() < CLEAR:
        return NONE
    found = [_most_likely(tried, gain) for gain in told.T if gain.max() >= CLEAR]
    best, likely = found[int(np.argmax([gain.max() for gain in told.T if gain.max() >= CLEAR]))]
    apart = max(abs(other - best) for other, _ in found)
    return best, SHAPE * float(np.hypot(max(likely, BLOCK), 0.5 * apart))


def _most_likely(tried: Array, gain: Array) -> tuple[float, float]:
    """The instant [s] of the largest ``gain``, and half of the stretch in which it is as likely."""
    values = (BEFORE + AFTER) / BLOCK
    near = values * np.log(gain.max() / gain) < 1.0
    return float(tried[int(np.argmax(gain))]), 0.5 * STEP * float(near.sum())


def _told(time: Array, value: Array, instant: float, floor: float) -> tuple[float, float]:
    """By which factors a corner at an ``instant`` [s], and a jump of the curvature there, bring down the variance; 1
    where the fall would get faster. ``floor``: variance that the sensor's noise leaves."""
    part = (time > instant - LONGEST) & (time < instant + AFTER)
    x, y = time[part] - instant, value[part]
    smooth, later = np.vander(x, 3), np.maximum(x, 0.0)
    left = _left(smooth, y)[0] + floor * x.size
    gains = []
    for bend in (later, later**2):
        rest, beta = _left(np.column_stack((smooth, bend)), y)
        gains.append(left / (rest + floor * x.size) if beta[3] > 0.0 else 1.0)
    return gains[0], gains[1]


def _left(design: Array, value: Array) -> tuple[float, Array]:
    """Sum of squares that a fit leaves, and its coefficients."""
    beta = np.linalg.lstsq(design, value, rcond=None)[0]
    residual = value - design @ beta
    return float(residual @ residual), np.asarray(beta, dtype=np.float64)
