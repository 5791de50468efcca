"""The notebooks are whole, and docs/walkthrough.md is the first of them with what it shows now.

`make notebooks` executes them all; here the first is followed as far as takes seconds.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
PAGE = (ROOT / "docs" / "walkthrough.md").read_text(encoding="utf-8")
MINUTES = "diagnose"
"""What a cell that takes minutes has in it; what follows it builds on it."""


def cells(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return found


def source(cell: dict[str, Any]) -> str:
    return "".join(cell["source"])


def shown(code: str, names: dict[str, Any]) -> str:
    """What a notebook shows below a cell, where that is text."""
    body = ast.parse(code).body
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        last = body.pop() if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if isinstance(last, ast.Expr) else None
    if value is None or hasattr(value, "_repr_png_"):
        return said.getvalue()
    return said.getvalue() + str(value)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_output_and_its_code_is_code(path: Path) -> None:
    for cell in cells(path):
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None
            ast.parse(source(cell))


def test_the_walk_through_is_the_notebook() -> None:
    at = 0
    for cell in cells(ROOT / "notebooks" / "from-log-to-verdict.ipynb"):
        text = source(cell)
        for part in text.split("\n\n", 1) if at == 0 else [text]:
            at = PAGE.index(part, at) + len(part)
    pictures = re.findall(r"\]\((walkthrough-\d+\.png)\)", PAGE)
    assert pictures == sorted(path.name for path in (ROOT / "docs").glob("walkthrough-*.png"))
    assert pictures


def test_the_walk_through_shows_what_is_found_now(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(ROOT / "raw_tests", tmp_path / "raw_tests")
    (tmp_path / "notebooks").mkdir()
    monkeypatch.chdir(tmp_path / "notebooks")
    names: dict[str, Any] = {}
    compared = 0
    for cell in cells(ROOT / "notebooks" / "from-log-to-verdict.ipynb"):
        code = source(cell)
        if cell["cell_type"] != "code" or "residuals" in code:
            continue
        if MINUTES in code:
            break
        text = shown(code, names).rstrip()
        if text:
            assert f"```python\n{code}\n```\n\n```text\n{text}\n```" in PAGE
            compared += 1
    assert compared >= 4
