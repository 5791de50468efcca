"""Tests that meet a condition on their quantities: ``C_i > 0.4 and m < 1 and stand = 'mcgill'``.

A condition is SQL's, as SQLite knows it, over a table of one row per test that is made in memory: its columns are what
the condition names. Nothing but that table can be read, and nothing be written.
"""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.products.tidy import Row
from hfanalysis.quantity import CONDITIONAL, DERIVED, IDENTIFIED, STATED
from hfanalysis.units import near

BELIEVED = ("", IDENTIFIED, DERIVED, STATED, CONDITIONAL)
"""Verdicts of quantities that a condition takes; doubted and refused ones only where all are asked for."""

FACTS = ("test", "stand", "kind", "source", "date")
"""What a condition may ask of a test beside its quantities: as [test] states it."""

_WORDS = re.compile(r"'(?:[^']|'')*'|\"([^\"]+)\"|(?<![\w.])([A-Za-z_][\w.]*)(?![\w.])(?!\s*\()")
"""Texts in single quotes; names in double quotes or plain; a name before a bracket is a function."""

_KEYWORDS = frozenset(("and", "or", "not", "is", "null", "like", "in", "between", "glob", "true", "false", "case",
                       "when", "then", "else", "end"))  # fmt: skip
"""Words of SQL that are no names."""

_FUNCTIONS = frozenset(("abs", "min", "max", "round", "coalesce", "ifnull", "like", "glob", "lower", "upper", "length"))
"""Functions of SQLite that a condition may use: none reads or loads anything."""

_ALLOWED = (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ)


@dataclass(frozen=True)
class Asked:
    """A test as a condition sees it: its ``facts``, and its quantities by every name that they go by."""

    facts: Mapping[str, str | None]
    quantities: Mapping[str, Row]


def asked_of(rows: Iterable[Row], facts: Mapping[str, str | None]) -> Asked:
    """A test's quantities, its ``rows``, by their way through a product ("validation.performance.measured.peak_thrust")
    and by the last word of it alone, which the first of them has, those of measurement before those of a model."""
    long: dict[str, Row] = {}
    short: dict[str, Row] = {}
    for row in rows:
        long[f"{row['product']}.{row['name']}"] = row
        short.setdefault(row["name"].rpartition(".")[2], row)
    for row in long.values():  # what a product says first hand goes before what stands deeper in it
        if "." not in row["name"]:
            short[row["name"]] = row
    return Asked(facts, {**short, **long})


def names_in(condition: str) -> list[str]:
    """What a condition names, each once.

    >>> names_in("C_i > 0.4 and abs(m) < 1 and stand = 'C_i m' or \\"flight.apogee\\" is null")
    ['C_i', 'm', 'stand', 'flight.apogee']
    """
    words = (quoted or plain for quoted, plain in _WORDS.findall(condition))
    return list(dict.fromkeys(word for word in words if word and word.lower() not in _KEYWORDS))


def matching(tests: Mapping[str, Asked], condition: str, doubted: bool = False) -> list[str]:
    """The tests that meet a condition, by name; ``doubted``: doubted and refused numbers count, too.

    Raises InputError where it names what no test has, or is no condition.
    """
    names = names_in(condition)
    known = dict.fromkeys([*FACTS, *(name for test in tests.values() for name in test.quantities)])
    for name in names:
        if name not in known:
            raise InputError(f"{name!r}: expected a quantity of these tests, or {', '.join(FACTS)}{near(name, known)}")
    columns = list(dict.fromkeys(["test", *names]))
    with closing(sqlite3.connect(":memory:")) as table:
        table.execute(f"create table tests ({', '.join(map(_quoted, columns))})")
        rows = [[name, *(_value(test, column, doubted) for column in columns[1:])] for name, test in tests.items()]
        table.executemany(f"insert into tests values ({', '.join('?' * len(columns))})", rows)
        table.set_authorizer(_only_reads)
        try:
            found = table.execute(f"select test from tests where {_as_sql(condition)}")
            return [name for (name,) in found]
        except sqlite3.Error as error:
            text = f"{condition!r} is no condition: {error}; expected one such as C_i > 0.3 and m < 1"
            raise InputError(text) from None


def _value(test: Asked, name: str, doubted: bool) -> float | str | None:
    if name in FACTS:
        return test.facts.get(name)
    row = test.quantities.get(name)
    if row is None or not (doubted or row["verdict"] in BELIEVED):
        return None
    return float(row["value"]) if row["value"] is not None else None


def _quoted(name: str) -> str:
    return '"{}"'.format(name.replace('"', '""'))


def _as_sql(condition: str) -> str:
    """The condition with names that hold a point in double quotes, as SQL has them."""

    def quoted(found: re.Match[str]) -> str:
        plain = found.group(2)
        return _quoted(plain) if plain and "." in plain else found.group(0)

    return _WORDS.sub(quoted, condition)


def _only_reads(action: int, one: str | None, other: str | None, *_: Any) -> int:
    """SQLite's authorizer: the table may be read and plain functions called, and nothing else."""
    if action in _ALLOWED or (action == sqlite3.SQLITE_FUNCTION and other in _FUNCTIONS):
        return sqlite3.SQLITE_OK
    return sqlite3.SQLITE_DENY


def shown_of(test: Asked, names: Sequence[str]) -> list[Row]:
    """The rows behind what a condition names, as far as the test has them."""
    return [test.quantities[name] for name in names if name in test.quantities]
