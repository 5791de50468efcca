"""Delimited text in any reasonable dialect, in segments that are parsed side by side."""

from __future__ import annotations

import hashlib
import io
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import frames, plain_numbers
from hfanalysis.record.readers.base import Chunk, Progress
from hfanalysis.record.readers.dialect import WHITESPACE, Dialect, detect
from hfanalysis.record.readers.stamps import StampParser

SEGMENT = 1_000_000
"""Bytes of text parsed at a time [B]: small enough for memory to be used again rather than asked for anew."""
WORKERS = 2
"""Segments parsed at a time: bounds the memory."""
CHUNK = 20_000
"""Rows read at a time where text cannot be cut into segments."""


@dataclass
class Delimited:
    """An opened text log."""

    path: Path
    dialect: Dialect
    clocks: Mapping[int, int] = field(default_factory=dict)
    """Column -> column of its time stamps, where the format says so."""
    sha256: str | None = field(default=None, init=False)

    @property
    def name(self) -> str:
        return self.path.name

    @property
    def columns(self) -> tuple[str, ...]:
        return self.dialect.names

    @property
    def units(self) -> tuple[str, ...]:
        return self.dialect.units

    def stamps_of(self, column: int) -> int | None:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        return self.clocks.get(column)

    def chunks(self, columns: Sequence[int], stamps: Sequence[int], progress: Progress) -> Iterator[Chunk]:
        """See :class:`hfanalysis.record.readers.base.Source`."""
        parsers = {column: StampParser() for column in stamps}
        line, size = self.dialect.first + 1, max(self.path.stat().st_size, 1)
        with self.path.open("rb") as file:
            for part in self._parts(file, sorted({*columns, *stamps})):
                chunk = part if isinstance(part, Chunk) else frames.chunk(part, parsers, self.dialect.decimal, line)
                yield chunk
                line += len(next(iter(chunk.columns.values())))
                progress(min(1.0, file.tell() / size))

    def _parts(self, file: Any, wanted: Sequence[int]) -> Iterator[Any]:
        """Chunks, or frames where there is more than plain numbers."""
        try:
            if self._is_cuttable(file):
                yield from self._side_by_side(file, wanted)
            else:
                with self.path.open(encoding=self.dialect.encoding, errors="replace") as text:
                    for _ in range(self.dialect.first):
                        text.readline()
                    yield from frames.read(text, self.dialect, wanted, chunksize=CHUNK)
        except (ValueError, UnicodeError) as error:  # pandas' parser errors are ValueErrors
            raise InputError(f"{self.path}: cannot be read as delimited text: {error}") from None

    def _is_cuttable(self, file: Any) -> bool:
        """Read past the header; False, the file at its beginning, where lines cannot be told from bytes."""
        head = b"".join(file.readline() for _ in range(self.dialect.first + 1))
        file.seek(0)
        if self.dialect.encoding.startswith(("utf-16", "utf-32")) or b"\r" in head.replace(b"\r\n", b""):
            return False
        for _ in range(self.dialect.first):
            file.readline()
        return True

    def _side_by_side(self, file: Any, wanted: Sequence[int]) -> Iterator[Any]:
        """Segments in order, the next ones at work. (Letting pandas skip rows and chunk would be half as fast.)

        The file's hash is taken on the way, which spares reading it again.
        """
        waiting: deque[tuple[Future[Any], Future[None]]] = deque()
        digest = hashlib.sha256(_before(file))
        with ThreadPoolExecutor(WORKERS) as pool, ThreadPoolExecutor(1) as in_order:
            for segment in _segments(file):
                waiting.append((pool.submit(self._segment, segment, wanted), in_order.submit(digest.update, segment)))
                if len(waiting) > WORKERS:
                    yield from _finished(*waiting.popleft())
            while waiting:
                yield from _finished(*waiting.popleft())
        self.sha256 = digest.hexdigest()

    def _segment(self, segment: memoryview, wanted: Sequence[int]) -> Any:
        """Chunk or frame; None where there are only blanks."""
        about = self.dialect
        if about.delimiter != WHITESPACE:
            slots = np.full(about.width, -1)
            slots[list(wanted)] = np.arange(len(wanted))
            numbers = plain_numbers.parse(segment, about.delimiter, about.decimal, slots, len(wanted))
            if numbers is not None:
                return Chunk(dict(zip(wanted, numbers, strict=True)))
        text = bytes(segment)
        return frames.read(io.BytesIO(text), about, wanted) if text.strip() else None


def _before(file: Any) -> bytes:
    """What has been read of a file."""
    end = file.tell()
    file.seek(0)
    return bytes(file.read(end))


def _segments(file: Any) -> Iterator[memoryview]:
    """The rest of a file in pieces of whole lines, as they were read, without a copy."""
    while segment := file.read(SEGMENT):
        end = segment.rfind(b"\n") + 1
        if end:
            file.seek(end - len(segment), io.SEEK_CUR)
            yield memoryview(segment)[:end]
        else:
            yield memoryview(segment + file.readline())


def _finished(read: Future[Any], hashed: Future[None]) -> Iterator[Any]:
    hashed.result()
    if (part := read.result()) is not None:
        yield part


def open_source(path: Path, spec: FileSpec) -> Delimited:
    """The text log with its dialect found."""
    return Delimited(path, detect(path, spec))
