"""A rocket's drag coefficient against Mach number, as [rocket] drag_table names it: two columns of numbers."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from hfanalysis.errors import InputError

HIGHEST_COEFFICIENT = 20.0
"""Largest drag coefficient [-] that is believed: above any rocket's; a table in percent or of drag areas is refused.
Evidence: test_drag_table.py: 52.9 is refused."""


@dataclass(frozen=True)
class DragTable:
    """Mach numbers, increasing, and the drag coefficient at each."""

    mach: tuple[float, ...]
    coefficient: tuple[float, ...]


def read_drag_table(path: Path) -> DragTable:
    """The table in a file of Mach number and C_d by line, separated by comma, semicolon or blanks; a header may stand.

    Raises :class:`InputError` naming file, line, what was found and what was expected.
    """
    rows = [_row(path, number, line) for number, line in _lines(path)]
    if not rows:
        raise InputError(f"{path}: found no numbers; expected lines of Mach number and drag coefficient")
    mach, coefficient = zip(*rows, strict=True)
    for before, after in pairwise(mach):
        if not after > before:
            raise InputError(f"{path}: found Mach {after:g} after {before:g}; expected Mach numbers that increase")
    return DragTable(mach, coefficient)


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Numbered lines in columns, without comments and empty ones and without a header."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: not found; expected a table of Mach number and drag coefficient") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: cannot be read ({error}); expected a table of Mach number and drag coefficient"
        ) from None
    lines = [(n, _columns(line)) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    return lines[1:] if lines and _is_header(lines[0][1]) else lines


def _columns(line: str) -> list[str]:
    separator = next((mark for mark in ";,\t" if mark in line), None)
    return (
        line.split() if separator is None else [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    )


def _is_header(cells: list[str]) -> bool:
    return not any(map(_is_number, cells))


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _row(path: Path, number: int, cells: list[str]) -> tuple[float, float]:
    if len(cells) < 2 or not (_is_number(cells[0]) and _is_number(cells[1])):
        raise InputError(f"{path}, line {number}: found {' '.join(cells)!r}; expected a Mach number and a coefficient")
    mach, coefficient = (float(cell.replace(",", ".")) for cell in cells[:2])
    if not (0.0 <= mach < math.inf and 0.0 < coefficient < HIGHEST_COEFFICIENT):
        raise InputError(
            f"{path}, line {number}: found Mach {mach:g} and C_d {coefficient:g}; expected a Mach number of 0 or more "
            f"and a coefficient between 0 and {HIGHEST_COEFFICIENT:g}"
        )
    return mach, coefficient
