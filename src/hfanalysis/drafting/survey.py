"""All columns of a test's logs, looked at: clocks, shapes, guesses, and which column is taken for which channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hfanalysis.drafting.clocks import Stamps, find_stamps, points, typical_step
from hfanalysis.drafting.columns import Column, LogFile, every
from hfanalysis.drafting.guesses import Guess, Judged, agreed, apart, judged
from hfanalysis.drafting.shapes import shape
from hfanalysis.drafting.twins import VOLTS, Twin, find_twins

FEW = 20
"""[samples] below which a column beside a longer one is no record of the firing. Evidence: marks of the authors (two
indices beside 9,103 rows) are arrays of a file, too."""
NAMELESS = 4
"""Columns up to which a log without names is one sensor's, so that its file's name stands for them."""


@dataclass(frozen=True)
class Surveyed:
    """The log files of a test, the stamps of each, the columns that are no stamps as they were judged, and which of
    them (by file and number) is taken for which channel.
    """

    files: tuple[LogFile, ...]
    stamps: dict[str, Stamps]
    columns: tuple[Judged, ...]
    chosen: dict[tuple[str, int], Guess]

    def guess(self, one: Judged) -> Guess | None:
        """The channel that a column is taken for, None where it is left open."""
        return self.chosen.get((one.column.file, one.column.number))


def survey(files: Sequence[LogFile]) -> Surveyed:
    """What is in the logs."""
    stamps = {file.name: find_stamps(file) for file in files}
    clocks = {(c.file, c.number) for file in files for c in file.columns if _is_clock(c, file, stamps[file.name])}
    measured = [column for column in every(files) if (column.file, column.number) not in clocks]
    twins = find_twins(measured)
    by_name = {file.name: file for file in files}
    found = [_judged(column, by_name[column.file], stamps[column.file], twins) for column in measured]
    found = agreed(apart(found))
    return Surveyed(tuple(files), stamps, tuple(found), chosen(found))


def _is_clock(column: Column, file: LogFile, stamps: Stamps) -> bool:
    given = {one.stamps for one in file.columns}
    return column is stamps.column or column.number in given or (column.written and points(column) >= 2.0)


def _judged(column: Column, file: LogFile, stamps: Stamps, twins: dict[tuple[str, int], Twin]) -> Judged:
    nameless = len(file.columns) <= NAMELESS and not any(one.label for one in file.columns)
    one = judged(column, shape(column.values), Path(file.name).stem if nameless else "")
    one = replace(one, rate=_rate(column, file, stamps))
    longest = max(other.samples for other in file.columns)
    if column.samples < FEW < longest:
        return replace(one, guesses=(), remark=f"{column.samples} values beside {longest} rows: no record over time")
    if column.text and not column.good.size:
        return replace(one, guesses=(), remark=f"text, such as {column.text!r}")
    twin = twins.get((column.file, column.number))
    if twin is None:
        return one
    raw = max(abs(column.least), abs(column.largest)) <= VOLTS < max(abs(twin.column.least), abs(twin.column.largest))
    words = f"{twin.words}: its raw volts?" if raw else twin.words
    return replace(one, guesses=(), remark=words)


def _rate(column: Column, file: LogFile, stamps: Stamps) -> float | None:
    """Samples per second [1/s]; None where there are no stamps."""
    own = file.numbered(column.stamps) if column.stamps else stamps.column
    if own is None:
        return None
    step = typical_step(own.good) / own.stride * (1.0 if column.stamps else stamps.factor)
    return float(f"{1.0 / step:.3g}") if step > 0.0 and np.isfinite(step) else None


def chosen(found: Sequence[Judged]) -> dict[tuple[str, int], Guess]:
    """Columns whose name and stated unit say together what they are: every channel once, the likeliest column first."""
    certain = [
        (guess.points, -k, guess, one.column)
        for k, one in enumerate(found)
        for guess in one.guesses[:1]
        if guess.certain
    ]
    taken: set[str] = set()
    made: dict[tuple[str, int], Guess] = {}
    for _, _, guess, column in sorted(certain, key=lambda item: item[:2], reverse=True):
        if guess.channel not in taken:
            taken.add(guess.channel)
            made[column.file, column.number] = guess
    return made
