"""Time stamps written as dates or times of day, in seconds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array

if TYPE_CHECKING:
    import pandas as pd

DAY = 86400.0
"""[s]. Source: definition."""
_FORMATS = ("ISO8601", "%m/%d/%Y %H:%M:%S.%f", "%m/%d/%Y %H:%M:%S", "%d.%m.%Y %H:%M:%S.%f", "%d.%m.%Y %H:%M:%S",
            "%d/%m/%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p", "%m/%d/%Y %I:%M:%S %p")  # fmt: skip
_CLOCK = r"^\s*(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d+)?))?\s*$"


@dataclass
class StampParser:
    """Turns text stamps into seconds, chunk after chunk.

    Dates count from midnight of the first stamp's day; times of day from midnight, a step back of more than half a day
    being the next day.
    """

    midnight: Any = None
    last: float = field(default=np.nan)
    days: float = 0.0

    def seconds(self, cells: pd.Series[Any]) -> Array:
        """Time [s], shape (n,), of ``cells`` (n,) of text; NaN where a cell is no stamp."""
        text = cells.astype("string")
        clock = text.str.extract(_CLOCK)
        if clock[0].notna().sum() * 2 >= text.notna().sum() and clock[0].notna().any():
            return self._clock(clock)
        return self._dates(text)

    def _clock(self, parts: pd.DataFrame) -> Array:
        hours, minutes = (_numbers(parts[i]) for i in (0, 1))
        rest = np.nan_to_num(_numbers(parts[2].str.replace(",", ".")))
        return self._unwrapped(3600.0 * hours + 60.0 * minutes + rest)

    def _unwrapped(self, seconds: Array) -> Array:
        known = np.flatnonzero(np.isfinite(seconds))
        if not len(known):
            return seconds
        steps = np.diff(seconds[known], prepend=seconds[known[0]] if np.isnan(self.last) else self.last)
        days = self.days + np.cumsum((steps < -DAY / 2).astype(float) - (steps > DAY / 2))
        self.last, self.days = float(seconds[known[-1]]), float(days[-1])
        seconds[known] += DAY * days
        return seconds

    def _dates(self, text: pd.Series[Any]) -> Array:
        stamps = _parsed(text)
        known = stamps[stamps.notna()]
        if self.midnight is None and len(known):
            self.midnight = known.iloc[0].normalize()
        if self.midnight is None:
            return np.full(len(text), np.nan)
        elapsed: Array = (stamps - self.midnight).dt.total_seconds().to_numpy(dtype=np.float64)
        return elapsed


def _parsed(text: pd.Series[Any]) -> pd.Series[Any]:
    """The reading, in the first format that fits most cells."""
    import pandas as pd

    best = pd.to_datetime(text, format=_FORMATS[0], errors="coerce", utc=True)
    for form in _FORMATS[1:]:
        if best.notna().sum() * 2 >= text.notna().sum():
            break
        best = pd.to_datetime(text, format=form, errors="coerce", utc=True)
    return best


def _numbers(cells: pd.Series[Any]) -> Array:
    import pandas as pd

    return np.array(pd.to_numeric(cells, errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan))
