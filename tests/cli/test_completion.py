"""A shell completes commands and the names of tests."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


def completed(words: str, at: int, here: Path) -> list[str]:
    """What a shell is offered for the word ``at`` of a line, asked as bash asks."""
    asked = {**os.environ, "_HFA_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(at)}
    code = "import sys; sys.argv = ['hfa']; from hfanalysis.cli import main; main()"
    run = subprocess.run([sys.executable, "-c", code], env=asked, cwd=here, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


@pytest.fixture
def here(tmp_path: Path) -> Path:
    for name in ("HF4", "HF5", "cold"):
        folder = tmp_path / "raw_tests" / name
        folder.mkdir(parents=True)
        (folder / "test.toml").touch()
    (tmp_path / "raw_tests" / "HFx").mkdir()
    return tmp_path


def test_commands_and_names_of_tests_are_completed(here: Path) -> None:
    assert completed("hfa cal", 1, here) == ["calibrate"]
    assert completed("hfa calibrate HF", 2, here) == ["HF4", "HF5"]
    assert completed("hfa campaign HF4 c", 3, here) == ["cold"]
    assert completed("hfa engine ", 2, here) == ["HF4", "HF5", "cold"]


def test_names_are_those_of_the_root_that_is_asked_for(here: Path) -> None:
    assert completed(f"hfa calibrate --root {here} HF", 4, here.parent) == ["HF4", "HF5"]
    assert completed("hfa calibrate HF", 2, here.parent) == []
