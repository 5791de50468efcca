"""How a delimited text file is written: encoding, delimiter, number marks, header, found from parts of it."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import fixed_width, marks
from hfanalysis.record.readers.encodings import SAMPLE, encoding_of, samples
from hfanalysis.record.readers.header import Header, by_wide_blanks, joined, read_header
from hfanalysis.record.readers.marks import is_number, is_spaced

WHITESPACE = " "
_DELIMITERS = (",", ";", "\t", "|", WHITESPACE)
_DATE = r"(\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}|\d{1,2}[- ][A-Za-z]{3,9}[- ]\d{2,4})"
_TIME_OF_DAY = r"\d{1,3}:\d{2}(:\d{2})?([.,:]\d+)?( ?[AaPp]\.?[Mm]\.?)?"
_STAMP = re.compile(rf"({_DATE}[T ]?)?({_TIME_OF_DAY})?(Z|[+-]\d\d:?\d\d)?")
_ARROW = re.compile(r"^\[?(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)\]? ?-> ?", re.MULTILINE)
"""What a serial monitor puts before a line."""
_LABEL = re.compile(r"(^|[,;\t| ])\s*([A-Za-z_][\w ]*?)\s*[:=]\s*(?=[-+.\d])", re.MULTILINE)
"""What a plotter's line has before each number."""
COMMENT = ("#", "%", "//", "!")
"""How lines begin that are no rows."""
USUAL = 0.05
"""Share of the rows that a shorter row must have for it to be one whose last cells are left out. Evidence:
test_dirt.py: rows broken by a lost byte are rarer, and cutting them would shift what follows."""
LONGEST_HEADER = 40
"""Lines over which a row of names may run that are broken inside quotes. Evidence: test_headers.py: each of a row's
names may be broken, so that there are as many lines as columns."""
ENOUGH = 300
"""Rows, spread over the parts of the file that are looked at, whose cells are asked for the marks of numbers.
Evidence: test_number_marks.py."""

Substitution = tuple[re.Pattern[str], str]


@dataclass(frozen=True)
class Dialect:
    """How the file is written. ``first``: lines before the data; ``width``: fields in a row of data; ``shorter``: other
    widths that rows have whose last cells are left out; ``replaced``: what is not plain, and what it becomes;
    ``edges``: places between columns of fixed width, none where marks are between them; ``stamped``: columns of dates
    or times.
    """

    encoding: str
    delimiter: str
    decimal: str
    first: int
    width: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    others: tuple[tuple[str, ...], ...] = ()
    doubt: str = ""
    shorter: frozenset[int] = frozenset()
    replaced: tuple[Substitution, ...] = ()
    edges: tuple[int, ...] = ()
    stamped: frozenset[int] = frozenset()


def detect(path: Path, spec: FileSpec) -> Dialect:
    """The dialect of a file, where ``spec`` does not force it; raises :class:`InputError` for a file without data."""
    with path.open("rb") as file:
        encoding = spec.encoding or encoding_of(file.read(SAMPLE))
    parts = samples(path, encoding)
    if not any(part.strip("\0\r\n\t ,;") for part in parts):
        raise InputError(f"{path}: found an empty file; expected a log")
    substitutions, labels = _substitutions(parts)
    parts = [substituted(part, substitutions) for part in parts]
    lines = [line for part in parts for line in logical_lines(part)]
    delimiter = spec.delimiter or _delimiter([line.text for line in lines])
    if delimiter not in (WHITESPACE, "\t") and any(marks.BLANK_BETWEEN[0].search(part) for part in parts):
        substitutions.append(marks.BLANK_BETWEEN)
        lines = [line.replaced(*marks.BLANK_BETWEEN) for line in lines]
    return _described(path, spec, encoding, delimiter, tuple(substitutions), lines, labels)


@dataclass(frozen=True)
class Line:
    """A line of text, several of the file's where a quoted name is broken; ``end``: lines of the file up to its end."""

    text: str
    end: int

    def replaced(self, mark: re.Pattern[str], by: str) -> Line:
        return Line(mark.sub(by, self.text), self.end)


def logical_lines(text: str) -> list[Line]:
    """The lines of a text, those inside a pair of quotes put together."""
    plain = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    found, at = [], 0
    while at < len(plain):
        count = next((n for n in range(1, LONGEST_HEADER) if _is_closed(plain[at : at + n])), 1)
        found.append(Line(" ".join(plain[at : at + count]), at + count))
        at += count
    return found


def _is_closed(lines: Sequence[str]) -> bool:
    return sum(line.count('"') for line in lines) % 2 == 0


def substituted(text: str, substitutions: Sequence[Substitution]) -> str:
    """The text with what is not plain replaced."""
    for mark, by in substitutions:
        text = mark.sub(by, text)
    return text


def _substitutions(parts: Sequence[str]) -> tuple[list[Substitution], list[str]]:
    """What is to be replaced in the file; and the names that stand in every line before the numbers."""
    found = marks.replaced("\n".join(parts))
    head = substituted(parts[0], found)
    lines = [line for line in head.splitlines() if line.strip()][:ENOUGH]
    if lines and 2 * sum(_ARROW.match(line) is not None for line in lines) > len(lines):
        rest = _ARROW.sub("", head)
        mark = _delimiter(rest.splitlines()[1:])
        found.append((_ARROW, rf"\1{mark}"))
        lines = [line for line in _ARROW.sub("", head).splitlines() if line.strip()][:ENOUGH]
    labels = Counter(tuple(name for _, name in _LABEL.findall(line)) for line in lines)
    names, times = labels.most_common(1)[0] if labels else ((), 0)
    if len(names) > 1 and 10 * times > 9 * len(lines):
        found.append((_LABEL, r"\1"))
        return found, list(names)
    return found, []


def _described(
    path: Path, spec: FileSpec, encoding: str, delimiter: str, replaced: tuple[Substitution, ...],
    lines: Sequence[Line], labels: Sequence[str],
) -> Dialect:  # fmt: skip
    rows = [split(line.text, delimiter) for line in lines]
    begin = first_row(rows) if spec.header_rows is None else spec.header_rows
    first = spec.header_rows if spec.header_rows is not None else (lines[begin - 1].end if begin else 0)
    data = [(line.text, row) for line, row in zip(lines[begin:], rows[begin:], strict=True) if any(row)]
    if not data:
        raise InputError(f"{path}: found {first} header lines and no data; expected numbers below the header")
    edges = fixed_width.edges([text for text, _ in data]) if delimiter == WHITESPACE and not spec.delimiter else ()
    if edges:
        rows = [fixed_width.cut(line.text, edges) for line in lines]
        data = [(text, fixed_width.cut(text, edges)) for text, _ in data]
    width, shorter = _widths([row for _, row in data], max((len(row) for row in rows[:begin]), default=0))
    whole = [row for _, row in data if len(row) == width]
    empty = _empty_at_end(whole, width)
    over = zip(lines[:begin], rows[:begin], strict=True)
    above = [_header_row(line.text, row, delimiter, width) for line, row in over]
    header = read_header(above, width, empty) if not labels else _labeled(labels, width)
    if delimiter == WHITESPACE and shorter:
        raise InputError(_ragged(path, width, shorter))
    some = whole[:: max(1, len(whole) // ENOUGH)]
    columns = [[row[i] for row in some] for i in range(width)]
    decimal = spec.decimal or marks.decimal_mark(columns, str(path))
    stamped = frozenset(i for i, cells in enumerate(columns) if _is_stamped(cells))
    return Dialect(
        encoding, delimiter, decimal, first, width, header.names, header.units, header.others, header.doubt, shorter,
        replaced, edges, stamped,
    )  # fmt: skip


def _ragged(path: Path, width: int, shorter: frozenset[int]) -> str:
    fewer = " or ".join(map(str, sorted(shorter)))
    return (
        f"{path}: rows have {width} columns or {fewer} with blanks between them: which cells are empty cannot be told; "
        "expected a log exported with commas, semicolons or tabs"
    )


def _labeled(labels: Sequence[str], width: int) -> Header:
    """The header of lines that name their numbers; what stands before them has no name."""
    names = ("",) * (width - len(labels)) + tuple(labels)
    return Header(names[-width:], ("",) * width)


def _header_row(line: str, row: Sequence[str], delimiter: str, width: int) -> Sequence[str]:
    """A row above the data, names that hold the mark between columns put together."""
    if len(row) == width:
        return row
    if delimiter == WHITESPACE:
        wide = by_wide_blanks(line)
        return wide if len(wide) == width else row
    parts = joined(line.split(delimiter), width) if '"' not in line else row
    return [part.strip() for part in parts]


def split(line: str, delimiter: str) -> list[str]:
    """The fields of a line, quotes and blanks around them removed."""
    if delimiter == WHITESPACE:
        return [field.strip('"') for field in re.findall(r'"[^"]*"|[^\s"]+', line)]
    try:
        fields = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:
        fields = line.split(delimiter)
    return [field.strip(" \t\0\x0c") for field in fields]


def _is_datum(field: str) -> bool:
    return is_number(field) or is_spaced(field) or (any(c.isdigit() for c in field) and bool(_STAMP.fullmatch(field)))


def _delimiter(lines: Sequence[str]) -> str:
    """The mark that cuts the last lines into the most consistent rows of numbers."""
    tail = [line for line in lines if any(c.isdigit() for c in line)][-60:]
    return max(_DELIMITERS, key=lambda mark: _merit(tail, mark))


def _merit(lines: Sequence[str], mark: str) -> tuple[bool, float]:
    rows = [split(line, mark) for line in lines]
    width, times = Counter(len(row) for row in rows).most_common(1)[0] if rows else (0, 0)
    cells = [cell for row in rows for cell in row if cell]
    numeric = sum(map(_is_datum, cells)) / max(len(cells), 1)
    return width > 1 and numeric > 0, round(numeric * times / max(len(rows), 1), 2)


def first_row(rows: Sequence[Sequence[str]]) -> int:
    """The lines before the data: up to the first two rows in a row, blank ones aside, that are mostly numbers (or the
    last row).
    """
    widths = Counter(len(row) for row in rows if any(row))
    width = widths.most_common(1)[0][0] if widths else 0
    before = None
    for i, row in enumerate(rows):
        if not any(row):
            continue
        looks = _is_data(row, width)
        if looks and before is not None:
            return before
        before = i if looks else None
    return len(rows) if before is None else before


def _is_data(row: Sequence[str], width: int) -> bool:
    filled = [cell for cell in row if cell]
    data = sum(map(_is_datum, filled))
    return data > 0 and 2 * data >= len(filled) and 2 * len(row) >= width


def _widths(rows: Sequence[Sequence[str]], named: int) -> tuple[int, frozenset[int]]:
    """The fields of a whole row, and the widths of rows whose last cells are left out."""
    widths = Counter(len(row) for row in rows)
    usual = widths.most_common(1)[0][0]
    often = {width for width, times in widths.items() if times > USUAL * len(rows)}
    width = named if named > usual and named in widths else max((w for w in often if w >= usual), default=usual)
    return width, frozenset(w for w in often if 1 < w < width)


def _empty_at_end(rows: Sequence[Sequence[str]], width: int) -> int:
    """Columns at the end that hold nothing in any row."""
    filled = max((i + 1 for row in rows for i, cell in enumerate(row) if cell), default=width)
    return width - filled


def _is_stamped(cells: Sequence[str]) -> bool:
    filled = [cell for cell in cells if cell]
    return bool(filled) and 2 * sum(not is_number(cell) and _is_datum(cell) for cell in filled) > len(filled)
