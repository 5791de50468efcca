"""The numbers of a replica do not move by the last digits of its log."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from benchmarks import last_digits
from benchmarks.blind.folder import code_digest
from benchmarks.last_digits import ALLOWED, ROOT, movements, numbers, perturbed
from numpy.typing import NDArray

Array = NDArray[np.float64]


def analysed(tmp_path: Path, draw: int) -> dict[str, tuple[float, float]]:
    """The numbers of HF5 as far as calibration, validation and flight."""
    perturbed(ROOT / "raw_tests" / "HF5", tmp_path / str(draw), draw)
    return dict(numbers(last_digits.analysed(tmp_path / str(draw), "HF5", ("validate", "flight"))))


def readings(test: Path) -> Array:
    """All cells of a log; those that are empty are no numbers."""
    return np.genfromtxt(test / "log.csv", delimiter=",", skip_header=1)


def test_a_replicas_numbers_do_not_move_by_the_last_digits_of_its_log(tmp_path: Path) -> None:
    moved = movements([analysed(tmp_path, draw) for draw in range(2)])
    assert len(moved) > 30
    assert {name: by for name, by in moved.items() if by >= ALLOWED} == {}


def test_draws_differ_by_their_last_digits_only(tmp_path: Path) -> None:
    source = ROOT / "raw_tests" / "HF5"
    logs = []
    for draw in (0, 1):
        perturbed(source, tmp_path / str(draw), draw)
        logs.append(readings(tmp_path / str(draw) / "raw_tests" / "HF5"))
    raw = readings(source)
    assert np.array_equal(logs[0][:, 0], raw[:, 0], equal_nan=True)
    for one in (logs[1], raw):
        off = np.abs(logs[0][:, 1:] - one[:, 1:]) / np.maximum(np.abs(one[:, 1:]), 1e-300)
        assert 1e-11 < float(np.nanmedian(off)) < 1e-9


def test_what_only_some_draws_have_moves_without_end() -> None:
    moved = movements([{"a": (1.0, 0.5), "b": (1.0, 1.0)}, {"a": (1.1, 0.4)}])
    assert moved == {"a": (1.1 - 1.0) / 0.4, "b": float("inf")}


def test_numbers_are_found_wherever_they_stand() -> None:
    content = {"x": [{"name": "heat", "size": {"value": 1.0, "std": 0.1}}], "no": {"value": 1.0, "std": None}}
    assert dict(numbers(content)) == {"x/heat/size": (1.0, 0.1)}


def test_the_study_goes_on_from_what_was_found_by_the_same_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two draws that are there, and one of other code: nothing is analysed, and the page has the two."""

    def line(draw: int, value: float, code: str) -> str:
        return json.dumps({"case": "HF5", "draw": draw, "code": code, "numbers": {"C_i": (value, 0.5)}})

    found, page = tmp_path / "found.jsonl", tmp_path / "page.md"
    rows = [line(0, 1.0, code_digest()), line(1, 1.1, code_digest()), line(1, 9.0, "another")]
    found.write_text("\n".join(rows) + "\n", encoding="utf-8")
    page.write_text("<!-- last-digits: begin -->\n<!-- last-digits: end -->\n", encoding="utf-8")
    asked = ["--draws", "2", "--only", "HF5", "--found", str(found), "--write", str(page)]
    monkeypatch.setattr("sys.argv", ["last_digits", *asked])
    monkeypatch.setattr(last_digits, "analysed", lambda *_: pytest.fail("what is there is analysed again"))
    assert last_digits.main() == 0
    assert "| HF5 | 2 | 1 | 1 | `C_i` | 20 |" in page.read_text(encoding="utf-8")
    assert "| HF5 | `C_i` | 20 |" in capsys.readouterr().out
