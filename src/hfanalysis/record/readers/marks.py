"""How numbers are written: the decimal mark, marks between thousands, signs and exponents that are not ASCII's.

What ``1,062`` is, no cell tells: a file's cells together do. A mark is decimal where some cell has it before other than
three digits (or behind a lone zero); it sets thousands apart where it stands twice, before the other mark, or in a
column whose other cells are whole numbers below a thousand.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence

from hfanalysis.errors import InputError

BLANKS = "\u00a0\u202f\u2009\u2007"
"""Blanks that do not break a line, as some set thousands apart."""
_SIGN = r"[+-]?"
_EXPONENT = r"([eE][+-]?\d+)?"
_NUMBER = re.compile(
    rf"{_SIGN}(\d+([.,]\d*)?|[.,]\d+){_EXPONENT}|{_SIGN}(nan|inf|infinity)|{_SIGN}\d{{1,3}}([.,]\d{{3}})+([.,]\d+)?",
    re.IGNORECASE,
)
_GROUPED = {mark: re.compile(rf"{_SIGN}[1-9]\d{{0,2}}(\{mark}\d{{3}})+") for mark in ".,"}
_TWICE = {
    mark: re.compile(rf"{_SIGN}\d{{1,3}}(\{mark}\d{{3}}){{2,}}|{_SIGN}\d{{1,3}}(\{mark}\d{{3}})+\{other}\d*")
    for mark, other in (".,", ",.")
}
_DECIMAL = {mark: re.compile(rf"{_SIGN}\d*\{mark}\d*{_EXPONENT}") for mark in ".,"}
_WHOLE = re.compile(rf"{_SIGN}\d{{1,3}}")

_SPACED = re.compile(rf"{_SIGN}\d{{1,3}}( \d{{3}})+([.,]\d*)?")

_REPLACED = (
    (re.compile("[\u2212\u2013\ufe63\uff0d](?=\\d)"), "-"),
    (re.compile(r"(?<=\d)[dD](?=[+-]\d)"), "e"),
    (re.compile(f"(?<=\\d)[{BLANKS}](?=\\d{{3}}(?!\\d))"), ""),
    (re.compile("(?<=\\d)['\u2019](?=\\d{3}(?!\\d))"), ""),
)
"""What is written otherwise than in ASCII and without marks between thousands, and what it becomes."""
_NOT_ASCII = (_REPLACED[0][0], _REPLACED[2][0])
"""Those of them that a text in ASCII cannot hold. Source: ASCII."""
BLANK_BETWEEN = (re.compile(r"(?<![\d.:/-])([+-]?\d{1,3}) (?=\d{3}(?!\d|:|/|-))"), r"\1")
"""The same for a plain blank, where blanks do not separate columns."""


def is_number(field: str) -> bool:
    """Whether a field is a number, with either decimal mark and perhaps a mark between thousands.

    >>> is_number("1.062,5"), is_number("-3e4"), is_number("10:00")
    (True, True, False)
    """
    return bool(_NUMBER.fullmatch(field))


def is_spaced(field: str) -> bool:
    """Whether a field is a number with blanks between thousands."""
    return bool(_SPACED.fullmatch(field))


def replaced(text: str) -> list[tuple[re.Pattern[str], str]]:
    """What has to be replaced in a text that is written like this, before its numbers are plain."""
    return [(mark, by) for mark, by in _REPLACED if not (text.isascii() and mark in _NOT_ASCII) and mark.search(text)]


def decimal_mark(columns: Iterable[Sequence[str]], where: str) -> str:
    """The decimal mark of a file of which these are cells by column, "." where nothing tells.

    Raises :class:`InputError` where cells have a comma that may be either.
    """
    decimal: Counter[str] = Counter()
    thousands: Counter[str] = Counter()
    unclear = ""
    for cells in columns:
        for mark in ".,":
            marked = [cell for cell in cells if mark in cell and is_number(cell)]
            certain = sum(1 for cell in marked if _is_decimal(cell, mark))
            decimal[mark] += certain
            thousands[mark] += sum(1 for cell in marked if _TWICE[mark].fullmatch(cell))
            if marked and not certain and any(_WHOLE.fullmatch(cell) for cell in cells):
                thousands[mark] += 1
            elif marked and mark == ",":
                unclear = marked[0]
    return _decided(decimal, thousands, unclear, where)


def _is_decimal(cell: str, mark: str) -> bool:
    return bool(_DECIMAL[mark].fullmatch(cell)) and not _GROUPED[mark].fullmatch(cell)


def _decided(decimal: Counter[str], thousands: Counter[str], unclear: str, where: str) -> str:
    if decimal["."] or decimal[","]:
        return "," if decimal[","] > decimal["."] else "."
    if thousands["."] or thousands[","]:
        return "," if thousands["."] > thousands[","] else "."
    if unclear:
        raise InputError(
            f"{where}: in {unclear!r} the comma may be a decimal mark or set thousands apart, and no cell tells; "
            "expected decimal = '.' or ',' in [log]"
        )
    return "."
