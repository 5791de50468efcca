"""A log of a binary format, in memory as a whole: named series, each with its own length and perhaps its own time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.readers.base import Chunk, Progress


@dataclass(frozen=True)
class LogSeries:
    """Numbers under a name; ``time`` [s] where the format says when each was read."""

    name: str
    numbers: Array
    unit: str = ""
    time: Array | None = None


class Table:
    """An opened log of several series. The time of those that have one follows as a column ``NAME.time``."""

    sha256: str | None = None

    def __init__(self, path: Path, series: Sequence[LogSeries]) -> None:
        """Raises :class:`InputError` where there is no series."""
        if not series:
            raise InputError(f"{path}: found no series of numbers; expected at least one")
        timed = [(i, one.time) for i, one in enumerate(series) if one.time is not None]
        self.name = path.name
        self.columns = (*(one.name for one in series), *(f"{series[i].name}.time" for i, _ in timed))
        self.units = (*(one.unit for one in series), *("s" for _ in timed))
        self._numbers = [*(one.numbers for one in series), *(time for _, time in timed)]
        self._stamps = {i: len(series) + k for k, (i, _) in enumerate(timed)}

    def stamps_of(self, column: int) -> int | None:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        return self._stamps.get(column)

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """Everything at once; the arrays are copies, since the reader may be asked again."""
        yield Chunk({column: np.array(self._numbers[column]) for column in {*columns, *stamps}})
        progress(1.0)
