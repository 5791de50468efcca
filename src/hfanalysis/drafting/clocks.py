"""The column of the time stamps of a log file, and their unit."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.drafting.columns import Column, LogFile
from hfanalysis.drafting.labels import fits
from hfanalysis.drafting.shapes import is_clock
from hfanalysis.units import unit_factor

_TIME = re.compile(
    r"(t|ts|tiempo|temps|zeit|seconds?|secs?|millis|micros|ms|time.*|stamp|.*time|.*timestamp|.*_ts|elapsed.*|epoch.*|"
    r"x_value|datetime|date|clock|uptime.*)(_?(raw|ms|us|ns|s|sec|millis))?",
    re.IGNORECASE,
)
_COUNTS = re.compile(r"(#|n|no|index|idx|sample.*|count|row|line|packet.*|seq.*)", re.IGNORECASE)
_IN_NAME = {"ms": "ms", "millis": "ms", "milliseconds": "ms", "us": "us", "micros": "us", "microseconds": "us",
            "ns": "ns", "nanos": "ns", "seconds": "s", "sec": "s", "secs": "s", "second": "s"}  # fmt: skip
"""Words of a name that are a unit."""
_RATE = re.compile(r"(\d+(?:\.\d+)?)\s*(k|M)?hz", re.IGNORECASE)

EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s"))
"""Readings from which on a clock counts from 1970 in this unit. Source: 2001 to 2100 is 1e9 to 4e9 s."""
EXCEL = (30_000.0, 60_000.0)
"""Days since 1900 between 1982 and 2064, as spreadsheets count. Source: 45,000 is 2023-03-15."""
SLOWEST = 0.4
"""Seconds between samples [s] beyond which nobody logs a firing. Evidence: scales and thermocouples are logged at 2 Hz
at the slowest."""

STANDS = 0.5
"""Share of steps that move, below which stamps are truncated. Evidence: stamps of published logs repeat in
up to 6 % of rows, or in half of them where they are whole seconds."""

_TEXT_STAMPS = (
    (
        "datetime",
        re.compile(r"\d{2,4}[-./]\d{1,2}[-./]\d{2,4}[ T]\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?(Z|[+-]\d{2}:?\d{2})?"),
    ),
    ("clock", re.compile(r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?( ?[AaPp][Mm])?")),
)
"""How stamps are written that are no numbers."""
_LOOKED_AT = 200
"""Lines of a log that are looked at for stamps."""


@dataclass(frozen=True)
class Stamps:
    """The time of a file's samples.

    ``column``: of the stamps, None where the file has none; ``unit`` of test.toml; ``reason`` of both, where they are
    not stated; ``rate`` [text] where a name states one instead; ``stands``: it stands still for many samples at a time.
    """

    column: Column | None = None
    unit: str = ""
    reason: str = ""
    rate: str = ""
    stands: bool = False

    @property
    def factor(self) -> float:
        """Seconds in its unit [s]; 1 where the stamps are written as dates or times of day."""
        return 1.0 if self.unit in ("datetime", "clock") or not self.unit else unit_factor(self.unit, "time", "")[0]


def find_stamps(file: LogFile) -> Stamps:
    """The column of a file's time stamps: by its name, by rising all the way, by its unit."""
    scored = [(points(column), -column.number, column) for column in file.columns]
    score, _, column = max(scored, default=(0.0, 0, None))
    if column is None or score < 2.0:
        rate = next((found for one in file.columns if (found := _RATE.search(one.label))), None)
        return Stamps(rate=f"{rate[1]} {(rate[2] or '')}Hz" if rate else "")
    unit, reason = _unit(column, file.path)
    steps = np.diff(column.good)
    stands = bool(0 < np.count_nonzero(steps) < STANDS * steps.size)
    still = "it stands still for many rows at a time, hence spread: check" if stands else ""
    return Stamps(column, unit, "; ".join(part for part in (reason, still) if part), stands=stands)


def points(column: Column) -> float:
    """How much speaks for a column being the file's time stamps; from 2 on it is believed."""
    good, name = column.good, column.name.strip()
    named = _TIME.fullmatch(name.rpartition(".")[2]) is not None
    if good.size < 2 or good.min() == good.max():
        return 2.0 * named + 1.5 if not good.size and is_written(column.text) else 0.0
    rises = is_clock(good)
    stated = fits(column.unit, "time") or column.written
    if column.unit and not stated and not named:
        return 0.0
    distinct = len(np.unique(good)) / good.size
    counts = 0.5 * (_COUNTS.fullmatch(name) is not None) + 0.2 * ("raw" in name.casefold()) + 0.3 * column.written
    return 2.0 * named + 1.5 * rises + (1.0 if stated else 0.0) + (distinct if rises or named else 0.0) - counts


def _unit(column: Column, path: Path) -> tuple[str, str]:
    """The unit of stamps, and why, where the log does not say."""
    if column.written or not column.good.size:
        return written_stamps(path) or "datetime", ""
    if fits(column.unit, "time"):
        return column.unit, ""
    words = re.findall(r"[a-z]+", column.name.casefold())
    said = next((_IN_NAME[word] for word in words if word in _IN_NAME), "")
    guess, reason = by_size(column)
    if said and words != ["seconds"]:
        return said, f"by its name {column.shown!r}: check"
    return guess, f"unit not stated in the log: check; {reason}"


def by_size(column: Column) -> tuple[str, str]:
    """The unit in which a clock's readings are possible, and the reason."""
    good = column.good
    level = float(np.median(good))
    for least, unit in EPOCHS:
        if level > least:
            return unit, f"{level:.4g} counts from 1970 in {unit}"
    step = typical_step(good) / column.stride
    if EXCEL[0] < level < EXCEL[1] and step < 1e-3:
        return "day", f"{level:.6g} is a date as spreadsheets count days"
    whole = bool(np.all(good == np.round(good)))
    for unit, seconds in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if step * seconds < (SLOWEST if whole or step > 1.0 else 2.5 * SLOWEST):
            rate = 1.0 / (step * seconds) if step > 0.0 else np.nan
            return unit, f"a step of {step:.3g} is {rate:.3g} samples a second"
    return "s", ""


def typical_step(stamps: Array) -> float:
    """Time between samples in the unit of the stamps (n,): the median of the steps that go up, over how many samples
    share a stamp; 0 where none goes up.
    """
    steps = np.diff(stamps)
    up = steps[steps > 0.0]
    return float(np.median(up)) * up.size / steps.size if up.size else 0.0


def is_written(text: str) -> bool:
    """Whether a text is a date with time, or a time of day."""
    return any(form.fullmatch(text.strip()) for _, form in _TEXT_STAMPS)


def written_stamps(path: Path) -> str:
    """ "datetime" or "clock" where a log of text has stamps that are written so; "" where it has none."""
    with path.open("rb") as file:
        head = b"".join(line[:4096] for _, line in zip(range(_LOOKED_AT), file, strict=False))
    text = head.decode("utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8", errors="replace")
    for name, form in _TEXT_STAMPS:
        # a comma may be a column's end or a decimal point; one stamp alone may stand above the columns
        for ends in (r"[\n\t;|]", r"[\n\t;|,]"):
            if sum(form.fullmatch(cell.strip().strip('"')) is not None for cell in re.split(ends, text)) > 1:
                return name
    return ""
