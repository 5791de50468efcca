"""Plain numbers between plain marks, which is what nearly all of a log is, read several times faster than by pandas.

Anything else in a segment of text (quotes, words, dates, more digits than a double holds exactly) makes it decline, and
pandas reads that segment.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float64]

NEWLINE, RETURN, SPACE, TAB = 10, 13, 32, 9
PLUS, MINUS, ZERO, NINE, LARGE_E, SMALL_E = 43, 45, 48, 57, 69, 101
EXACT = 2**53
"""Whole numbers up to this are exact in a double, and so is their product with a power of ten up to 22."""
POWERS = 10.0 ** np.arange(23)


def parse(text: bytes, delimiter: str, decimal: str, slots: NDArray[np.int64], wanted: int) -> Floats | None:
    """The wanted columns, shape (wanted, rows), NaN where a cell is empty; None where a cell is not a plain number.

    ``slots``: for each column of the text the row of the result, -1 where it is not wanted.
    """
    data = np.frombuffer(text, dtype=np.uint8)
    out = np.full((wanted, text.count(b"\n") + 1), np.nan)
    rows = _parse(data, ord(delimiter), ord(decimal), slots, out)
    return None if rows < 0 else out[:, :rows]


@njit(cache=True, nogil=True)
def _parse(data: Bytes, delimiter: int, decimal: int, slots: NDArray[np.int64], out: Floats) -> int:
    """Number of rows filled, -1 where a wanted cell is not a plain number."""
    n, i, row, column = len(data), 0, 0, 0
    blank = True
    while i < n:
        slot = slots[column] if column < len(slots) else -1
        if slot >= 0:
            i, value = _number(data, i, delimiter, decimal)
            if i < 0:
                return -1
            out[slot, row] = value
            blank = blank and np.isnan(value)
        else:
            start = i
            i = _skip(data, i, delimiter)
            if i < 0:
                return -1
            blank = blank and i == start
        if i < n and data[i] == delimiter:
            column += 1
            i += 1
            continue
        if not (blank and column == 0):
            row += 1
        column, blank = 0, True
        while i < n and (data[i] == RETURN or data[i] == NEWLINE):
            i += 1
    return row


@njit(cache=True, nogil=True)
def _skip(data: Bytes, i: int, delimiter: int) -> int:
    """The end of a cell that is not wanted; -1 where it is quoted."""
    while i < len(data) and data[i] != delimiter and data[i] != NEWLINE and data[i] != RETURN:
        if data[i] == 34:
            return -1
        i += 1
    return i


@njit(cache=True, nogil=True, inline="always")
def _number(data: Bytes, i: int, delimiter: int, decimal: int) -> tuple[int, float]:
    """The end of a cell and its number, NaN for an empty one; end -1 where it is not a plain number."""
    n = len(data)
    while i < n and data[i] == SPACE:
        i += 1
    if i == n or data[i] == delimiter or data[i] == NEWLINE or data[i] == RETURN:
        return i, np.nan
    negative = data[i] == MINUS
    if negative or data[i] == PLUS:
        i += 1
    mantissa, digits, places = np.int64(0), 0, 0
    point = False
    while i < n and (ZERO <= data[i] <= NINE or (data[i] == decimal and not point)):
        if data[i] == decimal:
            point = True
        else:
            mantissa = mantissa * 10 + (data[i] - ZERO)
            digits += 1
            places += point
        i += 1
        if digits > 18:
            return -1, 0.0
    if digits == 0 or mantissa > EXACT:
        return -1, 0.0
    if i < n and (data[i] == SMALL_E or data[i] == LARGE_E):
        i, exponent = _exponent(data, i + 1)
        places -= exponent
    while i >= 0 and i < n and data[i] == SPACE and delimiter != SPACE:
        i += 1
    if i < 0 or abs(places) > 22:
        return -1, 0.0
    if i < n and data[i] != delimiter and data[i] != NEWLINE and data[i] != RETURN:
        return -1, 0.0
    value = mantissa / POWERS[places] if places >= 0 else mantissa * POWERS[-places]
    return i, -value if negative else value


@njit(cache=True, nogil=True)
def _exponent(data: Bytes, i: int) -> tuple[int, int]:
    """The end of an exponent and its value; end -1 where there is none."""
    n = len(data)
    negative = i < n and data[i] == MINUS
    if i < n and (data[i] == MINUS or data[i] == PLUS):
        i += 1
    start, value = i, 0
    while i < n and ZERO <= data[i] <= NINE and i - start < 4:
        value = value * 10 + (data[i] - ZERO)
        i += 1
    return (i if i > start else -1), (-value if negative else value)
