"""What each figure must reach and should reach, and how it stands."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

Range = tuple[float, float]


@dataclass(frozen=True)
class Target:
    """Closed ranges that a figure must, and should, lie in; None where nothing is asked."""

    must: Range | None = None
    aim: Range | None = None
    unit: str = ""

    def text(self, wanted: Range | None) -> str:
        """A range in words."""
        if wanted is None:
            return "-"
        low, high = wanted
        if low == -inf:
            return f"<= {high:g}{self.unit}"
        return f">= {low:g}{self.unit}" if high == inf else f"{low:g}-{high:g}{self.unit}"

    def verdict(self, value: float | None) -> str:
        """missed, met (what it must), or aim; empty where nothing is asked or measured."""
        if value is None or (self.must is None and self.aim is None):
            return ""
        if self.aim is not None and self.aim[0] <= value <= self.aim[1]:
            return "aim"
        if self.must is None:
            return "below aim"
        return "met" if self.must[0] <= value <= self.must[1] else "missed"


def _least(must: float | None, aim: float | None = None) -> Target:
    return Target(None if must is None else (must, inf), None if aim is None else (aim, inf))


def _most(must: float, aim: float, unit: str = "") -> Target:
    return Target((-inf, must), (-inf, aim), unit)


TARGETS: dict[str, Target] = {
    "exact_name": _least(0.95),
    "exact_name_well_apart": _least(None, 0.99),
    "twin_group": _least(0.97, 0.99),
    "set90_coverage": _least(0.88, 0.90),
    "set90_size": _most(1.5, 1.2),
    "sure_and_wrong": _most(0.01, 0.003),
    "false_alarm": _most(0.02, 0.01),
    "outside_unknown_and_equation": _least(0.85, 0.95),
    "pair_both": _least(0.80, 0.92),
    "calibration_error": _most(0.05, 0.02),
    "size_in_90_interval": Target((0.85, 0.95), (0.88, 0.92)),
    "gap_closed_same": _least(0.95, 0.99),
    "gap_closed_held_out": _least(0.9, 0.97),
    "gap_closed_other_test": _least(0.8, 0.95),
    "equation_first": _least(0.95),
    "phase": _least(0.95),
    "onset_in_95_band": Target((0.90, 0.98)),
    "no_source_on_none": _least(0.98),
    "source_in_90_band": Target((0.85, 0.95)),
    **{name: _most(60.0, 15.0, " s") for name in ("runtime", "runtime_90", "runtime_max")},
}


def row(name: str, figure: dict[str, Any], what: str | None = None) -> str:
    """One line of the table: value, limits, cases, must, aim, how it stands."""
    target = TARGETS.get(name, Target())
    must, aim = target.text(target.must), target.text(target.aim)
    value = figure["value"]
    if value is None:
        return f"| {what or name} | - | - | {figure['n']} | {must} | {aim} | |"
    limits = "-" if figure["low"] is None else f"{figure['low']:.3f} to {figure['high']:.3f}"
    return f"| {what or name} | {value:.3f} | {limits} | {figure['n']} | {must} | {aim} | {target.verdict(value)} |"
