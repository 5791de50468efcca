"""Plain numbers between plain marks, which is what nearly all of a log is, read several times faster than by pandas.

Anything else in a segment of text (quotes, words, dates, more digits than a double holds exactly) makes it decline, and
pandas reads that segment.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled

Bytes = NDArray[np.uint8]
Unsigned = Any
"""numpy.uint64: a place in the text, or what is counted from it."""

NEWLINE, RETURN, SPACE, TAB = 10, 13, 32, 9
"""Characters. Source: ASCII."""
PLUS, MINUS, ZERO, NINE, LARGE_E, SMALL_E = 43, 45, 48, 57, 69, 101
"""Characters. Source: ASCII."""
START, ONE, NINE_MORE, TEN, FIGURE_ZERO = (np.uint64(x) for x in (0, 1, 9, 10, 48))
"""Places and counts without a sign. Evidence: places that may be counted from the end make parsing take three times as
long."""
EXACT = np.uint64(2**53)
"""Whole numbers up to this are exact in a double, and so is their product with a power of ten up to 22. Source: IEEE
754: a double has 53 bits; 10^22 = 2^22 5^22 and 5^22 < 2^53."""
MOST_DIGITS = np.uint64(18)
"""Digits that fit a 64-bit integer whatever they are. Source: 10^18 - 1 < 2^63."""
DECLINED = -1
"""Number of rows that stands for none: a cell was no plain number."""
SIGNED: Any = np.int64
POWERS = 10.0 ** np.arange(23)
"""Powers of ten that are exact in a double. Source: IEEE 754 (as EXACT)."""


def parse(
    text: bytes | memoryview, delimiter: str, decimal: str, slots: NDArray[np.int64], wanted: int
) -> Array | None:
    """The wanted columns, shape (wanted, rows), NaN where a cell is empty; None where a cell is not a plain number.

    ``slots`` (columns,): for each column of the text the row of the result, -1 where it is not wanted. Numbers are as
    logged, in whatever unit the log has.
    """
    data = np.frombuffer(text if text[-1] == NEWLINE else bytes(text) + b"\n", dtype=np.uint8)
    out = np.empty((wanted, _count(data, NEWLINE)))
    rows = _parse(data, ord(delimiter), ord(decimal), slots, out)
    return None if rows < 0 else out[:, :rows]


@compiled(nogil=True)
def _count(data: Bytes, byte: int) -> int:
    count = 0
    for value in data:
        count += value == byte
    return count


@compiled(nogil=True)
def _parse(data: Bytes, delimiter: int, decimal: int, slots: NDArray[np.int64], out: Array) -> Any:
    """Number of rows filled from lines that all end; DECLINED for a cell that is no plain number.

    Places are counted without a sign, so that none is taken as from the end: this alone makes it thrice as fast.
    """
    n, i, row = np.uint64(len(data)), START, START
    while i < n:
        if data[i] == NEWLINE or data[i] == RETURN:
            i += ONE
            continue
        if row == np.uint64(out.shape[1]):
            return DECLINED  # lines that end otherwise
        column, start = START, i
        while True:
            slot = slots[column] if column < np.uint64(len(slots)) else -1
            end, value = _plain(data, i, delimiter, decimal) if slot >= 0 else (START, 0.0)
            if end == START:
                other, value = _other(data, SIGNED(i), delimiter, decimal, slot >= 0)
                if other < 0:
                    return DECLINED
                end = np.uint64(other)
            if slot >= 0:
                out[slot, row] = value
            i = end
            column += ONE
            if data[i] != delimiter:
                break
            i += ONE
        _leave_empty(slots[SIGNED(column) :], row, out)
        row += np.uint64(column > ONE or not _is_blank(data, SIGNED(start), SIGNED(i)))
    return SIGNED(row)


@compiled(nogil=True)
def _leave_empty(slots: NDArray[np.int64], row: Unsigned, out: Array) -> None:
    """NaN in the columns that a short line does not have."""
    for slot in slots:
        if slot >= 0:
            out[slot, row] = np.nan


@compiled(nogil=True)
def _plain(data: Bytes, i: Unsigned, delimiter: int, decimal: int) -> tuple[Unsigned, float]:
    """The end of a cell of sign, digits, decimal mark and digits, and its number; end 0 where it is another."""
    negative = data[i] == MINUS
    start = i + np.uint64(negative)
    i, mantissa = _digits(data, start, START)
    digits, places = i - start, START
    if data[i] == decimal:
        start = i + ONE
        i, mantissa = _digits(data, start, mantissa)
        places = i - start
    digits += places
    ended = data[i] == delimiter or data[i] == NEWLINE or data[i] == RETURN
    if not ended or digits == START or digits > MOST_DIGITS or mantissa > EXACT:
        return START, 0.0
    value = np.float64(mantissa) / POWERS[places]
    return i, -value if negative else value


@compiled(nogil=True)
def _other(data: Bytes, i: int, delimiter: int, decimal: int, wanted: bool) -> tuple[int, float]:
    """The end of any cell, -1 where pandas has to see it, and its number where that is wanted."""
    return _number(data, i, delimiter, decimal) if wanted else (_skip(data, i, delimiter), 0.0)


@compiled(nogil=True)
def _digits(data: Bytes, at: Unsigned, mantissa: Unsigned) -> tuple[Unsigned, Unsigned]:
    """The end of a row of digits from ``at`` on, appended to ``mantissa``."""
    digit = np.uint64(data[at]) - FIGURE_ZERO
    while digit <= NINE_MORE:
        mantissa = mantissa * TEN + digit
        at += ONE
        digit = np.uint64(data[at]) - FIGURE_ZERO
    return at, mantissa


@compiled(nogil=True)
def _is_blank(data: Bytes, start: int, end: int) -> bool:
    while start < end and (data[start] == SPACE or data[start] == TAB):
        start += 1
    return start == end


@compiled(nogil=True)
def _skip(data: Bytes, i: int, delimiter: int) -> int:
    """The end of a cell that is not wanted; -1 where it is quoted."""
    while data[i] != delimiter and data[i] != NEWLINE and data[i] != RETURN:
        if data[i] == 34:
            return -1
        i += 1
    return i


@compiled(nogil=True)
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
    if not 0 < digits + places <= 18 or mantissa > 2**53:
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


@compiled(nogil=True)
def _exponent(data: Bytes, i: int) -> tuple[int, int]:
    """The end of an exponent and its value; end -1 where there is none."""
    negative = data[i] == MINUS
    i += negative or data[i] == PLUS
    start, value = i, 0
    while ZERO <= data[i] <= NINE and i - start < 4:
        value = value * 10 + (data[i] - ZERO)
        i += 1
    return (i if i > start else -1), (-value if negative else value)
