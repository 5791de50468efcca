"""A copy of the source in which an error is put, and the tests of its room run on it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from benchmarks.mutants.mutant import PACKAGE, ROOT, Mutant, files, source

BESIDE = ("tests", "benchmarks", "simulated", "raw_tests", "engines", "docs", "pipeline")
SINGLE = ("pyproject.toml", "README.md", "CHANGELOG.md", "LICENSE", "Makefile", "CITATION.cff")
ELSEWHERE = {"assembly": "cli/test_engines.py", "products": "stages", "charts": "report", "simulate": "cli"}
"""Tests of rooms that have no folder of their own."""

LONGEST = 900.0
"""[s] after which a run of tests counts as stuck, and the error as noticed."""

FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+?)(?: - .*)?$", re.MULTILINE)


@dataclass(frozen=True)
class Ran:
    """Whether the tests passed; else the first that did not; how long it took [s]."""

    passed: bool
    failed: str
    seconds: float


def room_tests(mutant: Mutant) -> Path:
    """The folder of tests of the room that an error is in, the nearest that there is."""
    folder = mutant.edit.file.parent
    while folder.parts and not (ROOT / "tests" / folder).is_dir():
        folder = folder.parent
    return Path("tests") / (folder if folder.parts else ELSEWHERE[mutant.room])


def state(mutant: Mutant, tests: bool) -> str:
    """What a result hangs on: the definition with the error in, wherever it stands, and if asked the room's tests."""
    total = sha256(mutant.edit.around.encode())
    if tests:
        for path in sorted((ROOT / room_tests(mutant)).glob("**/*.py")):
            total.update(path.read_bytes())
    return total.hexdigest()[:16]


class Workshop:
    """A scratch folder with the repository's copy; one error at a time."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.warm = folder, folder / "compiled"
        self.copy = folder / "copy"
        shutil.rmtree(self.copy, ignore_errors=True)
        for name in BESIDE:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, self.copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in SINGLE:
            if (ROOT / name).exists():
                shutil.copy2(ROOT / name, self.copy / name)
        shutil.copytree(ROOT / "src", self.copy / "src", ignore=shutil.ignore_patterns("__pycache__"))
        self.warm.mkdir(parents=True, exist_ok=True)

    def clean(self, folder: Path) -> Ran:
        """Tests on the source as it is; compiles what they need. Raises LookupError where there are none."""
        return self._run(self._ordered(folder, ""), self.warm)

    def tried(self, mutant: Mutant) -> Ran:
        """Tests on the source with an error in, those first that import its module."""
        path = self.copy / "src" / "hfanalysis" / mutant.edit.file
        cache = self.folder / "compiled-with-error"
        shutil.rmtree(cache, ignore_errors=True)
        shutil.copytree(self.warm, cache, copy_function=os.link)
        touched = self._touched(mutant)
        path.write_text(mutant.edit.applied, encoding="utf-8")
        try:
            return self._run(self._ordered(room_tests(mutant), _module(mutant.edit.file)), cache)
        finally:
            for file in touched:
                shutil.copy2(PACKAGE / file, self.copy / "src" / "hfanalysis" / file)

    def _touched(self, mutant: Mutant) -> list[Path]:
        """The file and those that import it, directly or not, made younger: numba's plain cache goes by age alone."""
        found = {mutant.edit.file}
        while True:
            names = [_module(file) for file in found]
            more = {f for f in files() if any(_imports(source(f), name) for name in names)} | found
            if more == found:
                break
            found = more
        for file in found:
            os.utime(self.copy / "src" / "hfanalysis" / file)
        return sorted(found)

    def _ordered(self, folder: Path, module: str) -> list[str]:
        """Files of tests, those first that import a module."""
        found = self.copy / folder
        paths = sorted(found.rglob("test_*.py")) if found.is_dir() else [found]
        if not paths:
            raise LookupError(f"there are no tests in {folder}")
        near = {path: bool(module) and _imports(path.read_text(encoding="utf-8"), module) for path in paths}
        return [str(path.relative_to(self.copy)) for path in sorted(paths, key=lambda p: (not near[p], p))]

    def _run(self, tests: list[str], cache: Path) -> Ran:
        environment = {
            **os.environ,
            "PYTHONPATH": f"{self.copy / 'src'}:{self.copy}",
            "NUMBA_CACHE_DIR": str(cache),
            "OMP_NUM_THREADS": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # they take longer to import than most tests
        }
        command = [sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *tests]
        started = time.monotonic()
        try:
            done = subprocess.run(
                command, cwd=self.copy, env=environment, capture_output=True, text=True, timeout=LONGEST
            )
        except subprocess.TimeoutExpired:
            return Ran(False, "stuck", LONGEST)
        failed = FAILED.search(done.stdout)
        said = failed.group(1) if failed else (done.stdout + done.stderr).strip().splitlines()[-1:] or [""]
        return Ran(done.returncode == 0, said if isinstance(said, str) else said[0], time.monotonic() - started)


def _module(file: Path) -> str:
    return ".".join(("hfanalysis", *file.with_suffix("").parts)).removesuffix(".__init__")


def _imports(text: str, module: str) -> bool:
    """Whether a source imports a module, or from it, or the module from its package."""
    package, _, name = module.rpartition(".")
    return bool(
        re.search(rf"^\s*(?:from|import) {re.escape(module)}\b", text, re.MULTILINE)
        or re.search(rf"^\s*from {re.escape(package)} import (?:\([^)]*|.*)\b{name}\b", text, re.MULTILINE)
    )
