"""hfa demo, docs and table: what comes with the package, and results as a table."""

from __future__ import annotations

import json
from pathlib import Path

from tests.cli.run import Run


def test_the_demo_is_a_root_that_the_next_commands_find(run: Run, tmp_path: Path) -> None:
    ended = run("demo", tmp_path)
    assert ended.status == 0
    assert "hfa run HF5 --quick" in ended.out
    assert "generated, not measured" in ended.out
    assert run("ingest", "HF4", "--root", tmp_path, "-q").status == 0
    assert (tmp_path / "engines" / "maelstrom.toml").is_file()


def test_a_demo_never_overwrites(run: Run, tmp_path: Path) -> None:
    run("demo", tmp_path)
    (tmp_path / "raw_tests" / "HF5" / "test.toml").write_text("mine")
    ended = run("demo", tmp_path)
    assert ended.status == 2
    assert "is there already, and not as in the examples" in ended.err
    assert (tmp_path / "raw_tests" / "HF5" / "test.toml").read_text() == "mine"
    (tmp_path / "raw_tests" / "HF5" / "test.toml").unlink()
    assert run("demo", tmp_path).status == 0


def test_without_tests_the_demo_is_named(run: Run, tmp_path: Path) -> None:
    assert "hfa demo writes two" in run("ingest", "HF5", "--root", tmp_path).err


def test_pages_are_listed_and_shown(run: Run) -> None:
    listed = run("docs")
    assert "tutorial" in listed.out
    assert run("docs", "tutorial").out.startswith("# ")
    assert run("docs", "nowhere").status == 2


def test_a_table_of_what_is_there(run: Run, tmp_path: Path) -> None:
    assert run("table", "--root", tmp_path).status == 3
    folder = tmp_path / "processed" / "T1"
    folder.mkdir(parents=True)
    (folder / "segments.json").write_text(json.dumps({"test": "T1", "t_v": {"value": 5.0, "unit": "s"}}))
    assert run("table", "--root", tmp_path).out.splitlines()[1].startswith("T1,segments,t_v,5.0,s,")
    assert run("table", "T1", "--root", tmp_path, "--write", tmp_path / "t.csv").status == 0
    assert (tmp_path / "t.csv").read_text().count("\n") == 2
