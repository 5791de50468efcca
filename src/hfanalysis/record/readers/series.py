"""Series of a table out of values of any kind: numbers, words for them, stamps; rows of cells with a header."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.readers import cells
from hfanalysis.record.readers.dialect import first_row
from hfanalysis.record.readers.header import read_header
from hfanalysis.record.readers.stamps import StampParser
from hfanalysis.record.readers.table import LogSeries


def series(name: str, values: Sequence[Any], unit: str = "") -> LogSeries | None:
    """Values as a series; dates and times of day become seconds. None where they are neither these nor numbers."""
    if all(value is None or isinstance(value, (int, float)) for value in values):
        numbers = np.array([math.nan if value is None else float(value) for value in values])
        return LogSeries(name, numbers, unit)
    return _from_text(name, [_written(value) for value in values], unit)


def _from_text(name: str, values: Sequence[str], unit: str) -> LogSeries | None:
    import pyarrow as pa

    text = pa.array(values, pa.string())
    numbers = cells.numbers(text, ".")
    filled = sum(bool(value.strip()) for value in values)
    if 2 * np.isfinite(numbers).sum() >= filled:
        return LogSeries(name, numbers, unit, text=cells.text_among(text, numbers, range(1, len(values) + 1)))
    parser = StampParser()
    seconds = parser.seconds(text)
    if 2 * np.isfinite(seconds).sum() < filled:
        return None
    return LogSeries(name, seconds, "", epoch=parser.epoch, written=True)


def _written(value: Any) -> str:
    """A cell as text."""
    if value is None:
        return ""
    if isinstance(value, datetime.timedelta):
        return repr(value.total_seconds())
    if isinstance(value, (datetime.datetime, datetime.date, datetime.time)):
        return value.isoformat(" ") if isinstance(value, datetime.datetime) else value.isoformat()
    return repr(value) if isinstance(value, float) else str(value).strip()


def seconds_of(instants: Array) -> tuple[Array, float]:
    """Instants (n,) of numpy in seconds since midnight of the first's day, and that midnight [s since 1970]."""
    known = instants[~np.isnat(instants)]
    midnight = (known[0] if len(known) else np.datetime64(0, "s")).astype("M8[D]")
    seconds = np.asarray((instants - midnight) / np.timedelta64(1, "ns"), dtype=np.float64) * 1e-9
    return seconds, float((midnight - np.datetime64(0, "D")) / np.timedelta64(1, "s"))


def from_rows(rows: Sequence[Sequence[Any]], prefix: str = "") -> Iterator[LogSeries]:
    """The series of rows of cells, names in the rows above the numbers; columns without one by number."""
    text = [[_written(value) for value in row] for row in rows]
    width = max((len(row) for row in text), default=0)
    text = [[*row, *[""] * (width - len(row))] for row in text]
    first = first_row(text)
    if first >= len(text):
        return
    header = read_header(text[:first], width)
    for i in range(width):
        values = [row[i] if i < len(row) else None for row in rows[first:]]
        if any(value not in (None, "") for value in values):
            name = header.names[i] or f"column {i + 1}"
            found = series(f"{prefix}{name}", [None if value == "" else value for value in values], header.units[i])
            if found is not None:
                yield found


def records(rows: Sequence[dict[str, Any]], prefix: str = "") -> Iterator[LogSeries]:
    """The series of records, by the keys of any of them; of nested ones ``KEY.KEY``."""
    flat = [_flat(row) for row in rows]
    for key in dict.fromkeys(key for row in flat for key in row):
        found = series(f"{prefix}{key}", [row.get(key) for row in flat])
        if found is not None and np.isfinite(found.numbers).any():
            yield found


def _flat(record: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, dict):
            found.update({f"{key}.{inner}": one for inner, one in _flat(value).items()})
        elif isinstance(value, (list, tuple)):
            found.update({f"{key}.{i}": one for i, one in enumerate(value, start=1)})
        else:
            found[key] = value
    return found
