"""Names and units of columns, from the lines above the data: never shifted against the rows without saying so."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from hfanalysis.record.readers.marks import is_number
from hfanalysis.units import ALIASES, TABLE

_UNITS = {name for group in (TABLE, ALIASES) for names in group.values() for name in names if name} | {
    "V", "mV", "A", "mA", "counts", "raw", "bool", "°C", "°F", "datetime", "date", "hh:mm:ss", "n/a", "Volts", "volts",
    "TS", "RN",
}  # fmt: skip
NEARLY = 3
"""Fields that a row of names may have more or fewer than the rows of data and still be taken for one. Evidence:
test_headers.py: names of a log with row numbers, dates or a comma in a name are off by one or two."""

Row = Sequence[str]


@dataclass(frozen=True)
class Header:
    """``names`` and ``units`` by column, "" where there is none; ``others``: further rows of names; ``doubt``: why the
    names that are there cannot be told to belong to which columns.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    others: tuple[tuple[str, ...], ...] = ()
    doubt: str = ""


def read_header(rows: Sequence[Row], width: int, empty: int = 0) -> Header:
    """The header above data of ``width`` columns, the last ``empty`` of which hold nothing."""
    near = [list(row) for row in rows if any(row) and abs(len(row) - width) <= max(NEARLY, width // 4)]
    units = next((row for row in near if _is_units(row)), [])
    before_units = near[: near.index(units)] if units in near else []
    named = [_without_mark(row, width) for row in near if row is not units and not _is_kinds(row)]
    named = [row for row in named if not all(is_number(cell) for cell in row if cell)]
    fitting = [fitted for row in named if (fitted := _fitted(row, width, empty)) is not None]
    beside = _fitted(before_units[-1], width, empty) if before_units else None
    primary = _primary(fitting, beside)
    units_fitted = _padded(_aligned(units, width), width)
    if primary is None and named:
        return Header(("",) * width, ("",) * width, (), _doubt(named[-1], width))
    if primary is None:
        primary, units_fitted = (units_fitted, ("",) * width) if units else (("",) * width, ("",) * width)
    others = tuple(row for row in fitting if row is not primary)
    ends = tuple(name.rpartition(", ")[2] for name in primary)
    return Header(primary, units_fitted, others if ends == primary else (*others, ends))


def _primary(rows: Sequence[tuple[str, ...]], beside: tuple[str, ...] | None) -> tuple[str, ...] | None:
    """The row that names most columns, each by its own name and by no number; among such the one above the units, else
    the last.
    """

    def merit(place: int) -> tuple[bool, int, bool, int]:
        row = rows[place]
        words = not any(cell[:1].isdigit() or is_number(cell) for cell in row)
        return words, len({cell for cell in row if cell}), row == beside, place

    return rows[max(range(len(rows)), key=merit)] if rows else None


def _doubt(names: Row, width: int) -> str:
    shown = ", ".join(map(repr, names[:8])) + (", ..." if len(names) > 8 else "")
    return (
        f"the row of names has {len(names)} fields ({shown}) and the rows of data have {width}: which names which "
        "column cannot be told; expected columns by number, or a header with a name for each (in quotes where a name "
        "holds the mark between columns)"
    )


def _fitted(row: Row, width: int, empty: int) -> tuple[str, ...] | None:
    """The row by column; None where it is longer or shorter, and not by empty fields at its end or the data's."""
    last = max((i + 1 for i, cell in enumerate(row) if cell), default=0)
    if last > width or len(row) < width - empty:
        return None
    if len(row) > width and last < width and row[0] == "":
        return tuple(row[len(row) - width :])
    return _padded(row[:width], width)


def _without_mark(row: Row, width: int) -> list[str]:
    """Names without a mark of comment, which may stand in a field of its own."""
    names = list(row)
    if names[0][:1] in ("#", "%") and len(names[0]) > 1 and len(names) <= width:
        return [names[0].lstrip("#% "), *names[1:]]
    if len(names) == width + 1 and not names[0].strip("#% ") and names[-1]:
        return names[1:]
    return names


def _is_units(row: Row) -> bool:
    filled = [cell.strip("[]() ") for cell in row if cell.strip("[]() #%-")]
    return bool(filled) and 3 * sum(cell in _UNITS for cell in filled) >= 2 * len(filled)


def _is_kinds(row: Row) -> bool:
    """Whether a row says how each value came to be ("Smp", "Avg") and so tells no two columns apart."""
    filled = [cell for cell in row if cell]
    return len(filled) > 2 and len(set(filled)) == 1 and not is_number(filled[0])


def _aligned(units: Row, width: int) -> Row:
    """A units row one field longer than the columns, by the end where its spare empty field is."""
    if len(units) == width + 1 and not units[0]:
        return units[1:]
    return units[:width]


def _padded(cells: Row, width: int) -> tuple[str, ...]:
    return tuple(cells) + ("",) * (width - len(cells))


def by_wide_blanks(line: str) -> list[str]:
    """Names between which are tabs or several blanks, so that they may hold one."""
    return [name.strip('" ') for name in re.split(r"\t| {2,}", line.strip()) if name.strip()]


def joined(fields: Row, width: int) -> Row:
    """Fields some of which begin with a blank while others do not, put together where that gives ``width``: a comma
    with a blank behind it stands inside a name.
    """
    parts: list[str] = []
    for field in fields:
        if parts and field[:1] == " ":
            parts[-1] += f",{field}"
        else:
            parts.append(field)
    return parts if len(parts) == width != len(fields) else fields
