"""LabVIEW's text measurement files (.lvm): a header that says how the tables below it are written.

``X_Columns``: ``One`` column of time for all channels, ``Multi``, one beside each, or ``No``; then a channel holds the
time, or the sample rate has to be stated (Delta_X in the header is known to be wrong in real files). A file may have
several segments, each with a header of its own: their times count from the segment's own Date and Time.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.delimited import Delimited
from hfanalysis.record.readers.dialect import Dialect
from hfanalysis.record.readers.encodings import SAMPLE, encoding_of
from hfanalysis.record.readers.stamps import StampParser
from hfanalysis.record.readers.table import LogSeries, Table

_MARKS = {"Tab": "\t", "Comma": ",", "Semicolon": ";"}
_NAMES = "X_Value"
"""With this begins the row of names."""
_SEGMENT = "Channels"
"""With this begins the header of a segment."""


def open_source(path: Path, spec: FileSpec) -> Delimited | Table:
    """The text log below its header; raises :class:`InputError` where there is none."""
    with path.open("rb") as file:
        sample = file.read(SAMPLE)
    encoding = spec.encoding or encoding_of(sample)
    lines = sample.decode(encoding, errors="replace").splitlines()
    row = next((i for i, line in enumerate(lines) if line.startswith(_NAMES)), None)
    if row is None or row + 1 >= len(lines):
        raise InputError(f"{path}: found no row that begins with {_NAMES!r} and data below it; expected a LabVIEW log")
    above, names = lines[:row], lines[row]
    mark = spec.delimiter or _MARKS.get(_stated(above, "Separator").strip(), "\t")
    columns = tuple(name.strip() for name in names.split(mark))
    decimal = spec.decimal or ("," if _stated(above, "Decimal_Separator")[:1] == "," else ".")
    clocks = _clocks(columns, _stated(above, "X_Columns").strip())
    if (b"\n" + _SEGMENT.encode() + mark.encode()) in sample[sample.find(_NAMES.encode()) :] or _again(path, sample):
        return _segments(path, encoding, mark, decimal, clocks)
    units = _units(above, mark, columns)
    shorter = frozenset({len(columns) - 1}) if columns[-1] == "Comment" else frozenset[int]()
    about = Dialect(encoding, mark, decimal, row + 1, len(columns), columns, units, shorter=shorter)
    return Delimited(path, about, clocks)


def _again(path: Path, sample: bytes) -> bool:
    """Whether a segment begins behind the part of a file that has been looked at."""
    with path.open("rb") as file:
        file.seek(len(sample))
        return any(line.startswith((_SEGMENT.encode(), _NAMES.encode())) for line in file)


@dataclass(frozen=True)
class _Segment:
    """A segment's header lines, names and rows of cells."""

    header: list[str]
    names: tuple[str, ...]
    rows: list[list[str]]


def _segments(path: Path, encoding: str, mark: str, decimal: str, clocks: dict[int, int]) -> Table:
    """All segments one after the other; a column's time counts from the first segment's date and time."""
    text = path.read_text(encoding=encoding, errors="replace")
    parts = _cut(text.splitlines(), mark)
    whole = [part for part in parts if part.rows]
    if not whole or any(part.names != whole[0].names for part in whole):
        raise InputError(f"{path}: its segments have different columns; expected one set of columns in a file")
    starts = [_start(part.header, mark) for part in whole]
    known = [start for start in starts if start is not None]
    first = min(known, default=0.0)
    midnight = first // 86400.0 * 86400.0
    names = whole[0].names
    units = _units(whole[0].header, mark, names)
    stacked: dict[int, list[Array]] = defaultdict(list)
    for part, start in zip(whole, starts, strict=True):
        for i in range(len(names)):
            numbers = np.array([_number(row[i] if i < len(row) else "", decimal) for row in part.rows])
            is_time = i in clocks.values()
            stacked[i].append(numbers + (start - midnight if is_time and start is not None else 0.0))
    notes = [_told(path, len(whole), None not in starts)]
    columns = {i: np.concatenate(stacked[i]) for i in stacked if names[i] != "Comment"}
    epoch = midnight if known else None
    stamps = set(clocks.values())
    found = [
        LogSeries(names[i], numbers, units[i], columns.get(clocks.get(i, -1)), epoch if i in clocks else None)
        for i, numbers in columns.items()
        if i not in stamps
    ]
    return Table(path, found, notes)


def _told(path: Path, count: int, dated: bool) -> str:
    how = "each at its own date and time" if dated else "not all with a date and time of their own"
    return f"{path.name}: {count} segments put one after the other, {how}"


def _cut(lines: Sequence[str], mark: str) -> list[_Segment]:
    """The segments of a file."""
    found: list[_Segment] = []
    header: list[str] = []
    rows: list[list[str]] | None = None
    for line in lines:
        if line.startswith(_NAMES):
            rows = []
            found.append(_Segment(header, tuple(name.strip() for name in line.split(mark)), rows))
            header = []
        elif line.startswith((_SEGMENT, "***")) or rows is None:
            rows = None
            header.append(line)
        elif line.strip():
            rows.append(line.split(mark))
    return found


def _start(header: Sequence[str], mark: str) -> float | None:
    """When a segment began [s since 1970]: its first channel's date and time."""
    import pyarrow as pa

    date, time = (_cells_of(header, key, mark) for key in ("Date", "Time"))
    if not date or not time:
        return None
    parser = StampParser()
    seconds = parser.seconds(pa.array([f"{date[0]} {time[0].replace(',', '.')}"], pa.string()))
    return float(seconds[0]) + parser.epoch if parser.epoch is not None and np.isfinite(seconds[0]) else None


def _cells_of(lines: Sequence[str], key: str, mark: str) -> list[str]:
    """The cells behind a key; of the last such line, which is the segment's own."""
    rows = [line.split(mark)[1:] for line in lines if line.split(mark)[0] == key]
    return [cell.strip() for cell in rows[-1] if cell.strip()] if rows else []


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.replace(decimal, "."))
    except ValueError:
        return float("nan")


def _stated(lines: Sequence[str], key: str) -> str:
    """What the header states behind a key and the separator."""
    return next((line[len(key) + 1 :] for line in lines if line.startswith(key)), "")


def _units(lines: Sequence[str], mark: str, names: Sequence[str]) -> tuple[str, ...]:
    """The units of the channels, in their order; columns of time are in seconds."""
    stated = next((line.split(mark)[1:] for line in lines if line.startswith("Y_Unit_Label")), [])
    units = iter(stated)
    return tuple("s" if name == _NAMES else next(units, "").strip() for name in names)


def _clocks(names: Sequence[str], kind: str) -> dict[int, int]:
    """Column -> column of its time stamps."""
    if kind not in ("One", "Multi"):
        return {}
    stamps = [i for i, name in enumerate(names) if name == _NAMES]
    before = {i: max((k for k in stamps if k < i), default=None) for i in range(len(names)) if i not in stamps}
    return {i: stamp for i, stamp in before.items() if stamp is not None}
