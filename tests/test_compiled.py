"""Compiled code follows its sources: a change in a file that it only calls is seen by the next process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import hfanalysis.compiled

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
    done = subprocess.run([sys.executable, "-c", SHOW], cwd=folder, capture_output=True, text=True, check=True)
    value, hits = done.stdout.split()
    return float(value), int(hits)


def test_a_number_changed_two_files_away_is_seen(tmp_path: Path) -> None:
    package = tmp_path / "thrust"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "compiled.py").write_text(Path(hfanalysis.compiled.__file__).read_text())
    (package / "nozzle.py").write_text(CALLER)
    (package / "gas.py").write_text(CALLED)
    (package / "numbers.py").write_text("FACTOR = 1.5\n")
    assert shown(tmp_path) == (3.0, 0)
    assert shown(tmp_path) == (3.0, 1)
    (package / "nozzle.py").touch()
    assert shown(tmp_path) == (3.0, 1)
    (package / "numbers.py").write_text("FACTOR = 1.25\n")
    assert shown(tmp_path) == (2.5, 0)
