"""docs/tutorial.md is true: its commands are run in turn, its lines are put into test.toml, its output is compared."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from simulated.stranger import write

REPOSITORY = Path(__file__).parents[2]
PAGE = REPOSITORY / "docs" / "tutorial.md"
BLOCK = re.compile(r"(?:<!-- into (?P<file>\S+) -->\n)?```(?P<kind>sh|text|toml)\n(?P<text>.*?)```", re.DOTALL)
NUMBER = re.compile(r"[-−]?\d+(?:\.\d+)?")
CLOSE = 0.02
"""Relative: numbers of another machine differ in their last digits."""
LEFT_OUT = "…"


def ran(command: str, folder: Path, programs: Path) -> str:
    """What a command of the page prints; its exit status is 0 unless the page says another."""
    status = re.search(r"# ends with exit status (\d)", command)
    environment = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "150"}
    ended = subprocess.run(
        ["sh", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert ended.returncode == (int(status[1]) if status else 0), f"{command}: {ended.stderr}"
    return ended.stdout + ended.stderr


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `hfa` and `python` as the page calls them."""
    folder = tmp_path_factory.mktemp("programs")
    path = f'PYTHONPATH="{REPOSITORY / "src"}{os.pathsep}{REPOSITORY}" exec "{sys.executable}"'
    for name, arguments in {"hfa": ' -m hfanalysis "$@"', "python": ' "$@"'}.items():
        (folder / name).write_text(f"#!/bin/sh\n{path}{arguments}\n")
        (folder / name).chmod(0o755)
    return folder


def test_every_step_of_the_tutorial_does_what_it_shows(tmp_path: Path, programs: Path) -> None:
    printed = ""
    for block in BLOCK.finditer(PAGE.read_text(encoding="utf-8")):
        if block["kind"] == "sh":
            printed = "".join(ran(line, tmp_path, programs) for line in block["text"].splitlines())
        elif block["file"]:
            with (tmp_path / block["file"]).open("a", encoding="utf-8") as file:
                file.write(f"\n{block['text']}")
        else:
            assert_printed(block["text"].splitlines(), printed.splitlines())
    truth = write(tmp_path / "again.csv").stand
    found = json.loads((tmp_path / "processed/HF1/calibration.json").read_text(encoding="utf-8"))
    phases = json.loads((tmp_path / "processed/HF1/segments.json").read_text(encoding="utf-8"))
    for quantity, true in ((found["C_i"], truth.C_i), (found["m"], truth.m), (phases["t_v"], truth.t_v)):
        low, high = quantity["ci95"]
        assert low <= true <= high


def test_the_truth_that_the_tutorial_states_is_that_of_its_log(tmp_path: Path) -> None:
    truth = write(tmp_path / "fire.csv").stand
    stated = re.findall(
        r"^\| .*?(C_i|m|t_v) \| .* \| ([\d.]+)(?: s)? \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert {name: float(value) for name, value in stated} == pytest.approx(
        {"C_i": truth.C_i, "m": truth.m, "t_v": truth.t_v}, rel=1e-3
    )


def assert_printed(shown: list[str], printed: list[str]) -> None:
    """The shown lines are among the printed ones, in their order, and follow each other where none is left out."""
    at, follows = 0, False
    for line in shown:
        if line == LEFT_OUT:
            follows = False
            continue
        place = next((k for k in range(at, len(printed)) if alike(line, printed[k])), None)
        assert place is not None, f"not printed: {line!r}, but:\n" + "\n".join(printed[at:])
        assert place == at or not follows, f"between it and the line before stands:\n{printed[at]}"
        at, follows = place + 1, True


def alike(shown: str, printed: str) -> bool:
    """The same words, and numbers that are close: within 2 % or two of the last digit that is shown."""
    if list(_words(shown)) != list(_words(printed)):
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True)
    return all(
        abs(_value(one) - _value(other)) <= max(CLOSE * abs(_value(one)), 2.0 * _last(one)) for one, other in pairs
    )


def _value(number: str) -> float:
    return float(number.replace("−", "-"))


def _last(number: str) -> float:
    """One of the last digit."""
    return float(10.0 ** -len(number.partition(".")[2])) * 1.001


def _words(text: str) -> Iterator[str]:
    yield from NUMBER.sub("#", text).split()


def test_a_line_that_is_not_printed_is_noticed() -> None:
    with pytest.raises(AssertionError, match="not printed"):
        assert_printed(["C_i 0.60"], ["C_i 0.57"])
    with pytest.raises(AssertionError, match="between"):
        assert_printed(["a", "c"], ["a", "b", "c"])
    assert_printed(["a 1.000", "…", "c"], ["a 1.001", "b", "c"])
