"""Delimited text in any reasonable dialect, in segments that are parsed side by side by pyarrow.

A segment of plain rows goes straight into numbers. Where one does not (text among numbers, marks between thousands, a
row too short), its lines are looked at one by one.
"""

from __future__ import annotations

import hashlib
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import cells
from hfanalysis.record.readers.base import Chunk, Progress, Text
from hfanalysis.record.readers.dialect import WHITESPACE, Dialect, detect
from hfanalysis.record.readers.encodings import in_utf8, whole_lines
from hfanalysis.record.readers.rows import LeftOut, rows_of, without_cut_end
from hfanalysis.record.readers.stamps import StampParser

if TYPE_CHECKING:
    import pyarrow as pa

SEGMENT = 1_000_000
"""Bytes of text parsed at a time [B]: large enough for threads to be worth it, small enough for the memory. Evidence:
benchmarks/ingest_1gb.py: ten times as much is no quicker."""
WORKERS = 2
"""Segments parsed at a time: bounds the memory. Evidence: benchmarks/ingest_1gb.py."""
BROKEN = 0.5
"""Share of lines that are no rows beyond which a file is not written as it seems. Evidence: test_dirt.py."""


@dataclass
class Segment:
    """Some columns of some lines: numbers, or text; ``lines``: the first row's, or each row's, in the file."""

    numbers: dict[int, Array]
    text: dict[int, Any]
    lines: Sequence[int]


@dataclass
class Delimited:
    """An opened text log."""

    path: Path
    dialect: Dialect
    clocks: Mapping[int, int] = field(default_factory=dict)
    """Column -> column of its time stamps, where the format says so."""
    sha256: str | None = field(default=None, init=False)
    left_out: LeftOut = field(init=False)

    def __post_init__(self) -> None:
        self.left_out = LeftOut(self.dialect.width)

    @property
    def name(self) -> str:
        return self.path.name

    @property
    def columns(self) -> tuple[str, ...]:
        return self.dialect.names

    @property
    def units(self) -> tuple[str, ...]:
        return self.dialect.units

    @property
    def others(self) -> tuple[tuple[str, ...], ...]:
        return self.dialect.others

    @property
    def doubt(self) -> str:
        return self.dialect.doubt

    @property
    def notes(self) -> list[str]:
        return self.left_out.notes(self.name)

    def stamps_of(self, column: int) -> int | None:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        return self.clocks.get(column)

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        parsers = {column: StampParser() for column in stamps}
        self.left_out, rows = LeftOut(self.dialect.width), 0
        size = max(self.path.stat().st_size, 1)
        with self.path.open("rb") as file:
            for segment in self._side_by_side(file, sorted({*columns, *stamps})):
                chunk = self._chunk(segment, parsers)
                rows += len(next(iter(chunk.columns.values()), ()))
                yield chunk
                progress(min(1.0, file.tell() / size))
        if self.left_out.cut > BROKEN * (rows + self.left_out.cut):
            raise InputError(self._unlike())

    def _unlike(self) -> str:
        out = self.left_out
        return (
            f"{self.path}: {out.count} of its lines are no rows of {out.width} fields, the first in line {out.line}: "
            f"{out.first!r}; expected rows of one width (or delimiter, header_rows in [log])"
        )

    def _side_by_side(self, file: IO[bytes], wanted: Sequence[int]) -> Iterator[Segment]:
        """Segments in order, the next ones at work; the file's hash is taken on the way."""
        waiting: deque[Future[tuple[Segment, LeftOut]]] = deque()
        digest, line = hashlib.sha256(), 1
        with ThreadPoolExecutor(WORKERS) as pool, ThreadPoolExecutor(1) as in_order:
            for text, is_last in _with_last(whole_lines(in_utf8(_read(file, digest, in_order), self.dialect.encoding))):
                body, line = _below(text, self.dialect.first, line)
                waiting.append(pool.submit(self._segment, body, wanted, line, is_last))
                line += _ends(body)
                if len(waiting) > WORKERS:
                    yield self._finished(waiting.popleft())
            while waiting:
                yield self._finished(waiting.popleft())
        self.sha256 = digest.hexdigest()

    def _finished(self, work: Future[tuple[Segment, LeftOut]]) -> Segment:
        segment, left_out = work.result()
        if left_out.count and not self.left_out.count:
            self.left_out.first, self.left_out.line = left_out.first, left_out.line
        self.left_out.count += left_out.count
        self.left_out.cut += left_out.cut
        return segment

    def _segment(self, text: bytes, wanted: Sequence[int], line: int, is_last: bool) -> tuple[Segment, LeftOut]:
        """The columns of some lines, the first of which is ``line`` of the file."""
        about, left_out = self.dialect, LeftOut(self.dialect.width)
        rest = b""
        if about.replaced:
            written = text.decode("utf-8", errors="replace")
            for mark, by in about.replaced:
                written = mark.sub(by, written)
            text = written.encode()
        if is_last and text[-1:] not in (b"\n", b"\r", b""):
            text, rest = without_cut_end(text, about)
        plain = self._plain(text, wanted, line) if about.delimiter != WHITESPACE else None
        if plain is None:
            plain = self._row_by_row(text, wanted, line, left_out)
        if rest.strip(b"\0\x1a\x0c\xff \r"):
            left_out.add(rest.decode("utf-8", errors="replace").strip("\0\x1a"), line + _ends(text))
        return plain, left_out

    def _plain(self, text: bytes, wanted: Sequence[int], line: int) -> Segment | None:
        """The numbers of rows all of which are plain and of one width; None where one is not."""
        import pyarrow as pa

        for width in (self.dialect.width, *sorted(self.dialect.shorter, reverse=True)):
            there = [c for c in wanted if c < width]
            try:
                table = _parsed(text, self.dialect, there, width)
            except (pa.ArrowInvalid, UnicodeError):
                continue
            words = {c: table.column(str(c)).combine_chunks() for c in there if c in self.dialect.stamped}
            numbers = {c: _filled(table.column(str(c))) for c in there if c not in self.dialect.stamped}
            numbers |= {c: np.full(table.num_rows, np.nan) for c in wanted if c >= width}
            return Segment(numbers, words, range(line, line + table.num_rows))
        return None

    def _row_by_row(self, text: bytes, wanted: Sequence[int], line: int, left_out: LeftOut) -> Segment:
        import pyarrow as pa

        rows = rows_of(text, self.dialect, line, left_out)
        return Segment({}, {c: pa.array([row[c] for row in rows.cells], pa.string()) for c in wanted}, rows.lines)

    def _chunk(self, segment: Segment, parsers: Mapping[int, StampParser]) -> Chunk:
        """The numbers of a segment; stamps in words become seconds."""
        columns, text = dict(segment.numbers), dict[int, Text]()
        written: set[int] = set()
        for column, found in segment.text.items():
            columns[column] = cells.numbers(found, self.dialect.decimal)
            if column in parsers and _mostly_text(columns[column], found):
                columns[column] = parsers[column].seconds(found)
                written.add(column)
            if (met := cells.text_among(found, columns[column], segment.lines)) is not None:
                text[column] = met
        epochs = {c: epoch for c in written if (epoch := parsers[c].epoch) is not None}
        return Chunk(columns, text, frozenset(written), epochs)


def _parsed(text: bytes, about: Dialect, wanted: Sequence[int], width: int) -> pa.Table:
    """The wanted columns by pyarrow, which rounds correctly; raises ArrowInvalid where a cell is no number."""
    import pyarrow as pa
    from pyarrow import csv

    kinds = {str(c): pa.string() if c in about.stamped else pa.float64() for c in wanted}
    return csv.read_csv(
        pa.py_buffer(text),
        csv.ReadOptions(use_threads=False, block_size=max(len(text), 1), column_names=list(map(str, range(width)))),
        csv.ParseOptions(delimiter=about.delimiter),
        csv.ConvertOptions(
            column_types=kinds, include_columns=list(kinds), decimal_point=about.decimal, strings_can_be_null=True
        ),
    )


def _filled(column: Any) -> Array:
    """The numbers (n,), NaN where a cell is empty. (pyarrow's own way to numpy loads pandas, for a quarter second.)"""
    whole = column.chunk(0) if column.num_chunks == 1 else column.combine_chunks()
    there, data = whole.buffers()
    numbers = np.frombuffer(data, np.float64, len(whole), 8 * whole.offset)
    if not whole.null_count:
        return numbers
    bits = np.unpackbits(np.frombuffer(there, np.uint8), bitorder="little")
    return np.where(bits[whole.offset : whole.offset + len(whole)], numbers, np.nan)


def _mostly_text(found: Array, text: Any) -> bool:
    return bool(2 * np.isnan(found).sum() > len(text) - text.null_count)


def _read(file: IO[bytes], digest: Any, in_order: ThreadPoolExecutor) -> Iterator[bytes]:
    """A file's bytes; their hash is taken meanwhile."""
    while block := file.read(SEGMENT):
        in_order.submit(digest.update, block)
        yield block


def _with_last(parts: Iterator[bytes]) -> Iterator[tuple[bytes, bool]]:
    """Every part, and whether it is the last."""
    before = next(parts, None)
    for part in parts:
        assert before is not None
        yield before, False
        before = part
    if before is not None:
        yield before, True


def _below(text: bytes, first: int, line: int) -> tuple[bytes, int]:
    """The text without those of its lines, the first of which is ``line``, that are before the data; its line."""
    mark, place = (b"\n" if b"\n" in text else b"\r"), 0
    while line <= first and place < len(text):
        end = text.find(mark, place)
        place, line = (len(text) if end < 0 else end + 1), line + 1
    return (text[place:] if place else text), line


def _ends(text: bytes) -> int:
    """The ends of lines in a text."""
    return text.count(b"\n") or text.count(b"\r")


def open_source(path: Path, spec: FileSpec) -> Delimited:
    """The text log with its dialect found."""
    return Delimited(path, detect(path, spec))
