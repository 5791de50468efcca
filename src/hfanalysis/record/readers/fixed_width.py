"""Tables in columns of fixed width, where an empty cell is but blanks."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

ENOUGH = 20
"""Full rows whose cells must end at the same places for a table to be one of fixed width. Evidence: test_headers.py:
numbers between single blanks end anywhere."""


def edges(lines: Sequence[str]) -> tuple[int, ...]:
    """Places of the beginnings of the columns but the first, in lines some of which have empty cells; () elsewhere."""
    lines = [line.rstrip("\r\n") for line in lines]
    widths = Counter(len(line.split()) for line in lines)
    most = max((width for width, times in widths.items() if times > 1), default=0)
    full = [line for line in lines if len(line.split()) == most]
    usual = Counter(len(line) for line in lines).most_common(1)[0]
    if len(widths) == 1 or most < 2 or len(full) < ENOUGH or 10 * usual[1] < 9 * len(lines):
        return ()
    ends = {tuple(found.end() for found in re.finditer(r"\S+", line)) for line in full}
    starts = {tuple(found.start() for found in re.finditer(r"\S+", line)) for line in full}
    if len(ends) == 1:
        return tuple(end for end in next(iter(ends))[:-1])
    return next(iter(starts))[1:] if len(starts) == 1 else ()


def cut(line: str, places: Sequence[int]) -> list[str]:
    """The cells of a line, blanks around them removed."""
    return [line[a:b].strip() for a, b in zip((0, *places), (*places, None), strict=True)]
