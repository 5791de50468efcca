"""make as people use it: help, clear messages, and real files that are made once."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pipeline import dag

REPOSITORY = Path(__file__).parents[2]
VENV = Path(sys.prefix)

pytestmark = pytest.mark.skipif(
    shutil.which("make") is None or not (VENV / "bin" / "hfa").exists(), reason="needs make and the project's .venv"
)


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What make works on: the rules, the source and one test, with the environment at hand."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("Makefile", "pyproject.toml", "requirements.lock", "requirements-rocketpy.lock"):
        shutil.copy(REPOSITORY / name, folder)
    shutil.copytree(REPOSITORY / "pipeline", folder / "pipeline")
    shutil.copytree(REPOSITORY / "src", folder / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", folder / "raw_tests" / "HF5")
    return folder


def make(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run make there; the environment counts as set up."""
    given = ("TEST", "OTHER", "FLAGS", "PYTHON", "MAKEFLAGS", "MFLAGS", "MAKELEVEL")
    clean = {name: value for name, value in os.environ.items() if name not in given}
    command = ["make", "--no-print-directory", f"VENV={VENV}", "-o", f"{VENV}/.set-up", *arguments]
    return subprocess.run(command, cwd=folder, env=clean, capture_output=True, text=True, check=False)


def test_make_alone_prints_what_there_is_to_do(checkout: Path) -> None:
    ended = make(checkout)
    assert ended.returncode == 0
    for target in ("calibrate", "report", "compare", "all", "test", "setup", "benchmark", "recovery", "lock", "clean"):
        assert f"  {target} " in ended.stdout


def test_the_tests_get_rocketpy_and_an_analysis_does_not(checkout: Path) -> None:
    """`make -n` prints the commands of a target and of all it needs."""
    assert ".venv-rocketpy requirements-rocketpy.lock" in make(checkout, "-n", "test").stdout
    assert "rocketpy" not in make(checkout, "-n", "calibrate", "TEST=HF5").stdout


def test_what_setting_up_compiles_is_there_to_run() -> None:
    """The process that says nothing when it is run beside the other."""
    command = [VENV / "bin" / "python", REPOSITORY / "pipeline" / "compile.py", "engine"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr


def test_a_missing_test_is_asked_for(checkout: Path) -> None:
    ended = make(checkout, "calibrate")
    assert ended.returncode == 2
    assert "make calibrate: which test? For example: make calibrate TEST=HF5" in ended.stderr
    assert "There are: HF5" in ended.stderr


@pytest.mark.parametrize("given", [[], ["TEST=HF5"], ["OTHER=HF5"]])
def test_a_comparison_asks_for_both_tests(checkout: Path, given: list[str]) -> None:
    ended = make(checkout, "compare", *given)
    assert ended.returncode == 2
    assert "make compare: which two tests? For example: make compare TEST=HF4 OTHER=HF5" in ended.stderr


def test_a_comparison_with_what_is_no_test_ends_with_one_clear_message(checkout: Path) -> None:
    ended = make(checkout, "compare", "TEST=HF5", "OTHER=$(shell touch stray)")
    assert ended.returncode == 2
    assert len([line for line in ended.stderr.splitlines() if line.startswith("hfa: ")]) == 1
    assert not (checkout / "stray").exists()


@pytest.mark.parametrize("name", ["../x", "HF6", "a b", "$(shell touch stray)", "';touch stray;'", "-x"])
def test_a_name_that_is_no_test_ends_with_one_clear_message(checkout: Path, name: str) -> None:
    ended = make(checkout, "calibrate", f"TEST={name}")
    assert ended.returncode == 2
    assert len([line for line in ended.stderr.splitlines() if line.startswith("hfa: ")]) == 1
    assert not (checkout / "stray").exists()
    assert "Traceback" not in ended.stderr


ODD = ("2022-04-03_12:30", "a b", "`touch stray`", "a&touch stray", "$(touch stray)", "$$(shell touch stray)", "it's",
       "-x", "Zündung", "a;touch stray;", "#1", "50%", "a=b", "two\nlines")  # fmt: skip


@pytest.fixture
def named(tmp_path: Path) -> Path:
    """A checkout with tests of such names, one with a plain name, and in hfa's place what writes down how it is
    called."""
    for name in ("Makefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(REPOSITORY / name, tmp_path)
    shutil.copytree(REPOSITORY / "pipeline", tmp_path / "pipeline")
    for name in (*ODD, "HF5"):
        (tmp_path / "raw_tests" / name).mkdir(parents=True)
        (tmp_path / "raw_tests" / name / "test.toml").touch()
    hfa = tmp_path / "venv/bin/hfa"
    hfa.parent.mkdir(parents=True)
    hfa.write_text('#!/bin/sh\nprintf "%s\\0" "$1 $2 $3 $4" >> asked\n')
    hfa.chmod(0o755)
    return tmp_path


def asked(folder: Path, *arguments: str) -> list[str]:
    """What hfa is asked for; nothing else may come of a name."""
    ended = make(folder, "VENV=venv", "-o", "venv/.set-up", *arguments)
    assert ended.returncode == 0, ended.stderr
    assert not (folder / "stray").exists()
    return (folder / "asked").read_text().split("\0")[:-1]


def test_every_test_is_made_whatever_its_name(named: Path) -> None:
    assert sorted(asked(named, "all")) == sorted(f"report --quiet -- {name}" for name in (*ODD, "HF5"))


def test_a_file_of_any_name_makes_no_rule(named: Path) -> None:
    (named / "raw_tests/HF5/burn $(touch stray): 1.csv").touch()
    (named / "engines").mkdir()
    (named / "engines/a `touch stray`.effects.toml").touch()
    assert "report --quiet -- HF5" in asked(named, "all")


def test_a_product_of_any_name_is_asked_for_by_its_name(named: Path) -> None:
    assert asked(named, "processed/a';touch stray '/ingest.h5") == ["ingest --quiet -- a';touch stray '"]


def test_products_are_real_files_made_once(checkout: Path) -> None:
    product = "processed/HF5/segments.json"
    log = checkout / "processed/HF5/run.log"
    assert make(checkout, product).returncode == 0
    runs = len(log.read_text().splitlines())
    assert runs == 3  # ingest, health, segment
    assert "is up to date" in make(checkout, product).stdout
    (checkout / "raw_tests/HF5/log.csv").touch()
    assert make(checkout, product).returncode == 0
    assert len(log.read_text().splitlines()) == runs
    assert "is up to date" in make(checkout, product).stdout


def test_make_calibrate_prints_the_result_every_time(checkout: Path) -> None:
    for _ in range(2):
        ended = make(checkout, "calibrate", "TEST=HF5")
        assert ended.returncode == 0
        assert "C_i" in ended.stdout


def test_the_rules_are_those_of_the_stages() -> None:
    assert (REPOSITORY / "pipeline" / "dag.mk").read_text(encoding="utf-8") == dag.rules(), "`make readme` writes them"
