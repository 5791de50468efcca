"""Limits and notes of a team's own: they redo the page alone, and `--check` ends as they say."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer
from tests.inference.adopted.firing import make_root

from hfanalysis.cli.limits import EXIT_STATUS, check
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_root(tmp_path_factory.mktemp("limits"))


def paged(root: Path) -> Context:
    return run_to("report", open_test(root, "T1"))


def test_limits_and_notes_redo_the_page_alone_and_what_is_broken_ends_with_its_status(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = paged(root)
    before = {path.name: path.stat().st_mtime_ns for path in first.out.iterdir() if path.is_file()}
    check(first)
    assert "nothing was checked" in capsys.readouterr().err
    (root / "limits.toml").write_text('[[rule]]\nquantity = "total_impulse"\nmax = "1 N s"\n', encoding="utf-8")
    (root / "raw_tests" / "T1" / "notes.md").write_text("wind from the west", encoding="utf-8")
    again = paged(root)
    after = {path.name: path.stat().st_mtime_ns for path in again.out.iterdir() if path.is_file()}
    assert {name for name in before if after[name] != before[name]} - {"run.log"} == {"report.html"}
    text = again.product("report.html").read_text(encoding="utf-8")
    assert "wind from the west" in text
    assert ">breaks<" in text
    with pytest.raises(typer.Exit) as ended:
        check(again)
    assert ended.value.exit_code == EXIT_STATUS
    assert "total impulse breaks its limit" in capsys.readouterr().err
