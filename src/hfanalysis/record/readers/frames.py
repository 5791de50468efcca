"""Delimited text with more in it than plain numbers, by pandas' C parser (imported only where it is needed)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.readers.base import Chunk, Text
from hfanalysis.record.readers.dialect import WHITESPACE, Dialect
from hfanalysis.record.readers.stamps import StampParser

if TYPE_CHECKING:
    import pandas as pd


def read(file: Any, about: Dialect, wanted: Sequence[int], **how: Any) -> Any:
    """The wanted columns of an open file as a frame, or as an iterator of frames where ``chunksize`` is given."""
    import pandas as pd

    return pd.read_csv(
        file,
        sep=r"\s+" if about.delimiter == WHITESPACE else about.delimiter,
        header=None,
        names=list(range(about.width)),
        usecols=list(wanted),
        index_col=False,
        decimal=about.decimal,
        encoding=about.encoding,
        encoding_errors="replace",
        skipinitialspace=True,
        low_memory=False,
        engine="c",
        **how,
    )


def chunk(frame: pd.DataFrame, parsers: Mapping[int, StampParser], decimal: str, line: int) -> Chunk:
    """The frame's numbers; stamps in words become seconds; ``line`` is the first row's in the file."""
    columns: dict[int, Array] = {}
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


def _mostly_text(numbers: Array, cells: pd.Series[Any]) -> bool:
    return bool(np.isnan(numbers).sum() * 2 > cells.notna().sum())


def _numbers(cells: pd.Series[Any], decimal: str) -> Array:
    """The numbers among cells some of which are text, NaN for the others."""
    import pandas as pd

    strings = cells.where(cells.isna(), cells.astype(str))
    plain = strings.str.replace(",", ".") if decimal == "," else strings
    return np.array(pd.to_numeric(plain, errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan))
