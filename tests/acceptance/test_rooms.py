"""The rooms of the package: a circle between them is found by the command that `make lint` runs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
LINTER = Path(sys.prefix) / "bin" / "lint-imports"

pytestmark = pytest.mark.skipif(not LINTER.exists(), reason="needs the project's .venv")


def linted(folder: Path) -> subprocess.CompletedProcess[str]:
    """What the linter says of a copy of the package."""
    place = {**os.environ, "PYTHONPATH": str(folder)}
    command = [LINTER, "--no-cache", "--no-logo", "--config", REPOSITORY / "pyproject.toml"]
    return subprocess.run(command, cwd=folder, env=place, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("file", "line", "kept"),
    [
        ("record/log.py", "", True),
        ("record/log.py", "import hfanalysis.segment.phases\n", False),
        ("thermo/air.py", "def late() -> None:\n    from hfanalysis.engine import tank\n    print(tank)\n", False),
        ("charts/svg.py", "from hfanalysis.report import html\n", False),
    ],
    ids=["as it is", "up", "up from inside a function", "a drawing that knows its page"],
)
def test_a_room_that_imports_one_above_it_is_found(tmp_path: Path, file: str, line: str, kept: bool) -> None:
    copy = tmp_path / "hfanalysis"
    shutil.copytree(REPOSITORY / "src" / "hfanalysis", copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / file).write_text((copy / file).read_text("utf-8") + "\n" + line, "utf-8")
    said = linted(tmp_path)
    assert (said.returncode == 0) == kept, said.stdout + said.stderr
    assert ("BROKEN" in said.stdout) != kept
