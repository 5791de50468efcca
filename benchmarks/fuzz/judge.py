"""Whether a case came out as it may: an answer, a refusal, or a number that moved and says so."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.fuzz.attempt import QUANTITIES
from benchmarks.fuzz.table import CHANNELS

DOUBTFUL = ("doubted", "not identifiable", "conditional", "stated")
"""Verdicts that are a caveat of the number by themselves."""


@dataclass(frozen=True)
class Judged:
    """``end``: answered, refused (2 or 3), or the defect; ``moved``: which quantities left their own interval;
    ``said``: something new is said; ``points``: it names what was hit."""

    end: str
    moved: tuple[str, ...]
    said: bool
    points: bool

    @property
    def silent(self) -> bool:
        """A number that moved, and nothing that points to why."""
        return bool(self.moved) and not self.points


def judge(row: Mapping[str, Any], base: Mapping[str, Any]) -> Judged:
    """A case's outcome beside that of the unspoilt test."""
    end = _end(row)
    moved = tuple(name for name in QUANTITIES if _moved(row["found"].get(name), base["found"].get(name)))
    new = _new(row, base)
    doubts = bool(moved) and all(_newly_doubtful(row["found"][name], base["found"][name]) for name in moved)
    points = doubts or any(_names(text, row["hit"]) for text in new)
    return Judged(end, moved, bool(new) or doubts, points)


def _newly_doubtful(now: Mapping[str, Any], before: Mapping[str, Any]) -> bool:
    """Whether the verdict is a caveat that the unspoilt number has not."""
    verdict = now.get("verdict") or ""
    return verdict.startswith(DOUBTFUL) and verdict != before.get("verdict")


def _end(row: Mapping[str, Any]) -> str:
    if row["status"] == 1:
        return "traceback"
    if row["status"] == -1:
        return "hang" if row["error"].startswith("hang") else "killed"
    if "Traceback" in row["said"]:
        return "traceback"
    return {0: "answer", 2: "refused (2)", 3: "refused (3)"}.get(row["status"], f"exit {row['status']}")


def _moved(now: Any, before: Any) -> bool:
    """Whether the unspoilt value lies outside of the interval that the spoilt one states for itself."""
    if not now or not before:
        return False
    low, high = _interval(now)
    return not low <= before["value"] <= high


def _interval(quantity: Mapping[str, Any]) -> tuple[float, float]:
    half = 1.96 * (quantity["std"] or 0.0)
    low, high = quantity.get("ci95") or (quantity["value"] - half, quantity["value"] + half)
    return float(low), float(high)


def _new(row: Mapping[str, Any], base: Mapping[str, Any]) -> list[str]:
    """What is said or found that the unspoilt test has not; numbers do not count."""
    before = {_without_numbers(text) for text in _texts(base)}
    return [text for text in _texts(row) if _without_numbers(text) not in before]


def _texts(row: Mapping[str, Any]) -> list[str]:
    quantities = [one for one in row["found"].values() if isinstance(one, dict)]
    reasons = [str(one[key]) for one in quantities for key in ("reason", "why") if one.get(key)]
    return [*row["said"].splitlines(), *row["found"].get("health", []), *reasons]


def _without_numbers(text: str) -> str:
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", text)


SYNONYMS = {
    "p_tank": ("tank",), "p_run": ("run line", "run"), "p_chamber": ("chamber", "p_c"), "thrust": ("load cell",),
    "p_purge": ("purge",), "m_tank": ("mass", "load cell", "scale"), "time": ("clock", "time"),
    "hole_area": ("hole area", "holes"),
}  # fmt: skip


def _names(text: str, hit: Sequence[str]) -> bool:
    """Whether a message names one of what was hit."""
    words = {word for name in hit for word in (name, *SYNONYMS.get(name, ()))}
    words |= {"all"} if set(CHANNELS) & set(hit) else set()
    return any(word and word.lower() in text.lower() for word in words)
