"""Time stamps written as dates or times of day, in seconds."""

from __future__ import annotations

import datetime
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array

if TYPE_CHECKING:
    import pyarrow as pa

DAY = 86400.0
"""[s]. Source: definition."""
HOUR = 3600.0
"""[s]. Source: definition."""
ENOUGH = 20
"""Different fractions of a second that have to be seen before their digits are judged. Evidence: of fractions in four
digits one in ten is below 0.1 s, of milliseconds written so all; 20 such in a row are no chance."""

_YEAR_FIRST = r"(?P<y>\d{4})[-/.]?(?P<m>\d{1,2})[-/.]?(?P<d>\d{1,2})"
_YEAR_LAST = r"(?P<a>\d{1,2})[-/.](?P<b>\d{1,2})[-/.](?P<y>\d{4}|\d{2})"
_NAMED = r"(?P<d>\d{1,2})[- ](?P<n>[A-Za-z]{3})[A-Za-z]*[-, ]+(?P<y>\d{4}|\d{2})"
_NAME_FIRST = r"(?P<n>[A-Za-z]{3})[A-Za-z]*[- ](?P<d>\d{1,2})[-, ]+(?P<y>\d{4}|\d{2})"
_DATES = (_YEAR_FIRST, _YEAR_LAST, _NAMED, _NAME_FIRST)
_TIME = r"(?P<hour>\d{1,2}):?(?P<minute>\d{2})(?::?(?P<second>\d{2})(?:[.,:](?P<fraction>\d+))?)?"
_HALF = r"(?: ?(?P<half>[AaPp])\.?[Mm]\.?)?"
_ZONE = r" ?(?P<zone>Z|UTC|[+-]\d\d:?\d\d)?"
_MINUTES = r"^\s*(?P<minute>\d{1,3}):(?P<second>\d{2})[.,](?P<fraction>\d+)\s*$"
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_OTHER_NAMES = {"mai": 5, "mär": 3, "okt": 10, "dez": 12, "fév": 2, "avr": 4, "aoû": 8, "déc": 12}
"""Months as spreadsheets abbreviate them elsewhere. Source: CLDR, German and French."""


@dataclass
class StampParser:
    """Turns text stamps into seconds, chunk after chunk.

    Dates count from midnight of the first stamp's day; times of day from midnight, a step back of more than half a day
    being the next day; minutes and seconds from the hour. Whether a date has its day or its month first is told by a
    number above twelve, else by the step to the second date: the smaller one. ``epoch`` [s since 1970]: of the zero.
    """

    epoch: float | None = None
    last: float = field(default=np.nan)
    turns: float = 0.0
    form: str | None = None
    day_first: bool | None = None
    first: dict[str, str] = field(default_factory=dict)
    milliseconds: bool | None = None
    """Whether fractions are a count of milliseconds."""

    def seconds(self, cells: pa.Array[Any]) -> Array:
        """Time [s], shape (n,), of ``cells`` (n,) of text; NaN where a cell is no stamp."""
        import pyarrow.compute as pc

        text = pc.utf8_trim_whitespace(cells)
        filled = max(len(text) - text.null_count, 1)
        for form in [self.form] if self.form else _forms():
            parts = pc.extract_regex(text, form)
            if 2 * (len(parts) - parts.null_count) >= filled:
                self.form = form
                return self._read(parts)
        return np.full(len(text), np.nan)

    def _read(self, parts: Any) -> Array:
        fields = {parts.type.field(i).name: parts.field(i) for i in range(parts.type.num_fields)}
        of_day = self._of_day(fields)
        of_day[~np.asarray(parts.is_valid())] = np.nan
        if "y" in fields:
            return of_day + DAY * self._days(fields) - _zones(fields["zone"])
        return self._unwrapped(of_day, HOUR if "hour" not in fields else DAY)

    def _of_day(self, fields: dict[str, Any]) -> Array:
        """Seconds since midnight, or the hour where no hour is written."""
        hours = _integers(fields["hour"]) if "hour" in fields else np.zeros(len(fields["minute"]))
        if "half" in fields:
            hours = _in_24(hours, fields["half"])
        return 3600.0 * hours + 60.0 * _integers(fields["minute"]) + self._rest(fields["second"], fields["fraction"])

    def _rest(self, seconds: Any, fraction: Any) -> Array:
        """Seconds with their fraction, which may be a count of milliseconds."""
        import pyarrow.compute as pc

        fraction = pc.utf8_slice_codeunits(fraction, 0, 12)
        digits = np.nan_to_num(np.asarray(pc.utf8_length(fraction).to_numpy(zero_copy_only=False), dtype=float))
        count = _integers(fraction)
        if self.milliseconds is None:
            self.milliseconds = _are_milliseconds(count, digits)
        parts = count / (1000.0 if self.milliseconds else 10.0**digits)
        return _integers(seconds) + parts

    def _unwrapped(self, seconds: Array, turn: float) -> Array:
        known = np.flatnonzero(np.isfinite(seconds))
        if not len(known):
            return seconds
        steps = np.diff(seconds[known], prepend=seconds[known[0]] if np.isnan(self.last) else self.last)
        turns = self.turns + np.cumsum((steps < -turn / 2).astype(float) - (steps > turn / 2))
        self.last, self.turns = float(seconds[known[-1]]), float(turns[-1])
        seconds[known] += turn * turns
        return seconds

    def _days(self, fields: dict[str, Any]) -> Array:
        """Days (n,) since the first date, NaN where there is none."""
        import pyarrow.compute as pc

        names: list[str] = [name for name in ("y", "a", "b", "m", "d", "n") if name in fields]
        coded = pc.binary_join_element_wise(*(fields[name] for name in names), " ").dictionary_encode()
        dates = [dict(zip(names, str(date).split(" "), strict=True)) for date in coded.dictionary.to_pylist()]
        days = np.array([*self._numbered(dates), np.nan])
        if self.first:
            self.epoch = DAY * _day(self.first, bool(self.day_first))
        index = np.nan_to_num(np.asarray(coded.indices.to_numpy(zero_copy_only=False), dtype=float), nan=-1.0)
        found: Array = days[index.astype(int)] - (self.epoch or 0.0) / DAY
        return found

    def _numbered(self, dates: list[dict[str, str]]) -> list[float]:
        """Days since 1970 of dates in the order in which they come."""
        self.first = self.first or next((date for date in dates if all(date.values())), {})
        if dates and "a" in dates[0] and self.day_first is None:
            self.day_first = _day_first([self.first, *dates])
        return [_day(date, bool(self.day_first)) for date in dates]


def _forms() -> list[str]:
    dated = [rf"^{date}(?:[T_ ,]+|:){_TIME}{_HALF}{_ZONE}$" for date in _DATES]
    return [rf"^{_TIME}{_HALF}$".replace(":?", ":"), _MINUTES, *dated]


def _integers(digits: Any) -> Array:
    """Whole numbers (n,) of digits, 0 where there are none."""
    import pyarrow as pa
    import pyarrow.compute as pc

    filled = pc.if_else(pc.equal(pc.utf8_length(pc.fill_null(digits, "")), 0), "0", digits)
    return np.asarray(pc.cast(pc.utf8_slice_codeunits(filled, 0, 15), pa.float64()).to_numpy(zero_copy_only=False))


def _in_24(hours: Array, half: Any) -> Array:
    """Hours of the day from those of its halves."""
    import pyarrow.compute as pc

    said = pc.utf8_lower(pc.fill_null(half, "")).to_numpy(zero_copy_only=False).astype(str)
    afternoon = said == "p"
    return np.where(said == "", hours, np.where(hours == 12.0, 0.0, hours) + 12.0 * afternoon)


def _zones(zone: Any) -> Array:
    """Seconds (n,) east of Greenwich."""
    coded = zone.dictionary_encode()
    offsets = np.array([*(_offset(word or "") for word in coded.dictionary.to_pylist()), 0.0])
    index = np.nan_to_num(np.asarray(coded.indices.to_numpy(zero_copy_only=False), dtype=float), nan=-1.0)
    found: Array = offsets[index.astype(int)]
    return found


def _offset(zone: str) -> float:
    if zone[:1] not in ("+", "-"):
        return 0.0
    digits = zone[1:].replace(":", "")
    return (1.0 if zone[0] == "+" else -1.0) * (3600.0 * int(digits[:2]) + 60.0 * int(digits[2:]))


def _are_milliseconds(count: Array, digits: Array) -> bool | None:
    """Whether fractions count milliseconds: in four digits that stay below 1000, or in one to three without leading
    zeros; None where too few are seen to tell.
    """
    some = digits > 0
    if len(np.unique(count[some])) < ENOUGH:
        return None
    four = bool((digits[some] == 4).all() and (count[some] < 1000).all())
    leading_zero = (digits[some] > 1) & (count[some] < 10.0 ** (digits[some] - 1))
    unpadded = bool(digits[some].max() == 3 and digits[some].min() < 3 and not leading_zero.any())
    return four or unpadded


def _day(date: dict[str, str], day_first: bool) -> float:
    """Days since 1970 of a date, NaN of an impossible one."""
    if not all(date.values()):
        return float("nan")
    year = int(date["y"]) + (2000 if len(date["y"]) == 2 else 0)
    if "a" in date:
        month, day = (int(date["b"]), int(date["a"])) if day_first else (int(date["a"]), int(date["b"]))
    else:
        month, day = (_month(date["n"]) if "n" in date else int(date["m"])), int(date["d"])
    try:
        return float((datetime.date(year, month, day) - datetime.date(1970, 1, 1)).days)
    except ValueError:
        return float("nan")


def _month(name: str) -> int:
    word = name.casefold()
    return _MONTHS.index(word) + 1 if word in _MONTHS else _OTHER_NAMES.get(word, 0)


def _day_first(dates: list[dict[str, str]]) -> bool | None:
    """Whether dates have their day first; None where one date alone could be either, which then does not matter."""
    dates = [date for date in dates if date["a"] and date["b"]]
    firsts, seconds = {int(date["a"]) for date in dates}, {int(date["b"]) for date in dates}
    if not dates:
        return None
    if max(firsts) > 12 or max(seconds) > 12:
        return max(firsts) > 12
    steps = {}
    for order in (True, False):
        days = [_day(date, order) for date in dates]
        steps[order] = float(np.abs(np.diff(days)).sum())
    return None if steps[True] == steps[False] else steps[True] < steps[False]
