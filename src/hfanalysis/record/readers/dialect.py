"""How a delimited text file is written: encoding, delimiter, decimal mark, header, found from its beginning."""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.units import ALIASES, TABLE

SAMPLE = 1 << 18
"""Bytes looked at."""
WHITESPACE = " "
_DELIMITERS = (",", ";", "\t", "|", WHITESPACE)
_BOMS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE)
_DECIMAL = re.compile(r"[+-]?\d*([.,])\d+([eE][+-]?\d+)?")
_DATE = r"\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}"
_TIME_OF_DAY = r"\d{1,2}:\d{2}(:\d{2})?([.,:]\d+)?( ?[AP]M)?"
_STAMP = re.compile(rf"({_DATE}[T ]?)?({_TIME_OF_DAY})?(Z|[+-]\d\d:?\d\d)?")
_UNITS = {name for group in (TABLE, ALIASES) for names in group.values() for name in names if name} | {
    "V", "mV", "A", "mA", "counts", "raw", "bool", "°C", "°F", "datetime", "date", "hh:mm:ss", "n/a", "Volts", "volts",
}  # fmt: skip


@dataclass(frozen=True)
class Dialect:
    """How the file is written. ``first``: lines before the data; ``width``: fields in a data line."""

    encoding: str
    delimiter: str
    decimal: str
    first: int
    width: int
    names: tuple[str, ...]
    units: tuple[str, ...]


def detect(path: Path, spec: FileSpec) -> Dialect:
    """The dialect of a file, where ``spec`` does not force it; raises :class:`InputError` for a file without data."""
    with path.open("rb") as file:
        sample = file.read(SAMPLE)
        whole = len(sample) < SAMPLE
    encoding = spec.encoding or encoding_of(sample)
    lines = _lines(sample, encoding, whole)
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: found an empty file; expected a log")
    delimiter = spec.delimiter or _delimiter(lines)
    rows = [split(line, delimiter) for line in lines]
    first = _first(rows) if spec.header_rows is None else spec.header_rows
    data = [row for row in rows[first:] if any(row)]
    if not data:
        raise InputError(f"{path}: found {first} header lines and no data; expected numbers below the header")
    width = Counter(len(row) for row in data).most_common(1)[0][0]
    names, units = _header(rows[:first], width)
    decimal = spec.decimal or _decimal(data, delimiter)
    return Dialect(encoding, delimiter, decimal, first, max(width, len(names)), names, units)


def split(line: str, delimiter: str) -> list[str]:
    """The fields of a line, quotes and blanks around them removed."""
    if delimiter == WHITESPACE:
        return [field.strip('"') for field in line.split()]
    fields = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    return [field.strip() for field in fields]


def is_number(field: str) -> bool:
    """Whether a field is a number, with either decimal mark."""
    return bool(_NUMBER.fullmatch(field))


def _is_datum(field: str) -> bool:
    return is_number(field) or (any(c.isdigit() for c in field) and bool(_STAMP.fullmatch(field)))


def encoding_of(sample: bytes) -> str:
    """The encoding of a text that begins like this."""
    for mark, name in _BOMS:
        if sample.startswith(mark):
            return name
    if b"\0" in sample[:2000]:
        return "utf-16-le" if sample[1:2000:2].count(0) > sample[0:2000:2].count(0) else "utf-16-be"
    try:
        sample[: sample.rfind(b"\n") + 1].decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _lines(sample: bytes, encoding: str, whole: bool) -> list[str]:
    text = sample.decode(encoding, errors="replace").removeprefix("\ufeff")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines if whole or len(lines) < 2 else lines[:-1]


def _delimiter(lines: Sequence[str]) -> str:
    """The mark that cuts the last lines into the most consistent rows of numbers."""
    tail = [line for line in lines if line.strip()][-60:]
    return max(_DELIMITERS, key=lambda mark: _merit(tail, mark))


def _merit(lines: Sequence[str], mark: str) -> tuple[bool, float]:
    rows = [split(line, mark) for line in lines]
    width, times = Counter(len(row) for row in rows).most_common(1)[0]
    cells = [cell for row in rows for cell in row if cell]
    numeric = sum(map(_is_datum, cells)) / max(len(cells), 1)
    return width > 1 and numeric > 0, round(numeric * times / len(rows), 2)


def _first(rows: Sequence[Sequence[str]]) -> int:
    """The number of lines before the data: up to the first two rows, blank ones aside, that are mostly numbers."""
    width = Counter(len(row) for row in rows if any(row)).most_common(1)[0][0]
    filled = [i for i, row in enumerate(rows) if any(row)]
    looks = [_is_data(rows[i], width) for i in filled]
    return next((i for i, two in zip(filled, _twice(looks), strict=True) if two), len(rows))


def _twice(looks: Sequence[bool]) -> list[bool]:
    """Which are true and followed by another, or last."""
    return [look and (k + 1 == len(looks) or looks[k + 1]) for k, look in enumerate(looks)]


def _is_data(row: Sequence[str], width: int) -> bool:
    filled = [cell for cell in row if cell]
    data = sum(map(_is_datum, filled))
    return data > 0 and 2 * data >= len(filled) and 2 * len(row) >= width


def _decimal(data: Sequence[Sequence[str]], delimiter: str) -> str:
    if delimiter == ",":
        quoted = [cell for row in data[:200] for cell in row if "," in cell]
        return "," if quoted and all(map(is_number, quoted)) else "."
    marks = Counter(m[1] for row in data[:200] for cell in row if (m := _DECIMAL.fullmatch(cell)))
    return "," if marks[","] > marks["."] else "."


def _header(rows: Sequence[Sequence[str]], width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units by column; a units row may stand before or after the names and be a field longer or shorter."""
    fitting = [list(row) for row in rows if any(row) and abs(len(row) - width) <= max(1, width // 4)]
    units = next((row for row in fitting if _is_units(row)), [])
    named = [row for row in fitting if row is not units and not all(is_number(c) for c in row if c)]
    names = named[-1] if named else next((row for row in fitting if row is not units), [])
    if names and names[0][:1] in ("#", "%"):
        names = [names[0].lstrip("#% "), *names[1:]]
    if names and not names[0] and delimiter_artifact(names, width):
        names = names[1:]
    return _padded(names, width), _padded(_aligned(units, len(names)), width)


def delimiter_artifact(names: Sequence[str], width: int) -> bool:
    """Whether an empty first field is one too many (a comment mark set apart)."""
    return len(names) == width + 1 and bool(names[-1])


def _is_units(row: Sequence[str]) -> bool:
    filled = [cell.strip("[]() ") for cell in row if cell.strip("[]() #%-")]
    return bool(filled) and 3 * sum(cell in _UNITS for cell in filled) >= 2 * len(filled)


def _aligned(units: Sequence[str], count: int) -> Sequence[str]:
    """A units row one field longer than the names, by the end where its spare empty field is."""
    if len(units) == count + 1 and not units[0]:
        return units[1:]
    return units


def _padded(cells: Sequence[str], width: int) -> tuple[str, ...]:
    return tuple(cells) + ("",) * (width - len(cells))
