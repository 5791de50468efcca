"""hfa health: what it says, and how it writes cures into test.toml."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.cli.run import Run
from tests.health import fire
from tests.record import make


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A root with a test T whose thrust cell freezes in mid-burn."""
    columns = fire.columns()
    columns["thrust"][800:] = columns["thrust"][800]
    make.write(tmp_path, fire.toml(), {"log.csv": make.csv(**columns)})
    return tmp_path


def test_it_shows_every_channel_and_says_what_was_found(run: Run, root: Path) -> None:
    status, out, err = run("health", "T", "--root", root)
    assert status == 0
    assert all(name in out for name in fire.CHANNELS)
    assert "unusable  stuck" in out
    assert "channel thrust: unusable (stuck, from 3.0" in err


def test_without_a_terminal_nothing_is_written_unless_that_is_asked_for(run: Run, root: Path) -> None:
    path = root / "raw_tests" / "T" / "test.toml"
    before = path.read_bytes()
    status, _, err = run("health", "T", "--root", root, "--apply")
    assert status == 2
    assert "[[exclude]]" in err
    assert "--yes" in err
    assert path.read_bytes() == before
    status, _, err = run("health", "T", "--root", root, "--apply", "--yes")
    assert (status, "written" in err) == (0, True)
    assert path.read_bytes().startswith(before.rstrip())
    status, out, _ = run("health", "T", "--root", root, "--json")
    assert json.loads(out)["channels"]["thrust"] == {"verdict": "healthy", "findings": []}
    status, _, err = run("health", "T", "--root", root, "--apply", "--yes")
    assert (status, "nothing that was found" in err) == (0, True)


def test_asked_at_a_terminal_no_is_no(run: Run, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = root / "raw_tests" / "T" / "test.toml"
    before = path.read_bytes()
    for answer, written in (("\n", False), ("no\n", False), ("y\n", True)):
        monkeypatch.setattr("sys.stdin", Terminal(answer))
        assert run("health", "T", "--root", root, "--apply")[0] == 0
        assert (path.read_bytes() != before) is written


class Terminal:
    """Somebody at a terminal who gives one answer."""

    def __init__(self, answer: str) -> None:
        self.answer = answer

    def isatty(self) -> bool:
        return True

    def readline(self) -> str:
        return self.answer


def test_yes_alone_is_refused(run: Run, root: Path) -> None:
    status, _, err = run("health", "T", "--root", root, "--yes")
    assert status == 2
    assert "--apply" in err
