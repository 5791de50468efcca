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

from hfanalysis.testdata.readers import Source, Text

Floats = NDArray[np.float64]
IN_MEMORY = 1 << 30
"""Bytes of one log file's columns that may stay in memory."""
BLOCK = 1 << 23
"""Samples of a column kept together: so many that the system hands out memory in large pages, as it is touched."""


@dataclass
class Growing:
    """A column in memory: its first part as it came, the rest in blocks."""

    blocks: list[Floats] = field(default_factory=list)
    size: int = 0
    room: int = 0

    def append(self, part: Floats) -> None:
        """Add numbers at the end."""
        self.size += len(part)
        if not self.blocks:
            self.blocks.append(part)
            return
        while len(part):
            if not self.room:
                self.blocks.append(np.empty(BLOCK))
                self.room = BLOCK
            count = min(self.room, len(part))
            start = BLOCK - self.room
            self.blocks[-1][start : start + count] = part[:count]
            part, self.room = part[count:], self.room - count

    def parts(self) -> list[Floats]:
        """The numbers, in order."""
        return [*self.blocks[:-1], *(block[: len(block) - self.room] for block in self.blocks[-1:])]


@dataclass
class Spool:
    """Columns of one log file as numbers."""

    source: Source
    folder: Path
    text: dict[int, Text] = field(default_factory=dict)
    written: set[int] = field(default_factory=set)
    """Columns of stamps that are dates or times of day, here in seconds."""
    idle: NDArray[np.bool_] | None = None
    """Rows in which every column reads exactly zero; None where that says nothing."""
    _columns: dict[int, Growing] = field(default_factory=dict)
    _files: dict[int, IO[bytes]] = field(default_factory=dict)

    def fill(self, columns: Sequence[int], stamps: Sequence[int], progress: Callable[[float], None]) -> None:
        """Read the columns of the file once."""
        np.empty(31 << 17)  # 31 MB given back: from then on glibc keeps freed memory of this size at hand
        size, idle = 0, []
        for chunk in self.source.chunks(columns, stamps, progress):
            idle.append(_all_zero([chunk.columns[c] for c in columns]))
            for column, numbers in chunk.columns.items():
                self._columns.setdefault(column, Growing()).append(numbers)
                size += numbers.nbytes
            if size > IN_MEMORY:
                self._to_disk()
                size = 0
            self._note(chunk.text)
            self.written |= chunk.written
        self.idle = _telling(np.concatenate(idle)) if idle and len(columns) > 1 else None

    def _note(self, met: dict[int, Text]) -> None:
        for column, text in met.items():
            before = self.text.get(column)
            self.text[column] = replace(before, count=before.count + text.count) if before else text

    def _to_disk(self) -> None:
        for column, grown in self._columns.items():
            if column not in self._files:
                self._files[column] = tempfile.TemporaryFile(dir=self.folder)  # noqa: SIM115
            for part in grown.parts():
                self._files[column].write(np.ascontiguousarray(part).data)
        self._columns.clear()

    def rows(self, column: int) -> int:
        """How many numbers a column has."""
        on_disk = self._files[column].seek(0, 2) // 8 if column in self._files else 0
        return on_disk + (self._columns[column].size if column in self._columns else 0)

    def take(self, column: int) -> Floats:
        """The numbers of a column, a fresh array."""
        numbers = np.empty(self.rows(column))
        start = 0
        if column in self._files:
            self._files[column].seek(0)
            start = self._files[column].readinto(numbers.view(np.uint8)) // 8  # type: ignore[attr-defined]
        for part in self._columns[column].parts() if column in self._columns else ():
            numbers[start : start + len(part)] = part
            start += len(part)
        return numbers

    def drop(self, column: int) -> None:
        """Give back what holds a column."""
        self._columns.pop(column, None)
        if column in self._files:
            self._files.pop(column).close()

    def close(self) -> None:
        """Give back everything."""
        for column in [*self._columns, *self._files]:
            self.drop(column)


def _all_zero(columns: Sequence[Floats]) -> NDArray[np.bool_]:
    if len({len(column) for column in columns}) != 1:
        return np.zeros(0, dtype=bool)
    idle: NDArray[np.bool_] = columns[0] == 0.0
    for column in columns[1:]:
        if not idle.any():
            break
        idle &= column == 0.0
    return idle


def _telling(idle: NDArray[np.bool_]) -> NDArray[np.bool_] | None:
    """Rows of zeros are a dropped-out logger only where they are rare."""
    return idle if 0 < np.count_nonzero(idle) < 0.05 * len(idle) else None
