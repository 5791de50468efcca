"""Which constants without a source or evidence change nothing on 24 simulated tests of the development split.

python -m benchmarks.constants_trial [--n 24] [--write docs/constants-trial.md] (`make constants-trial`)

A group is the constants of one module that state neither. All of them are made half as large again in a copy of the
source, and each test is analysed anew, stage by stage, until a number of a product differs. A group that changes
nothing on a test goes on to the next; from the second test on groups are tried together and halved where something
changes. What was found is kept; a trial that was stopped goes on, as long as the package is the same.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.blind.folder import code_digest
from benchmarks.mutants.mutant import PACKAGE, ROOT, source, span, tree
from benchmarks.studies import one_thread, put
from pipeline.constants_page import Constant, constants

ROOMS = frozenset(
    [
        "record",
        "segment",
        "assembly",
        "calibrate",
        "validate",
        "inference",
        "diagnose",
        "measured_flight",
        "effects",
        "engine",
        "thermo",
        "flight",
    ]
)
"""Rooms whose constants an answer may hang on; what only words and pictures hang on is not tried."""

BY = 1.5
"""What a constant is multiplied by [-]."""

STAGES = {
    "ingest": "ingest.json",
    "segment": "segments.json",
    "calibrate": "calibration.json",
    "validate": "validation.json",
    "diagnose": "diagnosis.json",
}
SAME = 1e-9
"""Relative difference [-] within which a number is as it was."""

ASIDE = frozenset(("provenance", "runtime_s", "quoted", "sentences"))
NUMBER = re.compile(r"^[A-Z][A-Z0-9_]*$")


def groups() -> dict[str, list[Constant]]:
    """The constants that state neither source nor evidence, by module."""
    out: dict[str, list[Constant]] = defaultdict(list)
    for constant in constants():
        if not constant.origin and constant.room in ROOMS:
            out[constant.module].append(constant)
    return dict(out)


def moved(file: Path, names: Iterable[str]) -> str:
    """A module with every number in the values of these constants multiplied by BY; whole numbers stay whole."""
    text, wanted = source(file), set(names)
    places = [
        (*span(text, number), number.value)
        for node in tree(file).body
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and wanted & _targets(node)
        for number in ast.walk(node.value)
        if isinstance(number, ast.Constant) and type(number.value) in (int, float)
    ]
    for start, end, value in sorted(places, reverse=True):
        text = text[:start] + repr(_larger(value)) + text[end:]
    return text


def _larger(value: float) -> float:
    return value * BY if isinstance(value, float) else max(round(value * BY), value + 1)


def _targets(node: ast.Assign | ast.AnnAssign) -> set[str]:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return {n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name) and NUMBER.match(n.id)}


@dataclass(frozen=True)
class Bench:
    """A scratch folder with a copy of the package in which constants are moved, and the tests' folder."""

    folder: Path
    cases: Path

    def made(self, modules: Sequence[str], of: Mapping[str, Sequence[Constant]]) -> None:
        """Put a copy of the package there, with the constants of these modules moved."""
        copy = self.folder / "src" / "hfanalysis"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for module in modules:
            file = Path(*module.split(".")).with_suffix(".py")
            file = file if (PACKAGE / file).exists() else file.with_suffix("") / "__init__.py"
            (copy / file).write_text(moved(file, [c.name for c in of[module]]), encoding="utf-8")

    def differs(self, case: str, reference: Mapping[str, Any]) -> str:
        """The first stage whose product is not the ``reference``'s with the copy that is there; "" where all are."""
        root = self.folder / "root"
        shutil.rmtree(root, ignore_errors=True)
        shutil.copytree(self.cases / "raw_tests" / case, root / "raw_tests" / case)
        for stage, product in STAGES.items():
            found = self.ran(stage, case, root / "processed" / case / product)
            if not same(found, reference[stage]):
                return stage
        return ""

    def ran(self, stage: str, case: str, product: Path) -> Any:
        """The content of a stage's product; its exit status where it has none."""
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.folder / "src"),
            "NUMBA_CACHE_DIR": str(self.folder / "compiled"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        command = [sys.executable, "-m", "hfanalysis", stage, case, "--root", str(self.folder / "root")]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if not product.exists():
            return done.returncode if stage != "ingest" else 0
        return json.loads(product.read_text(encoding="utf-8"))


def same(one: Any, other: Any) -> bool:
    """Whether two products say the same, but for what they were made from and how long it took."""
    if isinstance(one, dict) and isinstance(other, dict):
        keys = set(one) - ASIDE
        return keys == set(other) - ASIDE and all(same(one[k], other[k]) for k in keys)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= SAME * max(abs(one), abs(other))
    return bool(one == other)


@dataclass(frozen=True)
class Trial:
    """The trial, and what it found so far: a line for each reference, and for each set of groups on a test."""

    bench: Bench
    of: Mapping[str, Sequence[Constant]]
    path: Path
    code: str

    def rows(self) -> list[dict[str, Any]]:
        """What was found by this code."""
        if not self.path.exists():
            return []
        rows = map(json.loads, self.path.read_text(encoding="utf-8").splitlines())
        return [row for row in rows if row["code"] == self.code]

    def add(self, **row: Any) -> None:
        """A line more."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"code": self.code, **row}) + "\n")

    def reference(self, case: str) -> dict[str, Any]:
        """The products of a test by the package as it is."""
        for row in self.rows():
            if row.get("reference") == case:
                return dict(row["products"])
        self.bench.made((), self.of)
        root = self.bench.folder / "root"
        shutil.rmtree(root, ignore_errors=True)
        shutil.copytree(self.bench.cases / "raw_tests" / case, root / "raw_tests" / case)
        found = {s: self.bench.ran(s, case, root / "processed" / case / p) for s, p in STAGES.items()}
        self.add(reference=case, products=found)
        return found

    def where(self, modules: Sequence[str], case: str) -> str:
        """The first stage that differs with these groups moved, "" where none does; tried once."""
        for row in self.rows():
            if row.get("case") == case and row["modules"] == list(modules):
                return str(row["differs"])
        reference = self.reference(case)
        self.bench.made(modules, self.of)
        found = self.bench.differs(case, reference)
        self.add(case=case, modules=list(modules), differs=found)
        print(f"{case}: {found or 'nothing'} differs by {', '.join(modules)}", file=sys.stderr)
        return found

    def idle(self, modules: Sequence[str], case: str) -> list[str]:
        """Those of the groups that change nothing on a test."""
        if not modules or not self.where(modules, case):
            return list(modules)
        if len(modules) == 1:
            return []
        half = len(modules) // 2
        return [*self.idle(modules[:half], case), *self.idle(modules[half:], case)]

    def run(self, cases: Sequence[str]) -> dict[str, tuple[str, str]]:
        """By group the first test and stage that it changes something in; those missing change nothing."""
        left = sorted(self.of)
        changed: dict[str, tuple[str, str]] = {}
        for number, case in enumerate(cases):
            still = [m for m in left if not self.where([m], case)] if number == 0 else self.idle(left, case)
            for module in set(left) - set(still):
                changed[module] = (case, self.where([module], case))
            left = still
        return changed


def table(of: Mapping[str, Sequence[Constant]], changed: Mapping[str, tuple[str, str]], number: int) -> list[str]:
    """The groups that change nothing, and how many there are of each kind, in Markdown."""
    idle = [m for m in sorted(of) if m not in changed]
    constants = sum(len(of[m]) for m in idle)
    return [
        f"{len(of)} groups of {sum(map(len, of.values()))} constants, {number} tests: {len(changed)} groups change "
        f"a number of a product; {len(idle)} groups of {constants} constants change nothing.",
        "",
        "| group that changes nothing | constants |",
        "|---|---|",
        *(f"| `{m}` | {', '.join(f'`{c.name}`' for c in of[m])} |" for m in idle),
    ]


def main() -> int:
    """Make the tests, then try every group."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--n", type=int, default=24)
    parser.add_argument("--folder", type=Path, default=ROOT / ".cache" / "constants-trial")
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    from simulated.blind.plan import plan
    from simulated.blind.write import write_all

    cases = plan(asked.n)
    if any(not (asked.folder / "cases" / "answers" / f"{c.id}.json").exists() for c in cases):
        write_all(cases, asked.folder / "cases", 1)
    of = groups()
    bench = Bench(asked.folder, asked.folder / "cases")
    trial = Trial(bench, of, asked.folder / "found.jsonl", code_digest())
    lines = table(of, trial.run([c.id for c in cases]), len(cases))
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "constants-trial", lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
