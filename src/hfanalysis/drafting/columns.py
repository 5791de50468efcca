"""The columns of the logs, with their numbers: as many as it takes to see what they do."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.drafting.labels import taken_apart
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import Source, Text, open_log
from hfanalysis.record.readers.base import tidy

MOST = 50_000
"""[samples] of a column that are kept. Evidence: a burn of two seconds in a log of an hour still has 28 of them."""


@dataclass(frozen=True)
class Column:
    """A column of a log.

    ``number`` counts from 1; ``label`` is what the log calls it, ``name`` and ``unit`` its parts. ``values`` (n,) are
    every ``stride``-th of its ``samples``, in the log's unit, NaN where there is no number; ``least`` and ``largest``
    are of all of them. ``text``: the first cell that is no number, "" where all are. ``written``: stamps written as
    dates or times of day, here in seconds. ``stamps``: the number of the column that the format itself gives as its
    time, None where it gives none. ``alone``: no other column has its label.
    """

    file: str
    number: int
    label: str
    name: str
    unit: str
    values: Array
    samples: int
    stride: int = 1
    least: float = np.nan
    largest: float = np.nan
    text: str = ""
    written: bool = False
    stamps: int | None = None
    alone: bool = True

    @property
    def shown(self) -> str:
        """What people call it: its label on one line, or its number."""
        return tidy(self.label) or f"column {self.number}"

    @property
    def key(self) -> str | int:
        """How test.toml names it: by its label where that is one column's and nothing but letters that can be seen."""
        plain = tidy(self.label)
        return plain if plain and self.alone and plain.isprintable() else self.number

    @property
    def good(self) -> Array:
        """The finite ones of its values (k,)."""
        return self.values[np.isfinite(self.values)]


@dataclass(frozen=True)
class LogFile:
    """A log file and its columns."""

    path: Path
    columns: tuple[Column, ...]

    @property
    def name(self) -> str:
        return self.path.name

    def numbered(self, number: int) -> Column:
        """The column of a number from 1."""
        return self.columns[number - 1]


@dataclass
class _Kept:
    """Numbers of a column on their way: thinned evenly as they become too many."""

    parts: list[Array] = field(default_factory=list)
    samples: int = 0
    stride: int = 1
    least: float = np.nan
    largest: float = np.nan

    def add(self, part: Array) -> None:
        first = -self.samples % self.stride
        self.parts.append(np.array(part[first :: self.stride]))
        self.samples += len(part)
        good = part[np.isfinite(part)]
        if good.size:
            self.least = float(np.fmin(self.least, good.min()))
            self.largest = float(np.fmax(self.largest, good.max()))
        while sum(map(len, self.parts)) > MOST:
            self.parts = [np.concatenate(self.parts)[::2]]
            self.stride *= 2

    @property
    def values(self) -> Array:
        return np.concatenate([np.empty(0), *self.parts])


def read_log_file(path: Path) -> LogFile:
    """A log file with its columns; raises :class:`InputError` where it is no log or holds not one number."""
    source = open_log(path, FileSpec(path.name))
    kept, texts, written = _numbers(source)
    labels = [tidy(label) for label in source.columns]
    columns = tuple(
        _column(source, i, kept[i], texts.get(i), i in written, labels.count(labels[i]) == 1)
        for i in range(len(source.columns))
    )
    if not any(column.good.size for column in columns):
        raise InputError(f"{path}: found no column of numbers; expected a log")
    return LogFile(path, columns)


def _numbers(source: Source) -> tuple[list[_Kept], dict[int, Text], set[int]]:
    """All columns, each as if it held stamps, so that dates and times of day become seconds."""
    every = range(len(source.columns))
    kept, texts, written = [_Kept() for _ in every], dict[int, Text](), set[int]()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about text that is neither: it is looked at, not believed
        for chunk in source.chunks(every, every, lambda share: None):
            for i, part in chunk.columns.items():
                kept[i].add(part)
            texts = {**chunk.text, **texts}
            written |= chunk.written
    return kept, texts, written


def _column(source: Source, i: int, kept: _Kept, text: Text | None, written: bool, alone: bool) -> Column:
    label = source.columns[i]
    name, unit = taken_apart(tidy(label), source.units[i] if i < len(source.units) else "")
    stamps, values = source.stamps_of(i), kept.values
    return Column(
        source.name, i + 1, label, name, unit, values, kept.samples, kept.stride, kept.least, kept.largest,
        text.first if text else "", written and bool(np.isfinite(values).any()),
        None if stamps is None else stamps + 1, alone,
    )  # fmt: skip


def read_log_files(paths: Sequence[Path]) -> tuple[LogFile, ...]:
    """Several log files; raises :class:`InputError` as :func:`read_log_file`."""
    return tuple(read_log_file(path) for path in paths)


def every(files: Sequence[LogFile]) -> Iterator[Column]:
    """The columns of all files, in order."""
    for file in files:
        yield from file.columns
