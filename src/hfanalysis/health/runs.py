"""Runs of readings, or of whole rows, that repeat what was there before: how long, and how likely that is by chance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.health.coarse import Span
from hfanalysis.record.quiet import LONGEST_QUIET

BY_CHANCE = 1e-6
"""Expected number of runs by chance [-] in a whole log below which a run is none. Source: definition: one log in a
million."""


@dataclass(frozen=True)
class Run:
    """Samples ``first`` to ``last`` (both included) that are those of ``lag`` samples before."""

    first: int
    last: int
    lag: int

    @property
    def length(self) -> int:
        """How many samples it has."""
        return self.last - self.first + 1


def true_runs(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """First and last place (runs, 2) of every run of trues in ``mask`` (n,)."""
    edges = np.flatnonzero(np.diff(mask.astype(np.int8), prepend=0, append=0))
    return np.column_stack([edges[::2], edges[1::2] - 1]).astype(np.int64)


def certain(length: int, chance: float, tries: float) -> bool:
    """Whether ``length`` matches in a row, each of a ``chance`` [-], are none by chance in so many ``tries``."""
    return bool(np.log(tries) + length * np.log(chance) < np.log(BY_CHANCE))


def asked_for(fire: Span | None, start: float, end: float) -> bool:
    """Whether a number may rest on a stretch [s]: on the firing, or on the quiet time about it."""
    return fire is None or (start < fire[1] + LONGEST_QUIET and end > fire[0] - LONGEST_QUIET)


def gap_edges(time: Array, first: int, last: int) -> tuple[float, float]:
    """From half a step before the sample ``first`` to half a step after ``last`` [s], so that no rounding moves it over
    a sample; ``time`` (n,) [s]."""
    before = time[first - 1] if first > 0 else time[first]
    after = time[last + 1] if last + 1 < len(time) else time[last]
    return float(0.5 * (before + time[first])), float(0.5 * (time[last] + after))


def row_hashes(columns: list[Array]) -> NDArray[np.uint64]:
    """A number (n,) for each row of ``columns`` (n,) each; equal rows have equal numbers, NaN equals NaN."""
    odd = np.random.default_rng(1).integers(1, 2**63, size=len(columns), dtype=np.uint64) | np.uint64(1)
    total: NDArray[Any] = np.zeros(len(columns[0]), dtype=np.uint64)
    for column, factor in zip(columns, odd, strict=True):
        bits = np.where(np.isnan(column), np.nan, column + 0.0).view(np.uint64)
        total = (total ^ (total >> np.uint64(29)) ^ bits) * factor
    return total
