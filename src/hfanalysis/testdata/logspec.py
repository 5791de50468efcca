"""[log], [channels.*] and [[exclude]] of test.toml: where the numbers are and what they mean."""

# ruff: noqa: RUF009  (key() makes dataclass fields, not defaults)
from __future__ import annotations

import codecs
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.testdata.channels import CANONICAL
from hfanalysis.testdata.schema import (
    NOT_NEGATIVE,
    NOT_ZERO,
    POSITIVE,
    Where,
    build,
    column,
    integer,
    key,
    list_of,
    number,
    one_of,
    quantity,
    text,
    yes_or_no,
)
from hfanalysis.units import Value, dimension_of, is_gauge, near, unit_factor

DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "pipe": "|", "space": " ", "whitespace": " "}
FORMATS = ("csv", "mat", "lvm", "tdms")


def _delimiter(found: Any, where: Where) -> str:
    mark = DELIMITERS.get(found, found) if isinstance(found, str) else found
    if mark not in DELIMITERS.values():
        raise where.wrong(found, "one of , ; tab | or whitespace")
    return str(mark)


def _encoding(found: Any, where: Where) -> str:
    try:
        return codecs.lookup(text(found, where)).name
    except LookupError:
        raise where.wrong(found, "a text encoding such as 'utf-8', 'utf-16' or 'cp1252'") from None


def _time_unit(found: Any, where: Where) -> str:
    if found not in ("datetime", "clock"):
        unit_factor(text(found, where), "time", str(where))
    return str(found)


@dataclass(frozen=True)
class TimeSpec:
    """Where a file's or a channel's time stamps are.

    ``column``: name or number from 1; ``rate`` [Hz] stands for it in logs without stamps. ``unit``: of time, or
    "datetime" and "clock" for stamps written as dates or times of day (found by themselves). ``offset`` [s] is added to
    the stamps, which brings files with their own clocks together. ``spread``: samples that share a truncated stamp are
    spread evenly up to the next one.
    """

    column: str | int | None = key(column, None)
    unit: str = key(_time_unit, "s")
    offset: Value = key(quantity("time"), Value(0.0))
    rate: Value | None = key(quantity("frequency", POSITIVE), None)
    spread: bool = key(yes_or_no, False)

    def check(self, where: Where) -> None:
        if (self.column is None) == (self.rate is None):
            raise InputError(f"{where}: expected either 'column' (of the stamps) or 'rate' (of a log without them)")


def _time(found: Any, where: Where) -> TimeSpec:
    """A table, or just the column."""
    return build(TimeSpec, found if isinstance(found, Mapping) else {"column": found}, where)


@dataclass(frozen=True)
class FileSpec:
    """One log file and how to read it; None is detected from the file."""

    file: str = key(text)
    time: TimeSpec | None = key(_time, None)
    format: str | None = key(one_of(*FORMATS), None)
    delimiter: str | None = key(_delimiter, None)
    decimal: str | None = key(one_of(".", ","), None)
    header_rows: int | None = key(integer(0), None)
    encoding: str | None = key(_encoding, None)

    def check(self, where: Where) -> None:
        _two_marks(self.delimiter, self.decimal, where)


def _two_marks(delimiter: str | None, decimal: str | None, where: Where) -> None:
    if delimiter is not None and delimiter == decimal:
        raise InputError(f"{where}: delimiter and decimal are both {decimal!r}; expected two different marks")


def _file(found: Any, where: Where) -> FileSpec:
    return build(FileSpec, found if isinstance(found, Mapping) else {"file": found}, where)


@dataclass(frozen=True)
class LogSpec:
    """[log]: the files; what is given beside ``files`` holds for every file that does not say otherwise."""

    files: tuple[FileSpec, ...] = key(list_of(_file))
    time: TimeSpec | None = key(_time, None)
    format: str | None = key(one_of(*FORMATS), None)
    delimiter: str | None = key(_delimiter, None)
    decimal: str | None = key(one_of(".", ","), None)
    header_rows: int | None = key(integer(0), None)
    encoding: str | None = key(_encoding, None)

    def check(self, where: Where) -> None:
        names = [spec.file for spec in self.files]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"{where / 'files'}: {name!r} is named twice; expected every file once")
        shared = ("time", "format", "delimiter", "decimal", "header_rows", "encoding")
        filled = tuple(
            replace(spec, **{n: getattr(self, n) for n in shared if getattr(spec, n) is None}) for spec in self.files
        )
        for spec in filled:
            _two_marks(spec.delimiter, spec.decimal, where)
        object.__setattr__(self, "files", filled)

    def named(self, file: str) -> FileSpec:
        """The file's specification."""
        return next(spec for spec in self.files if spec.file == file)


@dataclass(frozen=True)
class ChannelSpec:
    """[channels.NAME]: SI = unit(scale * reading + offset).

    ``accuracy`` [SI], one standard deviation of the sensor's bias; None takes the class default. ``missing``: readings
    that stand for none (999 of an open thermocouple), as logged. ``dimension`` and ``name`` come from the table's name
    and unit.
    """

    column: str | int = key(column)
    unit: str = key(lambda found, where: found if found == "" else text(found, where), "")
    file: str | None = key(text, None)
    time: TimeSpec | None = key(_time, None)
    scale: float = key(number(NOT_ZERO), 1.0)
    offset: float = key(number(), 0.0)
    gauge: bool | None = key(yes_or_no, None)
    accuracy: Value | None = key(lambda found, where: found, None)
    zero: str | None = key(one_of("ambient", "none"), None)
    tare: str = key(one_of("auto", "before", "before_after", "none"), "none")
    missing: tuple[float, ...] = key(list_of(number()), ())
    name: str = ""
    dimension: str = "dimensionless"

    @property
    def factor(self) -> tuple[float, float]:
        """(scale, offset) from the logged reading to SI (gauge pressures without the ambient pressure)."""
        scale, offset = unit_factor(self.unit, self.dimension, self.name)
        return scale * self.scale, scale * self.offset + offset


@dataclass(frozen=True)
class Exclusion:
    """[[exclude]]: a bad stretch [s, log time] of some channels; of all where none is named."""

    start: Value = key(quantity("time"))
    end: Value = key(quantity("time"))
    channels: tuple[str, ...] = key(list_of(text), ())

    def check(self, where: Where) -> None:
        if not self.start.value < self.end.value:
            raise InputError(
                f"{where}: start {self.start.value:g} s is not before end {self.end.value:g} s; expected start < end"
            )


_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_RESERVED = re.compile(r"time(_\d+)?|.*_(flags|raw)")


def channels(found: Any, where: Where) -> dict[str, ChannelSpec]:
    """[channels]: canonical name -> specification."""
    if not isinstance(found, Mapping) or not found:
        raise where.wrong(found, "at least one table [channels.NAME] such as [channels.p_tank]")
    made = {name: _channel(name, raw, where / name) for name, raw in found.items()}
    _no_column_twice(made, where)
    return made


def _channel(name: str, found: Any, where: Where) -> ChannelSpec:
    if not _NAME.fullmatch(name) or _RESERVED.fullmatch(name):
        raise where.wrong(name, "a name of letters, digits and _ (not time, nor ending in _flags or _raw)")
    spec = build(ChannelSpec, found, where)
    if name in CANONICAL and CANONICAL[name] != "dimensionless" and not spec.unit:
        raise InputError(f"{where}: key 'unit' is missing; expected a unit of {CANONICAL[name]}")
    dimension = CANONICAL.get(name) or dimension_of(spec.unit, str(where / "unit"))
    unit_factor(spec.unit, dimension, str(where / "unit"))
    accuracy = _accuracy(spec.accuracy, dimension, where / "accuracy")
    spec = replace(spec, name=name, dimension=dimension, accuracy=accuracy)
    _fits_dimension(spec, where)
    return replace(spec, gauge=_gauge(spec, where))


def _accuracy(found: Any, dimension: str, where: Where) -> Value | None:
    if found is None:
        return None
    difference = f"{dimension}_difference" if dimension in ("pressure", "temperature") else dimension
    value: Value = quantity(difference, NOT_NEGATIVE)(found, where)
    return value


def _fits_dimension(spec: ChannelSpec, where: Where) -> None:
    """Gauge and zero are for pressures, tare for cells that weigh or push."""
    if spec.dimension != "pressure":
        for name in ("gauge", "zero"):
            if getattr(spec, name) not in (None, False, "none"):
                raise InputError(f"{where / name}: found on a {spec.dimension} channel; expected on pressures only")
    if spec.tare != "none" and spec.dimension not in ("force", "mass", "voltage", "dimensionless"):
        raise InputError(f"{where / 'tare'}: found on a {spec.dimension} channel; expected on forces and masses only")


def _gauge(spec: ChannelSpec, where: Where) -> bool:
    """Whether the ambient pressure is still to be added: as stated, or as the unit says."""
    if spec.dimension != "pressure":
        return False
    by_unit = is_gauge(spec.unit)
    if by_unit and spec.gauge is False:
        raise InputError(f"{where}: unit {spec.unit!r} is a gauge pressure but gauge = false; expected them to agree")
    absolute = spec.unit.replace("(a)", "a").casefold() in ("psia", "bara", "kpaa", "mpaa")
    if spec.gauge and absolute:
        raise InputError(f"{where}: unit {spec.unit!r} is an absolute pressure but gauge = true; expected agreement")
    return by_unit or bool(spec.gauge)


def _no_column_twice(made: Mapping[str, ChannelSpec], where: Where) -> None:
    seen: dict[tuple[Any, Any], str] = {}
    for name, spec in made.items():
        first = seen.setdefault((spec.file, spec.column), name)
        if first != name:
            raise InputError(
                f"{where / name}.column: column {spec.column!r} is already {first}; expected every column once"
            )


def exclusions(found: Any, where: Where, known: Mapping[str, ChannelSpec]) -> tuple[Exclusion, ...]:
    """[[exclude]]; the channels named must exist."""
    made: tuple[Exclusion, ...] = list_of(lambda raw, at: build(Exclusion, raw, at))(found, where)
    for i, exclusion in enumerate(made):
        for name in exclusion.channels:
            if name not in known:
                raise InputError(
                    f"{where / i / 'channels'}: {name!r} is no channel of this test{near(name, known)}; "
                    f"expected some of {', '.join(known)}"
                )
    return made
