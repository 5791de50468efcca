"""RASP's engine files (.eng): a thrust curve, the columns ``time`` [s] and ``thrust`` [N]."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.table import LogSeries, Table

FIELDS = 7
"""Fields of the line about the engine: name, diameter, length, delays, propellant, total mass, maker. Source: RASP."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The first engine's curve; raises :class:`InputError` where a line is no pair of numbers."""
    lines = [line.strip() for line in path.read_text(encoding="utf-8", errors="replace").splitlines()]
    body = [(i, line.split()) for i, line in enumerate(lines, start=1) if line and not line.startswith(";")]
    if not body or len(body[0][1]) < FIELDS:
        raise InputError(f"{path}: found no line of {FIELDS} fields about the engine; expected a RASP engine file")
    points: list[tuple[float, float]] = []
    for number, words in body[1:]:
        if len(words) >= FIELDS:
            break  # a further engine
        points.append(_point(path, number, words))
    time, thrust = np.array(points).reshape(-1, 2).T
    return Table(path, [LogSeries("time", time, "s"), LogSeries("thrust", thrust, "N", time=time)])


def _point(path: Path, number: int, words: list[str]) -> tuple[float, float]:
    try:
        time, thrust = map(float, words)
    except ValueError:
        found = " ".join(words)
        raise InputError(f"{path}, line {number}: found {found!r}; expected a time [s] and a thrust [N]") from None
    return time, thrust
