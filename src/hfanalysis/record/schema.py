"""The words in which sections of test.toml and engine files are declared, on top of pydantic.

A section is a frozen dataclass that pydantic fills and checks. A validator here raises ``ValueError`` with what was
expected, or :class:`Refused` with the whole sentence; :mod:`hfanalysis.record.document` adds the file and the key.
"""

from __future__ import annotations

import copy
import datetime
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import Annotated, Any, Self, TypeVar, cast, dataclass_transform

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainValidator, model_validator
from pydantic.dataclasses import dataclass as validated
from pydantic_core import PydanticKnownError

from hfanalysis.errors import InputError
from hfanalysis.units import Value, near, parse

T = TypeVar("T")


class Refused(ValueError):
    """The whole sentence about the section at hand, or about the key reached from it through ``keys``."""

    def __init__(self, sentence: str, *keys: str | int) -> None:
        super().__init__(sentence)
        self.keys = keys


def unknown_key(name: str, known: Iterable[str]) -> Refused:
    """The refusal of a key that no field has, with the keys that are meant."""
    return Refused(f"unknown key {name!r}{near(name, known) or '; expected some of ' + ', '.join(known)}")


@contextmanager
def refusing(*keys: str | int) -> Iterator[None]:
    """What the unit system says about a value becomes a refusal."""
    try:
        yield
    except InputError as error:
        raise Refused(str(error).removeprefix(": "), *keys) from None


@dataclass_transform(frozen_default=True)
def section(cls: type[T]) -> type[T]:
    """A table of a TOML file: frozen, validated, no key beside its fields; built when it is first needed."""
    return cast(type[T], validated(frozen=True, config=ConfigDict(extra="forbid", defer_build=True))(cls))


def one_of(words: Iterable[str]) -> PlainValidator:
    """One of these words, as ``Literal`` has it, for words that a registry has."""
    *first, last = map(repr, words)

    def check(found: object) -> str:
        if not isinstance(found, str) or repr(found) not in (*first, last):
            raise PydanticKnownError("literal_error", {"expected": f"{', '.join(first)} or {last}"})
        return found

    return PlainValidator(check)


DERIVED = {"derived": True}
"""Marks a field that no key of the file gives."""


@section
class Section:
    """What every section has: near misses for misspelled keys, and a place for checks across its keys."""

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, found: Any) -> Any:
        known = [field.name for field in fields(cls) if field.metadata != DERIVED]
        for name in found if isinstance(found, Mapping) else ():
            if name not in cls.__dataclass_fields__:
                raise unknown_key(name, known)
        return found

    @model_validator(mode="after")
    def _checked(self) -> Self:
        self.check()
        return self

    def check(self) -> None:
        """Refuses what single keys cannot tell."""

    def _not_both(self, one: str, other: str) -> None:
        if getattr(self, one) is not None and getattr(self, other) is not None:
            raise Refused(f"both {one!r} and {other!r} are given; expected one of them")


@dataclass(frozen=True)
class Range:
    """What a value may be, in words and as a test."""

    words: str
    holds: Callable[[float], bool]


POSITIVE = Range("more than zero", lambda x: x > 0)
NOT_NEGATIVE = Range("zero or more", lambda x: x >= 0)
ANY = Range("", lambda x: True)


def between(low: float, high: float, words: str) -> Range:
    """A closed range; ``low`` and ``high`` [SI]."""
    return Range(words, lambda x: low <= x <= high)


def quantity(dimension: str, allowed: Range = ANY) -> PlainValidator:
    """Reads a value with its unit, and +/- where stated, into SI."""
    return PlainValidator(lambda found: read_quantity(found, dimension, allowed))


def _a(dimension: str) -> str:
    """A dimension with its article."""
    if dimension == "dimensionless":
        return "a number"
    words = dimension.replace("_", " ")
    return f"{'an' if words[0] in 'aeiou' else 'a'} {words}"


def read_quantity(found: Any, dimension: str, allowed: Range, *keys: str) -> Value:
    """What :func:`quantity` does, for a key whose dimension another key decides."""
    with refusing(*keys):
        value = found if isinstance(found, Value) else parse(found, dimension, "")
    if not allowed.holds(value.value):
        raise Refused(f"found {found!r}; expected {_a(dimension)} that is {allowed.words}", *keys)
    return value


def changed(made: T, **changes: Any) -> T:
    """The same section with other values in some fields, which are not checked again."""
    new = copy.copy(made)
    for name, value in changes.items():
        object.__setattr__(new, name, value)
    return new


def _column(found: Any) -> str | int:
    if isinstance(found, bool) or not isinstance(found, (str, int)) or found == "":
        raise ValueError("a column's name in quotes, or its number counted from 1")
    if isinstance(found, int) and found < 1:
        raise ValueError("a column number counted from 1")
    return found


LONGEST_NAME = 200
"""Bytes of a name [B]. Source: file systems take 255, of which the endings of products need some."""


def unsafe(name: str) -> bool:
    """Whether a name would be no file of its own in the folder meant, or none that can be read in a message."""
    separated = any(mark in name for mark in "/\\") or name in (".", "..")
    return separated or name != name.strip() or not name.isprintable() or len(name.encode()) > LONGEST_NAME


def _name(found: str) -> str:
    if unsafe(found):
        raise ValueError(f"a name that a file can have: no path separators, at most {LONGEST_NAME} bytes")
    return found


def _date(found: Any) -> datetime.date:
    try:
        found = datetime.date.fromisoformat(found) if isinstance(found, str) else found
    except ValueError:
        found = None
    if not isinstance(found, datetime.date):
        raise ValueError("a date such as 2022-04-03")
    return found.date() if isinstance(found, datetime.datetime) else found


Text = Annotated[str, Field(pattern=r"\S")]
Date = Annotated[datetime.date, BeforeValidator(_date)]
Name = Annotated[Text, AfterValidator(_name)]
YesOrNo = Annotated[bool, Field(strict=True)]
Count = Annotated[int, Field(strict=True, ge=1)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0.0)]
NotNegative = Annotated[Number, Field(ge=0.0)]
Column = Annotated[str | int, BeforeValidator(_column)]
ListOf = Annotated[tuple[T, ...], Field(min_length=1)]

Factor = Annotated[Value, quantity("dimensionless", POSITIVE)]
Share = Annotated[Value, quantity("dimensionless", NOT_NEGATIVE)]
UpToTwo = Annotated[Value, quantity("dimensionless", between(0.0, 2.0, "between 0 and 2"))]
Length = Annotated[Value, quantity("length", POSITIVE)]
Place = Annotated[Value, quantity("length", NOT_NEGATIVE)]
Altitude = Annotated[Value, quantity("length", between(-500.0, 9000.0, "between -500 and 9000 m"))]
Area = Annotated[Value, quantity("area", POSITIVE)]
Mass = Annotated[Value, quantity("mass", POSITIVE)]
Remainder = Annotated[Value, quantity("mass", NOT_NEGATIVE)]
Volume = Annotated[Value, quantity("volume", POSITIVE)]
Room = Annotated[Value, quantity("volume", NOT_NEGATIVE)]
Duration = Annotated[Value, quantity("time", POSITIVE)]
Instant = Annotated[Value, quantity("time")]
PressureDifference = Annotated[Value, quantity("pressure_difference", NOT_NEGATIVE)]
