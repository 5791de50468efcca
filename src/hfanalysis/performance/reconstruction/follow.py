"""The mixture whose gas takes the flow away: all of them, and the one that leads on from the moment before.

A chamber pressure p_c says the flow through the throat, p_c A_t / c*; the oxidizer's share of it is known. So

    (1 + 1 / OF) c*(p_c, OF) = p_c A_t / (efficiency * oxidizer flow)

has to be solved for OF. The left side falls with OF on the lean side; from its peak to its valley on the rich side it
rises: up to three mixtures fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array

PACE = 0.5
"""Change of the logarithm of OF that is usual within a second. Source: a port that doubles within some seconds changes
the flux by four, and OF by its root."""

MISSES = 0.01
"""Part of the pressure by which a peak may miss where nothing fits: noise, and what the gauge errs by."""

FARTHEST = 5.0
"""Of MISSES, from which on a peak does not count."""

KINDS = 5
"""Mixtures that are kept at a time: lean, middle and rich, and the peak and the valley where nothing fits."""


@dataclass(frozen=True)
class Followed:
    """Logarithm of OF (n, lanes), NaN where nothing fits; ``cost`` (lanes,) of each path [-]."""

    mixture: Array
    cost: Array


def follow(left: Array, mixtures: Array, right: Array, step: float, start: int) -> Followed:
    """The path that moves least, for each lane.

    Args:
        left: (1 + 1/OF) c* over the mixtures, (n, mixtures) [m/s].
        right: what it has to be, (n, lanes) [m/s].
        step: [s] between the rows.
        start: with which of those that fit it begins, from the leanest on (0, 1, 2).
    """
    x = np.log(mixtures)
    found = np.stack([_fits(row, x, want) for row, want in zip(left, right, strict=True)])
    miss = np.stack([_misses(row, want) for row, want in zip(left, right, strict=True)])
    return _least(found, miss, step, start)


def _turns(row: Array) -> tuple[int, int]:
    """Places of the valley and of the peak behind it; the same where it falls throughout."""
    rising = np.flatnonzero(np.diff(row) > 0.0)
    return (int(rising[0]), int(rising[-1]) + 1) if rising.size else (0, 0)


def _fits(row: Array, x: Array, want: Array) -> Array:
    """ln OF on the lean, middle and rich side, at the peak and in the valley, (KINDS, lanes); NaN where it is none."""
    valley, peak = _turns(row)
    out = np.full((KINDS, want.size), np.nan)
    out[0] = np.interp(-want, -row[peak:], x[peak:], left=np.nan, right=np.nan)
    if peak > valley:
        out[1] = np.interp(want, row[valley : peak + 1], x[valley : peak + 1], left=np.nan, right=np.nan)
        out[2] = np.interp(-want, -row[: valley + 1], x[: valley + 1], left=np.nan, right=np.nan)
        out[3] = np.where(want > row[peak], x[peak], np.nan)
        out[4] = np.where(want < row[valley], x[valley], np.nan)
    return out


def _misses(row: Array, want: Array) -> Array:
    """What it costs that nothing fits, (KINDS, lanes)."""
    valley, peak = _turns(row)
    out = np.zeros((KINDS, want.size))
    for kind, place in ((3, peak), (4, valley)):
        out[kind] = (np.log(want / row[place]) / MISSES) ** 2
    return np.where(out > FARTHEST**2, np.inf, out)


def _least(found: Array, miss: Array, step: float, start: int) -> Followed:
    """Over time (n, KINDS, lanes): the path whose logarithm moves least."""
    n, _, lanes = found.shape
    ok = np.isfinite(found)
    cost = np.where(ok[0], miss[0], np.inf)
    leanest_first = np.argsort(np.where(np.isfinite(cost), -found[0], np.inf), axis=0)
    cost = np.where(np.arange(KINDS)[:, None] == leanest_first[start], cost, np.inf)
    came = np.zeros((n, KINDS, lanes), dtype=np.int64)
    for i in range(1, n):
        moved = (found[i][None] - found[i - 1][:, None]) ** 2 / (PACE**2 * step)
        total = np.where(np.isfinite(moved), moved, np.inf) + cost[:, None]
        came[i] = total.argmin(axis=0)
        cost = total.min(axis=0) + np.where(ok[i], miss[i], np.inf)
    last, index = cost.argmin(axis=0), np.arange(lanes)
    best, path = cost[last, index], np.full((n, lanes), np.nan)
    for i in range(n - 1, -1, -1):
        path[i] = found[i, last, index]
        last = came[i, last, index]
    return Followed(np.where(np.isfinite(best), path, np.nan), best)
