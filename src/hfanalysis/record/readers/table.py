"""A log of a binary format, in memory as a whole: named series, each with its own length and perhaps its own time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.readers.base import Chunk, Progress, Text

WIDEST = 256
"""Columns of a matrix beyond which it is no set of channels. Evidence: pictures and spectra have more."""


@dataclass(frozen=True)
class LogSeries:
    """Numbers under a name; ``time`` [s] where the format says when each was read, from ``epoch`` [s since 1970] where
    it says from when. ``text``: what was no number, ``written``: dates or times of day turned into seconds.
    """

    name: str
    numbers: Array
    unit: str = ""
    time: Array | None = None
    epoch: float | None = None
    text: Text | None = None
    written: bool = False


class Table:
    """An opened log of several series. The time of those that have one follows as a column ``NAME.time``."""

    sha256: str | None = None
    doubt = ""

    def __init__(self, path: Path, series: Sequence[LogSeries], notes: Sequence[str] = ()) -> None:
        """Raises :class:`InputError` where there is no series."""
        if not series:
            raise InputError(f"{path}: found no series of numbers; expected at least one")
        self.notes = list(notes)
        timed = [(i, one.time) for i, one in enumerate(series) if one.time is not None]
        self.name = path.name
        self.columns = (*(one.name for one in series), *(f"{series[i].name}.time" for i, _ in timed))
        ends = tuple(name.rpartition(".")[2] for name in self.columns)
        self.others: tuple[tuple[str, ...], ...] = (ends,)
        self.units = (*(one.unit for one in series), *("s" for _ in timed))
        self._numbers = [*(one.numbers for one in series), *(time for _, time in timed)]
        self._stamps = {i: len(series) + k for k, (i, _) in enumerate(timed)}
        self._text = {i: one.text for i, one in enumerate(series) if one.text}
        self._written = frozenset(i for i, one in enumerate(series) if one.written)
        own = {i: one.epoch for i, one in enumerate(series) if one.epoch is not None}
        self._epochs = {self._stamps.get(i, i): epoch for i, epoch in own.items()}

    def stamps_of(self, column: int) -> int | None:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        return self._stamps.get(column)

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """Everything at once; the arrays are copies, since the reader may be asked again."""
        wanted = {*columns, *stamps}
        yield Chunk(
            {column: np.array(self._numbers[column]) for column in wanted},
            {column: text for column, text in self._text.items() if column in wanted},
            self._written & wanted,
            {column: epoch for column, epoch in self._epochs.items() if column in wanted},
        )
        progress(1.0)
