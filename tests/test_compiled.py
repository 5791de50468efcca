"""Compiled code follows its sources: a change in a file that it only calls is seen by the next process."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import hfanalysis.compiled

PACKAGE = Path(hfanalysis.compiled.__file__).parent
COMPILERS = {"njit", "jit", "cfunc", "vectorize", "guvectorize", "stencil", "generated_jit"}

CALLER = """
from thrust.compiled import compiled
from thrust.gas import gamma

@compiled
def twice(x):
    return 2.0 * gamma(x)
"""

CALLED = """
from thrust.compiled import inlined
from thrust.numbers import FACTOR

@inlined
def gamma(x):
    return FACTOR * x
"""

SHOW = "from thrust.nozzle import twice; twice(1.0); print(twice(1.0), sum(twice.stats.cache_hits.values()))"


def shown(folder: Path) -> tuple[float, int]:
    """What a new process computes, and how often it found it in the cache."""
    beside_its_sources = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    command = [sys.executable, "-c", SHOW]
    done = subprocess.run(command, cwd=folder, env=beside_its_sources, capture_output=True, text=True, check=True)
    value, hits = done.stdout.split()
    return float(value), int(hits)


def written(folder: Path) -> Path:
    """A small package with compiled code that calls into another file."""
    package = folder / "thrust"
    package.mkdir()
    (package / "__init__.py").touch()
    for name in ("compiled.py", "sources.py", "remembered.py", "progress.py", "users.py"):
        (package / name).write_text((PACKAGE / name).read_text("utf-8").replace("hfanalysis.", "thrust."))
    (package / "nozzle.py").write_text(CALLER)
    (package / "gas.py").write_text(CALLED)
    (package / "numbers.py").write_text("FACTOR = 1.5\n")
    return package


def test_a_number_changed_two_files_away_is_seen(tmp_path: Path) -> None:
    package = written(tmp_path)
    assert shown(tmp_path) == (3.0, 0)
    assert shown(tmp_path) == (3.0, 1)
    (package / "nozzle.py").touch()
    assert shown(tmp_path) == (3.0, 1)
    (package / "numbers.py").write_text("FACTOR = 1.25\n")
    assert shown(tmp_path) == (2.5, 0)


def own_compilers(source: str) -> Iterator[str]:
    """What a source uses of numba that keeps compiled code beside ours, or none."""
    tree = ast.parse(source)
    modules = {a.asname or a.name.split(".")[0] for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "numba":
            yield from (alias.name for alias in node.names if alias.name in {*COMPILERS, "*"})
        if isinstance(node, ast.Attribute) and node.attr in COMPILERS:
            base = ast.unparse(node.value).split(".")[0]
            yield from [node.attr] * (base in modules)


@pytest.mark.parametrize("content", [b"", b"no pickle at all"])
def test_a_cache_that_cannot_be_read_is_made_anew(tmp_path: Path, content: bytes) -> None:
    """A disk that was full, or an older version whose modules have other names."""
    written(tmp_path)
    assert shown(tmp_path) == (3.0, 0)
    for index in tmp_path.rglob("*.nbi"):
        version = index.read_bytes()[:20] if content else b""
        index.write_bytes(version + content)
    assert shown(tmp_path) == (3.0, 0)
    assert shown(tmp_path) == (3.0, 1)


@pytest.mark.parametrize(
    "source",
    [
        "from numba import njit",
        "def f():\n    from numba import cfunc as c",
        "import numba\n@numba.njit(cache=True)\ndef f(): ...",
        "import numba as nb\nf = nb.jit(g)",
        "import numba.core.decorators as d\nf = d.jit(g)",
    ],
)
def test_a_compiler_of_numbas_own_is_found(source: str) -> None:
    assert list(own_compilers(source))


def test_nothing_is_compiled_but_with_the_packages_own_decorators() -> None:
    sources = [path for path in sorted(PACKAGE.rglob("*.py")) if path.name != "compiled.py"]
    found = {path.name: names for path in sources if (names := list(own_compilers(path.read_text("utf-8"))))}
    assert sources
    assert found == {}


DRAG = """
import numpy as np
from hfanalysis.rocket.vehicle import drag
print(drag(1402.0, 100.0, 0.01, np.array([[0.0], [0.5]])), sum(drag.stats.cache_hits.values()))
"""


def dragged(folder: Path) -> tuple[float, int]:
    """The drag that a copy of the package computes in a new process, and how often it was found compiled."""
    places = {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "kept")}
    done = subprocess.run(
        [sys.executable, "-c", DRAG], env={**os.environ, **places}, capture_output=True, text=True, check=True
    )
    value, hits = done.stdout.split()
    return float(value), int(hits)


def test_a_flight_through_other_air_is_computed_anew(tmp_path: Path) -> None:
    copy = tmp_path / "hfanalysis"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    before, hits = dragged(tmp_path)
    assert hits == 0
    assert dragged(tmp_path) == (before, 1)
    air = copy / "thermo" / "air.py"
    assert "101_290.0" in air.read_text("utf-8")
    air.write_text(air.read_text("utf-8").replace("101_290.0", "202_580.0"), "utf-8")
    assert dragged(tmp_path) == (pytest.approx(2.0 * before, rel=1e-12), 0)


def test_who_watches_is_told_of_what_is_compiled_and_not_of_what_is_kept(tmp_path: Path) -> None:
    code = (
        "from hfanalysis.progress import watching_compiler\nfrom hfanalysis.compiled import compiled\nimport made\n"
        "told = []\nwith watching_compiler(lambda: told.append(1)):\n    made.twice(2.0)\nprint(len(told))"
    )
    (tmp_path / "made.py").write_text(
        "from hfanalysis.compiled import compiled\n\n\n@compiled\ndef twice(x):\n    return 2.0 * x\n"
    )
    places = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    env = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": places}
    runs = [subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True) for _ in range(2)]
    assert [run.stdout.strip() for run in runs] == ["1", "0"], runs[0].stderr
