"""The columns of the log files on their way through: read in chunks, kept in unnamed temporary files.

Only the column at work is in memory. The files have no name on disk, so a killed run leaves nothing behind.
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
IN_MEMORY = 1 << 22
"""Bytes of a column that stay in memory: most logs never touch the disk."""


@dataclass
class Spool:
    """Columns of one log file as numbers."""

    source: Source
    folder: Path
    files: dict[int, IO[bytes]] = field(default_factory=dict)
    text: dict[int, Text] = field(default_factory=dict)
    written: set[int] = field(default_factory=set)
    """Columns of stamps that are dates or times of day, here in seconds."""

    def fill(self, columns: Sequence[int], stamps: Sequence[int], progress: Callable[[float], None]) -> None:
        """Read the columns of the file once."""
        for chunk in self.source.chunks(columns, stamps, progress):
            for column, numbers in chunk.columns.items():
                self._file(column).write(np.ascontiguousarray(numbers, dtype="<f8").data)
            self.written |= chunk.written
            for column, text in chunk.text.items():
                before = self.text.get(column)
                self.text[column] = replace(before, count=before.count + text.count) if before else text

    def _file(self, column: int) -> IO[bytes]:
        if column not in self.files:
            self.files[column] = tempfile.SpooledTemporaryFile(IN_MEMORY, dir=str(self.folder))  # noqa: SIM115
        return self.files[column]

    def take(self, column: int) -> Floats:
        """The numbers of a column, a fresh array."""
        if column not in self.files:
            return np.empty(0)
        file = self.files[column]
        file.seek(0)
        return np.frombuffer(bytearray(file.read()), dtype="<f8")

    def close(self) -> None:
        """Give back the temporary files."""
        for file in self.files.values():
            file.close()
