"""Which numbers changed between two folders of products."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from tests.cli.run import hfa

from hfanalysis.campaign.differences import beyond, differences, made_with, other_inputs, pairs

PROVENANCE: dict[str, Any] = {
    "hfanalysis": "0.1.0", "code": "0123456789", "raw": {"log.csv": "aa"}, "test_toml": "bb", "effects": {},
    "parameters": {"samples": 400},
}  # fmt: skip
CONSTANTS: dict[str, Any] = {
    "C_i": {"value": 0.30, "unit": "", "std": 0.01, "verdict": "identified"},
    "K_loss": {"value": 5e8, "unit": "1/m^4", "std": 1e7, "verdict": "identified"},
    "m": {"value": 1.1, "unit": "", "std": 0.02, "verdict": "identified"},
    "loss": {"value": 4e5, "unit": "Pa"},
}


def made(folder: Path, **changed: Any) -> Path:
    """Products of a test with some entries changed; None leaves one out."""
    folder.mkdir(parents=True)
    (folder / "segments.json").write_text(json.dumps({"test": "T1", "provenance": PROVENANCE}), encoding="utf-8")
    found = {"test": "T1", **CONSTANTS, "provenance": PROVENANCE, **changed}
    body = {name: value for name, value in found.items() if value is not None}
    (folder / "calibration.json").write_text(json.dumps(body), encoding="utf-8")
    return folder


@pytest.fixture
def old(tmp_path: Path) -> Path:
    return made(tmp_path / "old" / "T1")


def test_what_changed_most_by_its_deviation_comes_first(old: Path, tmp_path: Path) -> None:
    new = made(
        tmp_path / "new" / "T1",
        C_i={**CONSTANTS["C_i"], "value": 0.305},
        K_loss={**CONSTANTS["K_loss"], "value": 5.2e8},
        loss={"value": 3e5, "unit": "Pa"},
    )
    first, second, last = differences(old, new)
    assert (first.name, first.deviations, first.relative) == ("K_loss", pytest.approx(2.0), pytest.approx(0.04))
    assert (second.name, second.deviations) == ("C_i", pytest.approx(0.5))
    assert (last.name, last.deviations, last.relative) == ("loss", None, pytest.approx(-0.25))
    assert [one.name for one in beyond([first, second, last], 1.0)] == ["K_loss", "loss"]


def test_a_verdict_that_changed_and_a_number_that_went_count_whatever_they_changed_by(
    old: Path, tmp_path: Path
) -> None:
    new = made(tmp_path / "new" / "T1", m={**CONSTANTS["m"], "verdict": "doubted"}, loss=None)
    found = {one.name: one for one in beyond(differences(old, new), 5.0)}
    assert found["m"].verdict == "identified to doubted"
    assert (found["loss"].old, found["loss"].new, found["loss"].deviations) == (4e5, None, None)
    assert set(found) == {"m", "loss"}


def test_the_same_products_differ_in_nothing(old: Path, tmp_path: Path) -> None:
    assert differences(old, made(tmp_path / "new" / "T1")) == []


def test_what_they_were_made_from_is_told(old: Path, tmp_path: Path) -> None:
    new = made(tmp_path / "new" / "T1", provenance={**PROVENANCE, "test_toml": "cc", "parameters": {"samples": 40}})
    assert made_with(old) == made_with(new)
    later = made(tmp_path / "later" / "T1", provenance={**PROVENANCE, "code": "another"})
    assert re.fullmatch(r"0\.1\.0 \([0-9a-f]{8}\)", made_with(later))
    assert made_with(later) != made_with(old)
    assert made_with(tmp_path) == ""
    assert other_inputs(old, old) == []
    assert other_inputs(old, new) == ["test.toml", "parameters"]


def test_tests_are_compared_by_name(old: Path, tmp_path: Path) -> None:
    new = tmp_path / "new"
    made(new / "T1")
    made(new / "T2")
    assert pairs(old.parent, new) == ([("T1", old, new / "T1")], [], ["T2"])
    assert pairs(old, new / "T2") == ([("T2", old, new / "T2")], [], [])


def test_at_the_terminal(old: Path, tmp_path: Path) -> None:
    new = made(tmp_path / "new" / "T1", K_loss={**CONSTANTS["K_loss"], "value": 5.2e8})
    ended = hfa("diff", old.parent, new.parent)
    assert ended.status == 0
    assert "T1: 1 quantity changed; made with 0.1.0 (" in ended.out
    assert "+4 %" in ended.out
    told = json.loads(hfa("diff", old, new, "--json").out)
    assert [row["name"] for row in told["tests"]["T1"]["changed"]] == ["K_loss"]
    missing = hfa("diff", old, tmp_path / "none")
    assert (missing.status, missing.err.count("\n")) == (2, 1)
    (tmp_path / "empty").mkdir()
    assert hfa("diff", old.parent, tmp_path / "empty").status == 3
