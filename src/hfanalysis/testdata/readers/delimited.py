"""Delimited text in any reasonable dialect, in chunks by pandas' C parser."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from hfanalysis.errors import InputError
from hfanalysis.testdata.logspec import FileSpec
from hfanalysis.testdata.readers.base import Chunk, Floats, Progress, Text
from hfanalysis.testdata.readers.dialect import WHITESPACE, Dialect, detect
from hfanalysis.testdata.readers.stamps import StampParser

CELLS = 2_000_000
"""Numbers in a chunk: 16 MB, and a few times that while it is parsed."""


@dataclass(frozen=True)
class Delimited:
    """An opened text log."""

    path: Path
    dialect: Dialect

    @property
    def name(self) -> str:
        return self.path.name

    @property
    def columns(self) -> tuple[str, ...]:
        return self.dialect.names

    @property
    def units(self) -> tuple[str, ...]:
        return self.dialect.units

    def stamps_of(self, column: int) -> int | None:
        """Text has no time but in its columns."""
        return None

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """See :class:`hfanalysis.testdata.readers.base.Source`."""
        wanted = sorted({*columns, *stamps})
        parsers = {column: StampParser() for column in stamps}
        line, size = self.dialect.first + 1, max(self.path.stat().st_size, 1)
        with self.path.open("rb") as file:
            for frame in self._frames(file, wanted):
                yield _chunk(frame, parsers, self.dialect.decimal, line)
                line += len(frame)
                progress(min(1.0, file.tell() / size))

    def _frames(self, file: Any, wanted: Sequence[int]) -> Iterator[pd.DataFrame]:
        about = self.dialect
        try:
            yield from pd.read_csv(
                file,
                sep=r"\s+" if about.delimiter == WHITESPACE else about.delimiter,
                header=None,
                names=list(range(about.width)),
                usecols=list(wanted),
                index_col=False,
                skiprows=about.first,
                decimal=about.decimal,
                encoding=about.encoding,
                encoding_errors="replace",
                skipinitialspace=True,
                chunksize=max(1, CELLS // max(about.width, 1)),
                low_memory=False,
                engine="c",
            )
        except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeError) as error:
            raise InputError(f"{self.path}: cannot be read as delimited text: {error}") from None


def open_source(path: Path, spec: FileSpec) -> Delimited:
    """The text log with its dialect found."""
    return Delimited(path, detect(path, spec))


def _chunk(frame: pd.DataFrame, parsers: dict[int, StampParser], decimal: str, line: int) -> Chunk:
    columns: dict[int, Floats] = {}
    text: dict[int, Text] = {}
    written: set[int] = set()
    for column, cells in ((int(str(name)), cells) for name, cells in frame.items()):
        if cells.dtype.kind in "fiub":
            columns[column] = cells.to_numpy(dtype=np.float64)
            continue
        columns[column] = _numbers(cells, decimal)
        if column in parsers and _mostly_text(columns[column], cells):
            columns[column] = parsers[column].seconds(cells)
            written.add(column)
        bad = np.flatnonzero(np.isnan(columns[column]) & cells.notna().to_numpy())
        if len(bad):
            text[column] = Text(len(bad), line + int(bad[0]), str(cells.iloc[bad[0]]))
    return Chunk(columns, text, frozenset(written))


def _mostly_text(numbers: Floats, cells: pd.Series[Any]) -> bool:
    return bool(np.isnan(numbers).sum() * 2 > cells.notna().sum())


def _numbers(cells: pd.Series[Any], decimal: str) -> Floats:
    """The numbers among cells some of which are text, NaN for the others."""
    strings = cells.where(cells.isna(), cells.astype(str))
    plain = strings.str.replace(",", ".") if decimal == "," else strings
    return np.array(pd.to_numeric(plain, errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan))
