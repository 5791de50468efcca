"""JSON: an array of records, records line by line, arrays by name, or rows with their names in the first."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.encodings import encoding_of
from hfanalysis.record.readers.series import from_rows, records, series
from hfanalysis.record.readers.table import LogSeries, Table


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's arrays and records; raises :class:`InputError` where it is not JSON or holds no numbers."""
    content = path.read_bytes()
    text = content.decode(spec.encoding or encoding_of(content), errors="replace").strip("\ufeff\0\r\n\t ")
    notes: list[str] = []
    try:
        whole: Any = json.loads(text)
    except RecursionError:
        raise InputError(f"{path}: nested too deeply for a log; expected arrays or records") from None
    except ValueError as error:
        whole = _by_lines(path, text, error, notes)
    return Table(path, list(_walk("", whole)), notes)


def _by_lines(path: Path, text: str, error: ValueError, notes: list[str]) -> list[Any]:
    """A value in each line; the last may be cut."""
    found, lines = [], [line for line in text.splitlines() if line.strip(" ,\0")]
    broken = []
    for number, line in enumerate(lines, start=1):
        try:
            found.append(json.loads(line.strip(" ,")))
        except (ValueError, RecursionError):
            broken.append(number)
    if len(found) < 2 or 2 * len(broken) > len(lines):
        raise InputError(f"{path}: cannot be read as JSON: {error}; expected one value, or one in each line") from None
    if broken:
        notes.append(f"{path.name}: {len(broken)} lines are not JSON and are left out, the first is line {broken[0]}")
    return found


def _walk(name: str, value: Any) -> Iterator[LogSeries]:
    """The series of a value."""
    prefix = f"{name}." if name else ""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _walk(f"{prefix}{key}", inner)
    elif isinstance(value, list) and len(value) > 1:
        if all(isinstance(one, dict) for one in value):
            yield from records(value, prefix)
        elif all(isinstance(one, list) for one in value):
            yield from from_rows(value, prefix)
        elif not any(isinstance(one, (dict, list)) for one in value):
            found = series(name or "values", value)
            yield from [found] if found is not None else []
