"""A section of a TOML file as a frozen dataclass whose fields know how to read themselves.

The messages are the point: each names the file, the dotted key, what was found and what was expected, and offers near
misses for misspelt keys.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, TypeVar

from hfanalysis.errors import InputError
from hfanalysis.units import Value, near, parse

T = TypeVar("T")
Read = Callable[[Any, "Where"], Any]
Check = Callable[[float], bool]


@dataclass(frozen=True)
class Where:
    """A place in a TOML file, for messages."""

    file: str
    key: str = ""

    def __truediv__(self, key: str | int) -> Where:
        step = f"[{key}]" if isinstance(key, int) else f".{key}"
        return Where(self.file, f"{self.key}{step}".removeprefix("."))

    def __str__(self) -> str:
        return f"{self.file}, {self.key}" if self.key else self.file

    def wrong(self, found: Any, expected: str) -> InputError:
        """The error that says what was found here and what was expected."""
        return InputError(f"{self}: found {found!r}; expected {expected}")


@dataclass(frozen=True)
class Range:
    """What a value may be, in words and as a test."""

    words: str
    holds: Check


POSITIVE = Range("more than zero", lambda x: x > 0)
NOT_NEGATIVE = Range("zero or more", lambda x: x >= 0)
NOT_ZERO = Range("not zero", lambda x: x != 0)
ANY = Range("", lambda x: True)


def between(low: float, high: float, words: str) -> Range:
    """A closed range in SI."""
    return Range(words, lambda x: low <= x <= high)


def key(read: Read, default: Any = MISSING) -> Any:
    """A field read from the key of its own name; required where there is no default."""
    if default is MISSING:
        return field(metadata={"read": read})
    return field(default=default, metadata={"read": read})


def quantity(dimension: str, allowed: Range = ANY) -> Read:
    """Reads a value with its unit into a :class:`Value` in SI."""

    def read(found: Any, where: Where) -> Value:
        value = parse(found, dimension, str(where))
        if not allowed.holds(value.value):
            raise where.wrong(found, f"a {dimension.replace('_', ' ')} that is {allowed.words}")
        return value

    return read


def number(allowed: Range = ANY) -> Read:
    """Reads a plain finite number."""

    def read(found: Any, where: Where) -> float:
        if isinstance(found, bool) or not isinstance(found, (int, float)) or not math.isfinite(found):
            raise where.wrong(found, "a finite number without quotes or unit")
        if not allowed.holds(found):
            raise where.wrong(found, f"a number that is {allowed.words}")
        return float(found)

    return read


def integer(least: int) -> Read:
    """Reads a whole number."""

    def read(found: Any, where: Where) -> int:
        if isinstance(found, bool) or not isinstance(found, int) or found < least:
            raise where.wrong(found, f"a whole number of at least {least}")
        return found

    return read


def text(found: Any, where: Where) -> str:
    """Reads text that is not empty."""
    if not isinstance(found, str) or not found.strip():
        raise where.wrong(found, "text in quotes")
    return found


def yes_or_no(found: Any, where: Where) -> bool:
    """Reads true or false."""
    if not isinstance(found, bool):
        raise where.wrong(found, "true or false")
    return found


def one_of(*choices: str) -> Read:
    """Reads one of a few words."""

    def read(found: Any, where: Where) -> str:
        if found not in choices:
            raise where.wrong(found, " or ".join(map(repr, choices)) + near(str(found), choices))
        return str(found)

    return read


def column(found: Any, where: Where) -> str | int:
    """Reads a column: its name in the log, or its number from 1."""
    if isinstance(found, bool) or not isinstance(found, (str, int)) or found == "":
        raise where.wrong(found, "a column's name in quotes, or its number counted from 1")
    if isinstance(found, int) and found < 1:
        raise where.wrong(found, "a column number counted from 1")
    return found


def list_of(read: Read) -> Read:
    """Reads a list that is not empty."""

    def read_all(found: Any, where: Where) -> tuple[Any, ...]:
        if not isinstance(found, Sequence) or isinstance(found, str) or not found:
            raise where.wrong(found, "a list in square brackets with at least one entry")
        return tuple(read(item, where / i) for i, item in enumerate(found))

    return read_all


def section(cls: type[T]) -> Callable[[Any, Where], T]:
    """Reads a table into a dataclass whose fields were made with :func:`key`."""

    def read(found: Any, where: Where) -> T:
        return build(cls, found, where)

    return read


def build(cls: type[T], found: Any, where: Where) -> T:
    """A table read into ``cls``; a method ``check(self, where)`` there may refuse the whole."""
    if not isinstance(found, Mapping):
        raise where.wrong(found, "a table of keys")
    readers = {f.name: f for f in fields(cls) if "read" in f.metadata}  # type: ignore[arg-type]
    _known_only(found, readers, where)
    missing = [n for n, f in readers.items() if n not in found and f.default is MISSING]
    if missing:
        raise InputError(f"{where}: key {missing[0]!r} is missing; expected it beside {_listed(found)}")
    made = cls(**{name: readers[name].metadata["read"](raw, where / name) for name, raw in found.items()})
    if hasattr(made, "check"):
        made.check(where)
    return made


def _known_only(found: Mapping[str, Any], known: Mapping[str, Any], where: Where) -> None:
    for name in found:
        if name not in known:
            offer = near(name, known) or f"; expected one of {', '.join(known)}"
            raise InputError(f"{where}: unknown key {name!r}{offer}")


def _listed(found: Mapping[str, Any]) -> str:
    return ", ".join(map(repr, found)) or "nothing: the table is empty"
