"""[log], [channels.*] and [[exclude]] of test.toml: where the numbers are and what they mean."""

from __future__ import annotations

import codecs
import re
from collections.abc import Mapping
from dataclasses import KW_ONLY, field, replace
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, SkipValidation

from hfanalysis.record.accuracy import read_accuracy
from hfanalysis.record.channels import CANONICAL
from hfanalysis.record.formats import FORMATS
from hfanalysis.record.schema import (
    ANY,
    DERIVED,
    POSITIVE,
    Column,
    Date,
    Instant,
    ListOf,
    Number,
    Refused,
    Section,
    Text,
    YesOrNo,
    one_of,
    quantity,
    read_quantity,
    refusing,
    section,
)
from hfanalysis.units import Value, dimension_of, is_gauge, near, unit_factor

AUTO = "auto"
"""What stands for an offset that is to be found."""
DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "pipe": "|", "space": " ", "whitespace": " "}


def _delimiter(found: str) -> str:
    mark = DELIMITERS.get(found, found)
    if mark not in DELIMITERS.values():
        raise ValueError("one of , ; tab | or whitespace")
    return mark


def _encoding(found: str) -> str:
    try:
        return codecs.lookup(found).name
    except LookupError:
        raise ValueError("a text encoding such as 'utf-8', 'utf-16' or 'cp1252'") from None


def _time_unit(found: str) -> str:
    if found not in ("datetime", "clock"):
        with refusing():
            unit_factor(found, "time", "")
    return found


def _offset(found: Any) -> Value | None:
    return None if found == AUTO else read_quantity(found, "time", ANY)


def _not_zero(found: float) -> float:
    if found == 0.0:
        raise ValueError("a number that is not zero")
    return found


def _under(key: str) -> BeforeValidator:
    """What is no table stands for the table's one key that is needed."""
    return BeforeValidator(lambda found: found if isinstance(found, (Mapping, Section)) else {key: found})


Offset = Annotated[Value | None, PlainValidator(_offset)]
"""A time, None where it is to be found."""


@section
class TimeSpec(Section):
    """Where a file's or a channel's time stamps are.

    ``column``: name or number from 1; ``rate`` [Hz] stands for it in logs without stamps. ``unit``: of time, or
    "datetime" and "clock" for stamps written as dates or times of day (found by themselves). ``offset`` [s] is added to
    the stamps, which brings files with their own clocks together; "auto" (None here): found by what the channels show
    together. ``spread``: samples that share a truncated stamp are spread evenly up to the next one; None: where as many
    share each.
    """

    column: Column | None = None
    unit: Annotated[Text, AfterValidator(_time_unit)] = "s"
    offset: Offset = Value(0.0)
    rate: Annotated[Value, quantity("frequency", POSITIVE)] | None = None
    spread: YesOrNo | None = None

    def check(self) -> None:
        if (self.column is None) == (self.rate is None):
            raise Refused("expected either 'column' (of the stamps) or 'rate' (of a log without them)")


Time = Annotated[TimeSpec, _under("column")]


@section
class ReadingOptions(Section):
    """How to read a log file; None is detected from the file."""

    _: KW_ONLY
    time: Time | None = None
    format: Annotated[str, one_of(FORMATS)] | None = None
    delimiter: Annotated[str, AfterValidator(_delimiter)] | None = None
    decimal: Literal[".", ","] | None = None
    header_rows: Annotated[int, Field(strict=True, ge=0)] | None = None
    encoding: Annotated[Text, AfterValidator(_encoding)] | None = None

    def check(self) -> None:
        if self.delimiter is not None and self.delimiter == self.decimal:
            raise Refused(f"delimiter and decimal are both {self.decimal!r}; expected two different marks")


@section
class FileSpec(ReadingOptions):
    """One log file and how to read it."""

    file: Text


@section
class LogSpec(ReadingOptions):
    """[log]: the files; what is given beside ``files`` holds for every file that does not say otherwise.

    ``firing``: which of several in the log is analysed, counted from 1; None takes the largest.
    """

    files: ListOf[Annotated[FileSpec, _under("file")]]
    firing: Annotated[int, Field(strict=True, ge=1)] | None = None

    def check(self) -> None:
        super().check()
        names = [spec.file for spec in self.files]
        for name in names:
            if names.count(name) > 1:
                raise Refused(f"{name!r} is named twice; expected every file once", "files")
        object.__setattr__(self, "files", tuple(self._completed(spec) for spec in self.files))

    def _completed(self, spec: FileSpec) -> FileSpec:
        shared = (f for f in ReadingOptions.__dataclass_fields__ if getattr(spec, f) is None)
        return replace(spec, **{name: getattr(self, name) for name in shared})

    def named(self, file: str) -> FileSpec:
        """The file's specification."""
        return next(spec for spec in self.files if spec.file == file)


@section
class ChannelSpec(Section):
    """[channels.NAME]: SI = unit(scale * reading + offset).

    ``accuracy`` [SI], one standard deviation of the sensor's bias; None takes the class default. ``calibrated``: the
    day on which it was calibrated in place, with known loads on the stand itself. ``missing``: readings that stand for
    none (999 of an open thermocouple), as logged. ``gauge``: the ambient pressure is still to be added, as stated or as
    the unit says. ``trust``: why the channel is to be believed, whatever its health seems. ``tap``: where the chamber's
    gauge sits, at its head or aft of the grain. ``sensor``: its serial number, by which a campaign follows its zero.
    """

    column: Column
    unit: str = ""
    file: Text | None = None
    time: Time | None = None
    scale: Annotated[Number, AfterValidator(_not_zero)] = 1.0
    offset: Number = 0.0
    gauge: YesOrNo | None = None
    accuracy: Annotated[Value | None, SkipValidation] = None
    calibrated: Date | None = None
    zero: Literal["ambient", "none"] | None = None
    tare: Literal["auto", "before", "before_after", "none"] = "none"
    missing: ListOf[Number] = ()
    trust: Text | None = None
    tap: Literal["head", "aft"] | None = None
    sensor: Text | None = None
    name: str = field(default="", metadata=DERIVED)

    @cached_property
    def dimension(self) -> str:
        """The dimension of a canonical channel, else the unit's."""
        return CANONICAL.get(self.name) or dimension_of(self.unit, "")

    @property
    def factor(self) -> tuple[float, float]:
        """(scale [SI per logged unit], offset [SI]): SI = scale x reading + offset (gauge pressures without the ambient
        pressure).
        """
        scale, offset = unit_factor(self.unit, self.dimension, self.name)
        return scale * self.scale, scale * self.offset + offset

    def check(self) -> None:
        self._unit_fits()
        self._corrections_fit()
        self._gauge_fits()
        self._tap_fits()
        if self.accuracy is not None:
            differs = self.dimension in ("pressure", "temperature")
            dimension = f"{self.dimension}_difference" if differs else self.dimension
            object.__setattr__(self, "accuracy", read_accuracy(self.accuracy, dimension))
        object.__setattr__(self, "gauge", self.dimension == "pressure" and (is_gauge(self.unit) or bool(self.gauge)))

    def _unit_fits(self) -> None:
        if not self.unit.strip() and CANONICAL.get(self.name, "dimensionless") != "dimensionless":
            raise Refused(f"key 'unit' is missing; expected a unit of {CANONICAL[self.name]}")
        with refusing("unit"):
            unit_factor(self.unit, self.dimension, "")

    def _corrections_fit(self) -> None:
        """Gauge and zero are for pressures, tare for cells that weigh or push."""
        if self.dimension != "pressure":
            for key in ("gauge", "zero"):
                if getattr(self, key) not in (None, False, "none"):
                    raise Refused(f"found on a {self.dimension} channel; expected on pressures only", key)
        if self.tare != "none" and self.dimension not in ("force", "mass", "voltage", "dimensionless"):
            raise Refused(f"found on a {self.dimension} channel; expected on forces and masses only", "tare")

    def _tap_fits(self) -> None:
        if self.tap is not None and self.name != "p_chamber":
            raise Refused("found on another channel; expected on p_chamber only", "tap")

    def _gauge_fits(self) -> None:
        """What is stated must not contradict the unit."""
        absolute = self.unit.replace("(a)", "a").casefold() in ("psia", "bara", "kpaa", "mpaa")
        if self.gauge and absolute:
            raise Refused(f"unit {self.unit!r} is an absolute pressure but gauge = true; expected agreement")
        if self.gauge is False and self.dimension == "pressure" and is_gauge(self.unit):
            raise Refused(f"unit {self.unit!r} is a gauge pressure but gauge = false; expected them to agree")


_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_RESERVED = re.compile(r"time(_\d+)?|.*_(flags|raw)")


def _named(found: Any) -> Any:
    """Every table with its own name."""
    if not isinstance(found, Mapping) or not found:
        raise ValueError("at least one table [channels.NAME] such as [channels.p_tank]")
    for name, table in found.items():
        if not _NAME.fullmatch(name) or _RESERVED.fullmatch(name):
            expected = "a name of letters, digits and _ (not time, nor ending in _flags or _raw)"
            raise Refused(f"found {name!r}; expected {expected}", name)
        if isinstance(table, Mapping) and "name" in table:
            raise Refused("unknown key 'name'; the table's own name is the channel's", name)
    return {name: {**t, "name": name} if isinstance(t, Mapping) else t for name, t in found.items()}


def _no_column_twice(made: dict[str, ChannelSpec]) -> dict[str, ChannelSpec]:
    seen: dict[tuple[Any, Any], str] = {}
    for name, spec in made.items():
        first = seen.setdefault((spec.file, spec.column), name)
        if first != name:
            raise Refused(f"column {spec.column!r} is already {first}; expected every column once", name, "column")
    return made


Channels = Annotated[dict[str, ChannelSpec], BeforeValidator(_named), AfterValidator(_no_column_twice)]


@section
class Exclusion(Section):
    """[[exclude]]: a bad stretch [s, log time] of some channels; of all where none is named."""

    start: Instant
    end: Instant
    channels: ListOf[Text] = ()

    def check(self) -> None:
        start, end = self.start.value, self.end.value
        if not start < end:
            raise Refused(f"start {start:g} s is not before end {end:g} s; expected start < end")

    def check_channels(self, known: Mapping[str, ChannelSpec], *keys: str | int) -> None:
        """Refuses a channel that is not there."""
        for name in self.channels:
            if name not in known:
                among = f"{near(name, known)}; expected some of {', '.join(known)}"
                raise Refused(f"{name!r} is no channel of this test{among}", *keys, "channels")
