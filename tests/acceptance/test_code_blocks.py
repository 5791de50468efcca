"""Code blocks of the documents do as they stand; those that analyse a test do so by `make code-blocks`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from pipeline.code_blocks import Block, blocks, failures, python_of, scratch, wrong_in


def test_every_block_that_takes_seconds_does_as_it_stands(tmp_path: Path) -> None:
    scratch(tmp_path)
    assert failures(tmp_path, quick=True) == []
    assert {b.kind for b in blocks()} >= {"sh", "python", "toml", "json"}


@pytest.mark.parametrize(
    ("kind", "text", "why"),
    [
        ("sh", "pip install x && hfa demon\n", "hfa has no command demon"),
        ("sh", "hfa run HF5 \\\n --quickly\n", "hfa run has no option --quickly"),
        ("sh", "make calibrat TEST=HF5\n", "make has no target calibrat"),
        ("sh", "python -m benchmarks.nothing\n", "there is no module benchmarks.nothing"),
        ("sh", "hfa run 'HF5\n", "No closing quotation"),
        ("json", "{'a': 1}\n", "property name"),
        ("toml", '[[rule]]\nquantity = "C_i"\nmost = 1.0\n', "unknown key 'most'"),
        ("yaml", "a: 1\n", "not looked at"),
    ],
)
def test_what_does_not_do_as_it_stands_is_told(kind: str, text: str, why: str) -> None:
    (told,) = wrong_in(Block("docs/page.md", 3, kind, text))
    assert why in told


def test_python_that_fails_is_told_with_its_place() -> None:
    page = [Block("docs/page.md", 10, "python", "x = 1\n"), Block("docs/page.md", 20, "python", "y = x\ny.nothing\n")]
    ended = subprocess.run(
        [sys.executable, "-c", python_of(page, quick=True)], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert ended.stderr.startswith("docs/page.md:21 AttributeError")


def test_what_needs_a_test_analysed_waits() -> None:
    page = [Block("p.md", 1, "python", 'f = hfanalysis.open("HF5")\nf.log\nx = 2\n')]
    assert "f.log" not in python_of(page, quick=True)
    assert "x = 2" in python_of(page, quick=True)
    assert "f.log" in python_of(page, quick=False)
