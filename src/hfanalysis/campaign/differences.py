"""What changed between two folders of products: which numbers, by how many of their standard deviations, and why."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isclose
from pathlib import Path
from typing import Any

from hfanalysis.products.disk import read_json
from hfanalysis.products.tidy import FILES, Row, rows_of_test

SAME = 1e-12
"""Relative difference below which two numbers are one. Source: double precision, and some digits that sums lose."""

MADE_FROM = {"raw": "the log", "test_toml": "test.toml", "effects": "the adopted effects", "parameters": "parameters"}
"""What a product is made from, beside the code: by its name in the provenance."""


@dataclass(frozen=True)
class Difference:
    """A quantity that is not what it was.

    ``deviations``: its change over the larger of its two standard deviations [-]; None where neither has one, or one of
    the numbers is not there.
    """

    test: str
    product: str
    name: str
    unit: str
    old: float | None
    new: float | None
    deviations: float | None
    verdict: str

    @property
    def relative(self) -> float | None:
        """Change over the old number [-]; None where there is none."""
        if self.old is None or self.new is None or self.old == 0.0:
            return None
        return (self.new - self.old) / abs(self.old)

    @property
    def weight(self) -> tuple[float, float]:
        """By which differences are put in order: deviations, where there are none what came or went, then parts."""
        gone = float("inf") if self.old is None or self.new is None else -1.0
        return (self.deviations if self.deviations is not None else gone, abs(self.relative or 0.0))

    def to_json(self) -> dict[str, Any]:
        """As it is printed with --json."""
        return {**vars(self), "relative": self.relative}


def differences(old: Path, new: Path) -> list[Difference]:
    """Between the products of a test in two folders, the largest change first, in deviations.

    A quantity whose number came or went is one; so is one whose verdict alone changed.
    """
    was, now = ({(row["product"], row["name"]): row for row in rows_of_test(folder)} for folder in (old, new))
    found = (_difference(key, was.get(key), now.get(key)) for key in dict.fromkeys([*was, *now]))
    return sorted((one for one in found if one is not None), key=lambda one: one.weight, reverse=True)


def _difference(key: tuple[str, str], was: Row | None, now: Row | None) -> Difference | None:
    one: Mapping[str, Any] = was or {}
    other: Mapping[str, Any] = now or {}
    old, new = one.get("value"), other.get("value")
    verdicts = [str(row.get("verdict") or "") for row in (one, other)]
    if _same(old, new) and verdicts[0] == verdicts[1]:
        return None
    verdict = verdicts[1] if verdicts[0] == verdicts[1] else f"{verdicts[0] or '–'} to {verdicts[1] or '–'}"
    known = other or one
    return Difference(known["test"], *key, known["unit"], old, new, _deviations(one, other), verdict)


def _same(old: float | None, new: float | None) -> bool:
    if old is None or new is None:
        return old is new
    return isclose(old, new, rel_tol=SAME, abs_tol=0.0)


def _deviations(one: Mapping[str, Any], other: Mapping[str, Any]) -> float | None:
    old, new = one.get("value"), other.get("value")
    std = max(one.get("std") or 0.0, other.get("std") or 0.0)
    return None if old is None or new is None or not std > 0.0 else abs(new - old) / std


def made_with(folder: Path) -> str:
    """The version that made a test's products, and a short digest of the code of all their stages; "" where there are
    none."""
    made = list(_provenances(folder))
    if not made:
        return ""
    codes = "".join(str(provenance.get("code", "")) for provenance in made)
    return f"{made[-1].get('hfanalysis', '')} ({hashlib.sha256(codes.encode()).hexdigest()[:8]})"


def other_inputs(old: Path, new: Path) -> list[str]:
    """What the products of a test were made from that is not the same, in words."""
    was, now = _inputs(old), _inputs(new)
    return [words for key, words in MADE_FROM.items() if was.get(key) != now.get(key)]


def _inputs(folder: Path) -> dict[str, Any]:
    """What the products were made from, over all of them."""
    found: dict[str, Any] = {}
    for provenance in _provenances(folder):
        for key in MADE_FROM:
            if key == "parameters":
                found.setdefault(key, []).append(provenance.get(key))
            elif provenance.get(key):
                found[key] = provenance[key]
    return found


def _provenances(folder: Path) -> Iterator[dict[str, Any]]:
    for name in FILES:
        path = folder / f"{name}.json"
        if path.is_file():
            yield read_json(path).get("provenance", {})


def pairs(old: Path, new: Path) -> tuple[list[tuple[str, Path, Path]], list[str], list[str]]:
    """Tests that are in both folders, with theirs in each, and those in the first or the second alone.

    A folder is one that holds folders of tests, or that of one test.
    """
    was, now = _tests(old), _tests(new)
    if len(was) == len(now) == 1 and _is_test(old) and _is_test(new):
        (name,) = now
        return [(name, old, new)], [], []
    both = [(name, was[name], now[name]) for name in was if name in now]
    return both, [name for name in was if name not in now], [name for name in now if name not in was]


def _tests(folder: Path) -> dict[str, Path]:
    if _is_test(folder):
        return {folder.resolve().name: folder}
    return {path.parent.name: path.parent for path in sorted(folder.glob(f"*/{FILES[0]}.json"))}


def _is_test(folder: Path) -> bool:
    return (folder / f"{FILES[0]}.json").is_file()


def beyond(found: Sequence[Difference], least: float) -> list[Difference]:
    """Those that changed by ``least`` deviations [-] at least, or that have no deviation to hold the change against."""
    return [one for one in found if one.deviations is None or one.deviations >= least or " to " in one.verdict]
