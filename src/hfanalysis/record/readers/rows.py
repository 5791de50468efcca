"""Lines that are whole rows, and those that are none: a footer, a header again, a row broken or cut off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from hfanalysis.record.readers import fixed_width
from hfanalysis.record.readers.dialect import COMMENT, WHITESPACE, Dialect, split

SHOWN = 60
"""Characters of a line that a message shows. Evidence: it stays one line."""


@dataclass
class LeftOut:
    """Lines that are no rows: how many, and the first of them."""

    width: int
    count: int = 0
    cut: int = 0
    """Of these, broken rows: with numbers in them."""
    first: str = ""
    line: int = 0

    def add(self, text: str, line: int) -> None:
        """One more."""
        if not self.count:
            self.first, self.line = text.strip()[:SHOWN], line
        self.count += 1
        self.cut += any(c.isdigit() for c in text)

    def notes(self, where: str) -> list[str]:
        """What is to be said about them."""
        if not self.count:
            return []
        many = f"{self.count} lines that are no rows of {self.width} fields are" if self.count > 1 else (
            f"1 line that is no row of {self.width} fields is"
        )  # fmt: skip
        return [f"{where}: {many} left out: line {self.line}, {self.first!r}"]


@dataclass
class Rows:
    """Rows of text of one width, and the line of the file that each is in."""

    cells: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


def rows_of(text: bytes, about: Dialect, line: int, left_out: LeftOut) -> Rows:
    """The whole rows of some lines of UTF-8, the first of which is line ``line`` of the file; what is none is noted."""
    found = Rows()
    for number, written in enumerate(text.splitlines(), start=line):
        bare = written.strip(b"\0\x0c\x1a\r\xff").decode("utf-8", errors="replace")
        if not _holds_something(bare):
            continue
        cells = _cells(bare, about)
        if cells is None or _is_no_row(bare, cells, about):
            left_out.add(bare, number)
        else:
            found.cells.append(cells)
            found.lines.append(number)
    return found


def _holds_something(text: str) -> bool:
    """Anything but separators, or one character over and over."""
    bare = text.strip("\t,;| ")
    return bool(bare) and (len(set(bare)) > 1 or (bare.isalnum() and bare.isascii()))


def _cells(text: str, about: Dialect) -> list[str] | None:
    """The fields of a row, None where it has too few or too many."""
    if about.edges:
        cells = fixed_width.cut(text, about.edges)
        ends = about.edges[-1] < len(text)
        return cells if ends else None
    if text.count('"') % 2:
        return None
    cells = split(text, about.delimiter)
    if len(cells) > about.width and not any(cells[about.width :]):
        return cells[: about.width]
    if len(cells) in about.shorter:
        return cells + [""] * (about.width - len(cells))
    return cells if len(cells) == about.width else None


def _is_no_row(text: str, cells: Sequence[str], about: Dialect) -> bool:
    """A comment or the header again, in as many fields as a row has."""
    again = any(cells[0] and tuple(cells) == names for names in (about.names, *about.others))
    return again or text.startswith(COMMENT) or (about.delimiter == WHITESPACE and not any(c.isdigit() for c in text))


def without_cut_end(text: bytes, about: Dialect) -> tuple[bytes, bytes]:
    """The text up to its last end of line, and what follows; that belongs to it where it is a whole row.

    A last cell that has fewer decimals than the cells above it, which all have as many, may have been cut.
    """
    end = max(text.rfind(b"\n"), text.rfind(b"\r")) + 1
    above, last = text[:end], text[end:]
    if not last.strip() or not above.strip():
        return text, b""
    cells = _cells(last.decode("utf-8", errors="replace"), about)
    lines = [line.decode("utf-8", errors="replace") for line in above.splitlines()[-20:]]
    before = [row for row in (_cells(line, about) for line in lines) if row]
    if cells is None or not before or _is_cut(cells[-1], [row[-1] for row in before], about.decimal):
        return above, last
    return text + b"\n", b""


def _is_cut(cell: str, above: Sequence[str], decimal: str) -> bool:
    places = {len(other.partition(decimal)[2]) for other in above}
    return bool(above) and len(places) == 1 and len(cell.partition(decimal)[2]) < next(iter(places))
