"""Octave's text format: matrices and vectors by name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.matlab import columns
from hfanalysis.record.readers.table import LogSeries, Table

KINDS = ("matrix", "float matrix", "bool matrix")
"""Types of Octave's that hold numbers."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's matrices; raises :class:`InputError` where one cannot be read."""
    lines = path.read_text(encoding=spec.encoding or "utf-8", errors="replace").splitlines()
    return Table(path, list(_series(path, lines)))


def _series(path: Path, lines: list[str]) -> Iterator[LogSeries]:
    starts = [i for i, line in enumerate(lines) if line.startswith("# name:")]
    for start, end in zip(starts, [*starts, len(lines)][1:], strict=True):
        name, about, body = lines[start][7:].strip(), {}, []
        for line in lines[start + 1 : end]:
            if line.startswith("#"):
                key, _, value = line[1:].partition(":")
                about[key.strip()] = value.strip()
            elif line.strip():
                body.append(line)
        if about.get("type") in KINDS and body:
            yield from columns(name, _matrix(path, name, body))


def _matrix(path: Path, name: str, body: list[str]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    try:
        return np.array([[float(cell.replace("NA", "nan")) for cell in line.split()] for line in body])
    except ValueError:
        raise InputError(f"{path}: matrix {name!r} holds more than numbers, or rows of different length") from None
