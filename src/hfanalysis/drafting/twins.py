"""Columns that are one signal: raw volts beside engineering units, a gauge pressure beside the absolute one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.drafting.columns import Column

LOOKED_AT = 5000
"""[samples] of two columns that are compared."""
ALIKE = 1e-6
"""One less the squared correlation of two columns that are one signal. Evidence: raw volts beside engineering units
leave 3e-7 at most in five logs of one stand; a sum of two cells and one of them leaves 8e-5."""
VOLTS = 11.0
"""Readings up to which a column may be the raw volts of an input card. Source: cards read 5 or 10 V."""
MADE = 3.0
"""Times the range of a column by which that of what was made of its volts is larger. Evidence: transducers of 5 V read
100 bar, cells of 10 mV 1 kN."""


@dataclass(frozen=True)
class Twin:
    """``column`` is another's signal: other = scale * column + offset."""

    column: Column
    scale: float
    offset: float

    @property
    def words(self) -> str:
        """What it is, for people."""
        if self.scale == 1.0 and self.offset == 0.0:
            return f"the same numbers as {self.column.shown!r}"
        shift = f" {self.offset:+.4g}" if abs(self.offset) > 1e-9 else ""
        return f"one signal with {self.column.shown!r} ({self.scale:.4g} times that{shift})"


def find_twins(columns: Sequence[Column]) -> dict[tuple[str, int], Twin]:
    """By file and number, the column whose signal another is: volts point to what was made of them, of two others the
    later one to the earlier one.
    """
    living = [(column, thinned(column)) for column in columns]
    living = [(column, part) for column, part in living if part.size > 10 and np.ptp(part) > 0.0]
    found: dict[tuple[str, int], Twin] = {}
    for k, (later, numbers) in enumerate(living):
        for earlier, others in living[:k]:
            if earlier.file == later.file and (earlier.file, earlier.number) not in found and _alike(numbers, others):
                first, second = _in_order(earlier, later)
                found[second.file, second.number] = _twin(first, second)
                break
    return found


def thinned(column: Column) -> Array:
    """A few of a column's finite values, evenly; nothing where some are missing (then rows do not match)."""
    if not np.isfinite(column.values).all():
        return np.empty(0)
    return column.values[:: max(1, column.values.size // LOOKED_AT)]


def _alike(one: Array, other: Array) -> bool:
    if one.size != other.size:
        return False
    deviation, other_deviation = one - one.mean(), other - other.mean()
    both = float(np.sqrt(np.dot(deviation, deviation)) * np.sqrt(np.dot(other_deviation, other_deviation)))
    return both > 0.0 and 1.0 - (float(np.dot(deviation, other_deviation)) / both) ** 2 < ALIKE


def _in_order(earlier: Column, later: Column) -> tuple[Column, Column]:
    """Which one to keep: one with a stated unit; else the one of much larger numbers; else the first."""
    if bool(earlier.unit) != bool(later.unit):
        return (earlier, later) if earlier.unit else (later, earlier)
    larger = later.largest - later.least > MADE * (earlier.largest - earlier.least)
    return (later, earlier) if larger else (earlier, later)


def _twin(kept: Column, other: Column) -> Twin:
    if np.array_equal(kept.values, other.values):
        return Twin(kept, 1.0, 0.0)
    scale, offset = np.polyfit(kept.values, other.values, 1)
    return Twin(kept, float(scale), float(offset))
