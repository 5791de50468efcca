"""Parquet, Feather and Arrow files: columns by their names, instants in seconds."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.series import seconds_of, series
from hfanalysis.record.readers.table import LogSeries, Table

if TYPE_CHECKING:
    import pyarrow as pa


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's columns; raises :class:`InputError` where it cannot be read."""
    try:
        table = _table(path)
        table.validate(full=True)  # else places outside of the file are followed
        found = list(_series(table))
    except Exception as error:  # damaged files fail in every way that there is
        said = str(error).partition("\n")[0] or type(error).__name__
        raise InputError(f"{path}: cannot be read as a Parquet or Arrow file: {said}") from None
    return Table(path, found)


def _table(path: Path) -> pa.Table:
    with path.open("rb") as file:
        parquet = file.read(4) == b"PAR1"
    if parquet:
        from pyarrow import parquet as reader

        return reader.ParquetFile(path).read()
    from pyarrow import feather

    return feather.read_table(path, memory_map=False)


def _series(table: pa.Table) -> Iterator[LogSeries]:
    import pyarrow as pa

    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if pa.types.is_timestamp(kind):
            seconds, epoch = seconds_of(column.cast(pa.timestamp("ns")).to_numpy())
            yield LogSeries(name, seconds, "s", epoch=epoch, written=True)
        elif pa.types.is_duration(kind):
            yield LogSeries(name, _numbers(column.cast(pa.duration("ns")).cast(pa.int64())) * 1e-9, "s")
        elif pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind):
            yield LogSeries(name, _numbers(column))
        elif pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_time(kind):
            found = series(name, column.to_pylist())
            yield from [found] if found is not None else []


def _numbers(column: Any) -> Any:
    import pyarrow as pa

    if pa.types.is_boolean(column.type):
        column = column.cast(pa.uint8())
    return np.array(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)
