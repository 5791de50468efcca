"""The oscillation of the burn, as block means show it: its covariance over time and between channels.

The chamber's pressure oscillates in a narrow band at tens of hertz, and the thrust with it. What of it is left in block
means is aliased: it is correlated over several blocks, with changing sign, and common to both channels. It is measured
from the blocks themselves, less their smooth course, and grows with the chamber's pressure.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from hfanalysis.arrays import Array

SMOOTHED, ORDER = 25, 3
"""Blocks over which the smooth course is a polynomial, and its order."""

_POWERS = np.vander(np.linspace(-1.0, 1.0, SMOOTHED), ORDER + 1)
_SMOOTHING = _POWERS @ np.linalg.pinv(_POWERS)
"""(blocks, blocks) The polynomial's values by the blocks' [-]. Source: Savitzky and Golay, Analytical Chemistry 36,
1964. scipy.signal has it, too, and takes half a second to load."""

KEPT = 1.0 - float(_SMOOTHING[SMOOTHED // 2, SMOOTHED // 2])
"""Part of the variance of noise that is left of it beside the smooth course, which follows some of it. Source: Savitzky
and Golay, Analytical Chemistry 36, 1964: the smooth course takes its middle weight. Evidence: without it the variance
came out too small by a tenth."""

LAGS = 12
"""Blocks over which the oscillation is coherent at most."""

UNEVEN = 0.1
"""Part of the oscillation that its neighbors and the other channel do not foretell: it grows and fades. Evidence:
chosen with the residuals of the practice cases P01 to P03 in view (docs/diagnosis.md)."""

SOMETIMES_EMPTY = 0.5
"""Blocks from one sample to the next from which on a clock that jitters leaves some of them empty [-]."""

WILD = 5.0
"""Standard deviations beyond which a block is no oscillation."""


def oscillation(
    blocks: Mapping[str, Array],
    level: Array,
    usable: NDArray[np.bool_],
    own: Mapping[str, float],
    spacing: float = 0.0,
) -> dict[tuple[str, str], Array]:
    """Covariance (blocks, blocks) [SI squared] of the oscillation, for every pair of channels.

    Args:
        blocks: means (blocks,) [SI] of each channel on a uniform grid.
        level: what it is proportional to (blocks,), 0 to 1.
        usable: blocks (blocks,) without gaps and changes of phase nearby.
        own: standard deviation [SI] of a block's mean that each sensor has by itself.
        spacing: blocks from one sample to the next [-]. Where it is one or more, blocks that hold none are passed over.
    """
    stretches = [s for s in _stretches(usable, spacing) if s.size > SMOOTHED]
    apart = _mean_distance(stretches)
    rough = {name: _rough(values, stretches) for name, values in blocks.items()}
    out = {}
    names = list(blocks)
    for i, a in enumerate(names):
        for b in names[i:]:
            noise = own[a] ** 2 if a == b else 0.0
            autocovariance = _autocovariance(rough[a], rough[b], level, stretches, noise)
            if a == b:
                autocovariance[0] *= 1.0 + UNEVEN
            else:
                autocovariance *= 1.0 - UNEVEN
            lags = apart * np.arange(autocovariance.size)
            out[a, b] = toeplitz(np.interp(np.arange(level.size), lags, autocovariance)) * np.outer(level, level)
            out[b, a] = out[a, b].T
    return out


def _stretches(usable: NDArray[np.bool_], spacing: float) -> list[NDArray[np.intp]]:
    """Usable blocks that follow one another, no farther apart than samples come.

    >>> [s.tolist() for s in _stretches(np.array([1, 1, 0, 1, 0, 0, 1], dtype=bool), 0.1)]
    [[0, 1], [3], [6]]
    >>> [s.tolist() for s in _stretches(np.array([1, 1, 0, 1, 0, 0, 1], dtype=bool), 1.0)]
    [[0, 1, 3], [6]]
    """
    found = np.flatnonzero(usable)
    farthest = 1 if spacing <= SOMETIMES_EMPTY else int(spacing) + 1
    return np.split(found, np.flatnonzero(np.diff(found) > farthest) + 1)


def _mean_distance(stretches: list[NDArray[np.intp]]) -> float:
    """Blocks from one of a stretch to the next, on the average [-]; 1 without any."""
    return float(np.mean(np.concatenate([np.diff(s) for s in stretches]))) if stretches else 1.0


def _rough(values: Array, stretches: list[NDArray[np.intp]]) -> Array:
    """What is left of the blocks after their smooth course; wild ones are cut."""
    out = np.zeros(values.size)
    for s in stretches:
        # by the blocks' own times first: where some are passed over, a slope is rough in those that are left
        left = values[s] - np.polynomial.Polynomial.fit(s, values[s], ORDER)(s)
        left -= _smooth(left)
        spread = 1.4826 * float(np.median(np.abs(left)))
        out[s] = np.clip(left, -WILD * spread, WILD * spread)
    return out


def _smooth(values: Array) -> Array:
    """The smooth course of ``SMOOTHED`` blocks or more: the polynomial around each, at the ends that of the last."""
    half = SMOOTHED // 2
    middle = np.convolve(values, _SMOOTHING[half], mode="valid")
    return np.concatenate([_SMOOTHING[:half] @ values[:SMOOTHED], middle, _SMOOTHING[half + 1 :] @ values[-SMOOTHED:]])


def _taper() -> Array:
    """Weights of the lags (LAGS + 1,) [-]. Source: Parzen, Technometrics 3, 1961: a window of 2 LAGS + 1 blocks."""
    lag = np.arange(LAGS + 1) / (LAGS + 0.5)
    return np.where(lag < 0.5, 1.0 - 6.0 * lag**2 * (1.0 - lag), 2.0 * (1.0 - lag) ** 3)


def _autocovariance(a: Array, b: Array, level: Array, stretches: list[NDArray[np.intp]], noise: float) -> Array:
    """At lags of 0, 1, ... blocks of a stretch, up to LAGS, and nothing beyond (LAGS + 2,), for a level of 1; the same
    forwards and backwards."""
    found = np.zeros(LAGS + 2)
    taper = _taper()
    for lag in range(LAGS + 1):
        product = scale = count = 0.0
        for s in stretches:
            x, y = s[: s.size - lag], s[lag:]
            product += 0.5 * float(a[x] @ b[y] + b[x] @ a[y])
            scale += float(level[x] @ level[y])
            count += x.size
        if scale > 0.0:
            found[lag] = taper[lag] * (product / KEPT - (noise * count if lag == 0 else 0.0)) / scale
    found[0] = max(found[0], 0.0) if noise > 0.0 else found[0]
    return found
