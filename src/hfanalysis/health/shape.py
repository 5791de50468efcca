"""What detectors ask of a run of samples: stretches of a mask, block means, a local noise, a jump."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.record.quiet import Trace
from hfanalysis.record.signals import MAD_TO_STD

Mask = NDArray[np.bool_]


def stretches(mask: Mask, bridge: int = 0) -> Iterator[tuple[int, int]]:
    """From where to where (the latter excluded) a mask (n,) holds; breaks of at most ``bridge`` samples are none.

    >>> list(stretches(np.array([0, 1, 1, 0, 1, 0], dtype=bool)))
    [(1, 3), (4, 5)]
    >>> list(stretches(np.array([0, 1, 1, 0, 1, 0], dtype=bool), bridge=1))
    [(1, 5)]
    """
    edges = np.flatnonzero(np.diff(mask.astype(np.int8), prepend=0, append=0))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return
    apart = np.flatnonzero(starts[1:] - ends[:-1] > bridge)
    yield from zip(starts[np.r_[0, apart + 1]].tolist(), ends[np.r_[apart, len(ends) - 1]].tolist(), strict=True)


def running_median(values: Array, width: int = 5) -> Array:
    """Median (n,) of ``width`` (odd) neighbors: what fewer than half of them read is not seen."""
    half = width // 2
    if len(values) < width:
        return np.full(len(values), np.median(values)) if len(values) else values
    padded = np.pad(values, half, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1))


def by_blocks(trace: Trace, count: int, least: int = 16) -> list[Trace]:
    """The samples in about ``count`` blocks of as many each, at ``least`` so many."""
    number = min(count, len(trace.time) // least)
    if number < 1:
        return []
    parts = zip(np.array_split(trace.time, number), np.array_split(trace.values, number), strict=True)
    return [Trace(time, values) for time, values in parts]


def spread_about_neighbors(values: Array) -> float:
    """Standard deviation of a sample about a locally straight line, in the unit of ``values`` (n,): of second
    differences as they are, not their median, so that noise of which every other sample is wild counts in full.
    """
    return float(np.std(np.diff(values, 2)) / np.sqrt(6.0)) if len(values) > 3 else 0.0


def usual_step(values: Array) -> float:
    """Standard deviation of a change between neighbors, by its median; quantized channels have none."""
    return float(MAD_TO_STD * np.median(np.abs(np.diff(values)))) if len(values) > 1 else 0.0
