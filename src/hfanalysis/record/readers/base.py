"""What a reader of a log format offers: column names, and the numbers of some columns in chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.units import near

Progress = Callable[[float], None]
"""Called now and then with the share of the file that has been read, 0 to 1."""


@dataclass(frozen=True)
class Text:
    """Cells that hold text where a number should be: how many, and the first with its line in the file."""

    count: int
    line: int
    first: str


@dataclass(frozen=True)
class Chunk:
    """A stretch of some columns: column (from 0) -> numbers, NaN where there is none; and the text met there."""

    columns: dict[int, Array]
    text: dict[int, Text] = field(default_factory=dict)
    written: frozenset[int] = frozenset()
    """Columns of stamps that are dates or times of day, given here in seconds."""
    epochs: dict[int, float] = field(default_factory=dict)
    """Column of stamps -> the instant of its zero [s since 1970, as written], where dates say so."""


class Source(Protocol):
    """An opened log file."""

    name: str
    columns: tuple[str, ...]
    """Column names in order; empty strings in a log without a header."""
    units: tuple[str, ...]
    """What the log itself says about units, by column; empty where it says nothing."""
    others: tuple[tuple[str, ...], ...]
    """Further rows of names, by which a column may be called, too."""
    doubt: str
    """Why the names that the log has cannot be told to belong to which columns; "" where they can."""
    notes: list[str]
    """What is to be said about the file once it has been read."""
    sha256: str | None
    """Of the file, where ``chunks`` has read it and taken the hash on the way."""

    def stamps_of(self, column: int) -> int | None:
        """The column of time stamps [s] that the format itself gives this column, None where it gives none."""

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """The numbers of ``columns``; those in ``stamps`` may be dates or times of day, which become seconds."""


def find_column(source: Source, wanted: str | int, where: str) -> int:
    """The column (from 0) that an engineer named, or counted from 1.

    Raises :class:`InputError` with near misses where the log has no such column, or several of that name.
    """
    if isinstance(wanted, int):
        if wanted > len(source.columns):
            raise InputError(f"{where}: column {wanted} not in {source.name}, which has {len(source.columns)} columns")
        return wanted - 1
    name = tidy(wanted)
    if source.doubt:
        raise InputError(f"{where}: column {wanted!r} of {source.name}: {source.doubt}")
    rows = (source.columns, *source.others)
    found = next((fits for row in rows if (fits := [i for i, cell in enumerate(row) if tidy(cell) == name])), [])
    if len(found) > 1:
        numbers = ", ".join(str(i + 1) for i in found)
        raise InputError(
            f"{where}: {source.name} has {len(found)} columns {wanted!r}; expected one's number: {numbers}"
        )
    if not found:
        raise InputError(f"{where}: column {wanted!r} not in {source.name}{_instead(wanted, source)}")
    return found[0]


def tidy(name: str) -> str:
    """A column's name without what cannot be seen."""
    return " ".join(name.replace("\ufeff", "").split())


def _instead(wanted: str, source: Source) -> str:
    named = [tidy(name) for name in source.columns if tidy(name)]
    if not named:
        return f", which has no header; expected a column's number from 1 to {len(source.columns)}"
    shown = ", ".join(map(repr, named[:30])) + (", ..." if len(named) > 30 else "")
    return near(wanted, named) or f"; it has {shown}"
