"""``hfa new`` at the terminal: what it shows, and what it asks."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
import pytest

from hfanalysis.cli import main
from hfanalysis.record.definition import load_definition


def run(monkeypatch: pytest.MonkeyPatch, answers: str, *arguments: object) -> int:
    monkeypatch.setattr(sys, "argv", ["hfa", *map(str, arguments)])
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers))
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Time, a chamber that states no unit, a column that says nothing."""
    time = np.arange(0.0, 20.0, 0.02)
    fire = np.where((time > 5.0) & (time < 12.0), 1.0, 0.0) + np.random.default_rng(1).normal(0.0, 0.01, time.size)
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack([time, 14.7 + 300.0 * fire, 2000.0 * fire[::-1]]), delimiter=",",
               header="time (s),PT-CC,x (N)", comments="", fmt="%.6g")  # fmt: skip
    return path


def test_what_was_seen_is_shown_with_its_curve(
    log: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "", "new", "T", "--log", log, "--root", log.parent) == 0
    out = capsys.readouterr().out
    assert "p_chamber in psi?" in out
    assert "▁█" in out
    assert str(log.parent / "processed" / "T" / "columns.svg") in out


def test_answers_make_the_draft(log: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrong word and a wrong unit are asked again."""
    answers = "p_camber\np_chamber\nfurlong\npsia\nthrust\n\n"
    assert run(monkeypatch, answers, "new", "T", "--log", log, "--root", log.parent, "--edit") == 0
    channels = load_definition(log.parent / "raw_tests" / "T" / "test.toml").channels
    assert {name: (spec.column, spec.unit) for name, spec in channels.items()} == {
        "p_chamber": ("PT-CC", "psia"), "thrust": ("x (N)", "N"),
    }  # fmt: skip
    asked = capsys.readouterr().err
    assert "did you mean 'p_chamber'" in asked
    assert "'furlong' is no unit of pressure" in asked


def test_nobody_who_answers_writes_nothing(
    log: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "", "new", "T", "--log", log, "--root", log.parent, "--edit") == 2
    assert "nobody answers" in capsys.readouterr().err
    assert not (log.parent / "raw_tests").exists()
