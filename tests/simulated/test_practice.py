"""What a verdict on a practice case is worth, and that what was found is found once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from benchmarks import practice
from benchmarks.practice import Outcome, judged, kept


def found(verdict: str, *names: str, **more: Any) -> Outcome:
    effects = [{"name": name} for name in names]
    product = {"verdict": verdict, "effects": effects, "set90": [*names], "localisation": [], **more}
    return Outcome("X1", product, 1.0)


@pytest.mark.parametrize(
    ("hidden", "one", "worth"),
    [
        ("none", found("none"), "right"),
        ("none", found("named", "tank_heat"), "false claim"),
        ("tank_heat", found("named", "tank_heat"), "right"),
        ("tank_heat", found("none"), "not seen"),
        ("tank_heat", found("named", "tank_heat", "n2_purge"), "right, and more"),
        ("tank_heat", found("unknown", localisation=[{"equation": "tank_energy"}]), "right equation"),
        ("tank_heat", found("unknown", localisation=[{"equation": "nozzle"}]), "wrong"),
        ({"tank_heat": 1.0, "n2_purge": 1.0}, found("named", "tank_heat"), "in the set"),
        ("nozzle_blockage", found("unknown"), "right"),
        ("nozzle_blockage", found("named", "nozzle_divergence"), "not called unknown"),
        ("nozzle_blockage", found("none"), "not called unknown"),
    ],
)
def test_a_verdict_is_judged_by_what_was_hidden(hidden: object, one: Outcome, worth: str) -> None:
    assert judged(one, {"effect": hidden})[1] == worth


def test_what_was_found_is_found_once_by_each_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def diagnosed(cases: Path, name: str, scratch: Path) -> Outcome:
        asked.append(name)
        return found("none")

    monkeypatch.setattr(practice, "CACHE", tmp_path)
    monkeypatch.setattr(practice, "diagnosed", diagnosed)
    first = kept(tmp_path / "cases", "X1", tmp_path, "version")
    assert kept(tmp_path / "cases", "X1", tmp_path, "version") == first
    assert asked == ["X1"]
    kept(tmp_path / "cases", "X1", tmp_path, "another")
    assert asked == ["X1", "X1"]
