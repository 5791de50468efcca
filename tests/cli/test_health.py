"""hfa health: what it says, and how it writes cures into test.toml."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.health import fire
from tests.record import make

from hfanalysis.cli import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A root with a test T whose thrust cell freezes in mid-burn."""
    columns = fire.columns()
    columns["thrust"][800:] = columns["thrust"][800]
    make.write(tmp_path, fire.toml(), {"log.csv": make.csv(**columns)})
    return tmp_path


@pytest.fixture
def hfa(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run ``hfa`` in this process."""

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["hfa", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return int(ended.value.code or 0), said.out, said.err

    return run


def test_it_shows_every_channel_and_says_what_was_found(hfa: Run, root: Path) -> None:
    status, out, err = hfa("health", "T", "--root", root)
    assert status == 0
    assert all(name in out for name in fire.CHANNELS)
    assert "unusable  stuck" in out
    assert "channel thrust: unusable (stuck, from 3.0" in err


def test_without_a_terminal_nothing_is_written_unless_that_is_asked_for(hfa: Run, root: Path) -> None:
    path = root / "raw_tests" / "T" / "test.toml"
    before = path.read_bytes()
    status, _, err = hfa("health", "T", "--root", root, "--apply")
    assert status == 2
    assert "[[exclude]]" in err
    assert "--yes" in err
    assert path.read_bytes() == before
    status, _, err = hfa("health", "T", "--root", root, "--apply", "--yes")
    assert (status, "written" in err) == (0, True)
    assert path.read_bytes().startswith(before.rstrip())
    status, out, _ = hfa("health", "T", "--root", root, "--json")
    assert json.loads(out)["channels"]["thrust"] == {"verdict": "healthy", "findings": []}
    status, _, err = hfa("health", "T", "--root", root, "--apply", "--yes")
    assert (status, "nothing that was found" in err) == (0, True)


def test_asked_at_a_terminal_no_is_no(hfa: Run, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = root / "raw_tests" / "T" / "test.toml"
    before = path.read_bytes()
    for answer, written in (("\n", False), ("no\n", False), ("y\n", True)):
        monkeypatch.setattr("sys.stdin", Terminal(answer))
        assert hfa("health", "T", "--root", root, "--apply")[0] == 0
        assert (path.read_bytes() != before) is written


class Terminal:
    """Somebody at a terminal who gives one answer."""

    def __init__(self, answer: str) -> None:
        self.answer = answer

    def isatty(self) -> bool:
        return True

    def readline(self) -> str:
        return self.answer


def test_yes_alone_is_refused(hfa: Run, root: Path) -> None:
    status, _, err = hfa("health", "T", "--root", root, "--yes")
    assert status == 2
    assert "--apply" in err
