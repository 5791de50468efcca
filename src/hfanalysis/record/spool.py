"""The columns of the log files on their way through: read in chunks, then taken one at a time.

They stay in memory up to a bound and move to temporary files beyond it. These have no name on disk, so a killed run
leaves nothing behind.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.record.readers import Source, Text

IN_MEMORY = 1 << 28
"""Bytes of one log file's columns that may stay in memory [B]. Evidence: benchmarks/ingest_1gb.py: a log of 1 GB, of
which that is a third, is ingested in less than its own size."""


@dataclass
class Spool:
    """Columns of one log file as numbers."""

    source: Source
    folder: Path
    text: dict[int, Text] = field(default_factory=dict)
    written: set[int] = field(default_factory=set)
    """Columns of stamps that are dates or times of day, here in seconds."""
    epochs: dict[int, float] = field(default_factory=dict)
    """Column of stamps -> the instant of its zero [s since 1970], where the log says so."""
    idle: NDArray[np.bool_] | None = None
    """Rows in which every column reads exactly zero; None where that says nothing."""
    _columns: dict[int, list[Array]] = field(default_factory=dict)
    _files: dict[int, IO[bytes]] = field(default_factory=dict)

    def fill(self, columns: Sequence[int], stamps: Sequence[int], progress: Callable[[float], None]) -> None:
        """Read the columns of the file once, in the unit of the log; ``progress`` is told the share [0 to 1] that has
        been read.
        """
        size, idle = 0, []
        for chunk in self.source.chunks(columns, stamps, progress):
            idle.append(_all_zero([chunk.columns[c] for c in columns]))
            for column, part in chunk.columns.items():
                self._columns.setdefault(column, []).append(part)
                size += part.nbytes
            if size > IN_MEMORY:
                self._to_disk()
                size = 0
            self._note(chunk.text)
            self.written |= chunk.written
            self.epochs |= chunk.epochs
        if self._files:
            self._to_disk()
        self.idle = _if_rare(np.concatenate(idle)) if idle and len(columns) > 1 else None

    def _note(self, met: dict[int, Text]) -> None:
        for column, text in met.items():
            before = self.text.get(column)
            self.text[column] = replace(before, count=before.count + text.count) if before else text

    def _to_disk(self) -> None:
        for column, parts in self._columns.items():
            if column not in self._files:
                self._files[column] = tempfile.TemporaryFile(dir=self.folder)  # noqa: SIM115
            for part in parts:
                self._files[column].write(np.ascontiguousarray(part).data)
        self._columns.clear()

    def rows(self, column: int) -> int:
        """How many numbers a column has."""
        on_disk = self._files[column].seek(0, 2) // 8 if column in self._files else 0
        return on_disk + sum(map(len, self._columns.get(column, ())))

    def look(self, column: int) -> Array:
        """The numbers (n,) of a column, in the unit of the log, not to be changed."""
        if column in self._files:
            return self._gathered(column)
        parts = self._columns.get(column, [])
        if len(parts) != 1:
            parts[:] = [np.concatenate([np.empty(0), *parts])]
        return parts[0]

    def _gathered(self, column: int) -> Array:
        """A column part of which is on disk."""
        numbers = np.empty(self.rows(column))
        self._files[column].seek(0)
        start = self._files[column].readinto(numbers.view(np.uint8)) // 8  # type: ignore[attr-defined]
        for part in self._columns.get(column, ()):
            numbers[start : start + len(part)] = part
            start += len(part)
        return numbers

    def take(self, column: int) -> Array:
        """The numbers (n,) of a column, in the unit of the log, which are the caller's from now on."""
        numbers = np.require(self.look(column), requirements="W")
        self._drop(column)
        return numbers

    def _drop(self, column: int) -> None:
        self._columns.pop(column, None)
        if column in self._files:
            self._files.pop(column).close()

    def close(self) -> None:
        """Give back everything."""
        for column in [*self._columns, *self._files]:
            self._drop(column)


def _all_zero(columns: Sequence[Array]) -> NDArray[np.bool_]:
    if len({len(column) for column in columns}) != 1:
        return np.zeros(0, dtype=bool)
    idle: NDArray[np.bool_] = columns[0] == 0.0
    for column in columns[1:]:
        if not idle.any():
            break
        idle &= column == 0.0
    return idle


def _if_rare(idle: NDArray[np.bool_]) -> NDArray[np.bool_] | None:
    """Rows of zeros are a dropped-out logger only where they are rare."""
    return idle if 0 < np.count_nonzero(idle) < 0.05 * len(idle) else None
