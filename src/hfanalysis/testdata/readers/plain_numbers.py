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
DECLINED, FULL = -1, -2
POWERS = 10.0 ** np.arange(23)


def parse(text: bytes, delimiter: str, decimal: str, slots: NDArray[np.int64], wanted: int) -> Floats | None:
    """The wanted columns, shape (wanted, rows), NaN where a cell is empty; None where a cell is not a plain number.

    ``slots``: for each column of the text the row of the result, -1 where it is not wanted.
    """
    closed = text if text.endswith(b"\n") else text + b"\n"
    data = np.frombuffer(closed, dtype=np.uint8)
    guess = int(1.2 * len(closed) / (closed.index(b"\n") + 1)) + 16
    out = np.empty((wanted, guess))
    rows = _parse(data, ord(delimiter), ord(decimal), slots, out)
    if rows == FULL:
        out = np.empty((wanted, closed.count(b"\n") + 1))
        rows = _parse(data, ord(delimiter), ord(decimal), slots, out)
    return None if rows < 0 else out[:, :rows]


@njit(cache=True, nogil=True)
def _parse(data: Bytes, delimiter: int, decimal: int, slots: NDArray[np.int64], out: Floats) -> int:
    """Number of rows filled from lines that all end; DECLINED for a cell that is no plain number, FULL for no room."""
    n, i, row = len(data), 0, 0
    while i < n:
        if data[i] == NEWLINE or data[i] == RETURN:
            i += 1
            continue
        if row == out.shape[1]:
            return FULL
        out[:, row] = np.nan
        column, start = 0, i
        while True:
            slot = slots[column] if column < len(slots) else -1
            if slot >= 0:
                i, out[slot, row] = _number(data, i, delimiter, decimal)
            else:
                i = _skip(data, i, delimiter)
            if i < 0:
                return DECLINED
            if data[i] != delimiter:
                break
            column += 1
            i += 1
        row += column > 0 or not _is_blank(data, start, i)
    return row


@njit(cache=True, nogil=True)
def _is_blank(data: Bytes, start: int, end: int) -> bool:
    while start < end and (data[start] == SPACE or data[start] == TAB):
        start += 1
    return start == end


@njit(cache=True, nogil=True)
def _skip(data: Bytes, i: int, delimiter: int) -> int:
    """The end of a cell that is not wanted; -1 where it is quoted."""
    while data[i] != delimiter and data[i] != NEWLINE and data[i] != RETURN:
        if data[i] == 34:
            return -1
        i += 1
    return i


@njit(cache=True, nogil=True)
def _number(data: Bytes, i: int, delimiter: int, decimal: int) -> tuple[int, float]:
    """The end of a cell and its number, NaN for an empty one; end -1 where it is not a plain number."""
    while data[i] == SPACE:
        i += 1
    if data[i] == delimiter or data[i] == NEWLINE or data[i] == RETURN:
        return i, np.nan
    negative = data[i] == MINUS
    i += negative or data[i] == PLUS
    start, mantissa, places = i, np.int64(0), 0
    while ZERO <= data[i] <= NINE:
        mantissa = mantissa * 10 + (data[i] - ZERO)
        i += 1
    digits = i - start
    if data[i] == decimal:
        i += 1
        start = i
        while ZERO <= data[i] <= NINE:
            mantissa = mantissa * 10 + (data[i] - ZERO)
            i += 1
        places = i - start
    if not 0 < digits + places <= 18 or mantissa > EXACT:
        return -1, 0.0
    if data[i] == SMALL_E or data[i] == LARGE_E:
        i, exponent = _exponent(data, i + 1)
        places -= exponent
    while i >= 0 and data[i] == SPACE and delimiter != SPACE:
        i += 1
    if i < 0 or abs(places) > 22 or (data[i] != delimiter and data[i] != NEWLINE and data[i] != RETURN):
        return -1, 0.0
    value = mantissa / POWERS[places] if places >= 0 else mantissa * POWERS[-places]
    return i, -value if negative else value


@njit(cache=True, nogil=True)
def _exponent(data: Bytes, i: int) -> tuple[int, int]:
    """The end of an exponent and its value; end -1 where there is none."""
    negative = data[i] == MINUS
    i += negative or data[i] == PLUS
    start, value = i, 0
    while ZERO <= data[i] <= NINE and i - start < 4:
        value = value * 10 + (data[i] - ZERO)
        i += 1
    return (i if i > start else -1), (-value if negative else value)
