"""The wheel by itself: what was built is whole, and does the first steps in an empty folder."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DATA = (".css", ".html.j2", ".js", ".json", ".toml", ".txt", ".typed")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built as `pip install .` builds it."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (found,) = folder.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its files, where an installer puts them."""
    folder = tmp_path_factory.mktemp("site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def hfa(installed: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """The command of the wheel, in a folder that is not the checkout."""
    where = {**os.environ, "PYTHONPATH": str(installed), "COLUMNS": "120"}
    command = [sys.executable, "-m", "hfanalysis", *words]
    return subprocess.run(command, cwd=folder, env=where, capture_output=True, text=True, check=False)


def test_it_holds_every_module_and_every_file_that_they_open(installed: Path) -> None:
    sources = {
        path.relative_to(ROOT / "src")
        for path in (ROOT / "src" / "hfanalysis").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.name.endswith((".py", *DATA))
    }
    there = {path.relative_to(installed) for path in installed.rglob("*") if path.is_file()}
    assert sources - there == set()


def test_it_brings_the_examples_and_the_pages(installed: Path, tmp_path: Path) -> None:
    made = hfa(installed, tmp_path, "demo")
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "raw_tests/HF5/log.csv").read_bytes() == (ROOT / "raw_tests/HF5/log.csv").read_bytes()
    pages = hfa(installed, tmp_path, "docs")
    assert pages.returncode == 0, pages.stderr
    assert str(installed) in pages.stderr
    assert {"tutorial", "tank_heat"} <= {line.split()[0] for line in pages.stdout.splitlines()}


def test_it_reads_a_log_in_an_empty_folder_with_its_own_code(installed: Path, tmp_path: Path) -> None:
    assert hfa(installed, tmp_path, "demo").returncode == 0
    read = hfa(installed, tmp_path, "ingest", "HF5")
    assert read.returncode == 0, read.stderr
    assert (tmp_path / "processed/HF5/ingest.h5").is_file()
