"""How far the numbers of a test move by the last digits of its log: none should, beside its own standard deviation.

python -m benchmarks.last_digits [--cases DIR] [--draws 10] [--write docs/last-digits.md] (`make last-digits`)

Every reading of a log is multiplied by 1 + 1e-10 N(0, 1), several times over, written with all its digits to a folder
of its own, and analysed anew as far as its flight. Draws are compared with one another, not with the log as it was
recorded: its readings are rounded, and two that were alike are so no longer. What was found is kept in ``--found`` as
it comes; a run that was stopped goes on from there, as long as the package is the same.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.blind.folder import code_digest
from benchmarks.studies import one_thread, put

ROOT = Path(__file__).resolve().parent.parent
OWN, PRACTICE = ("HF5", "HF4"), ("P02", "P05", "P08", "P14", "P18", "P22")
"""Tests of this repository, and of those whose truth is known: nothing, nitrogen, a throat that erodes, a line that
fills, a cell that drifts, and two effects."""

SIZE, DRAWS = 1e-10, 10
ALLOWED = 0.02
"""Of its standard deviation, by which a number may move."""

PRODUCTS = ("calibration.json", "validation.json", "diagnosis.json", "flight.json")

Numbers = dict[str, tuple[float, float]]
"""Value and standard deviation of what a product tells, by where it stands there."""


def perturbed(test: Path, root: Path, draw: int) -> None:
    """A copy of a test's folder in a ``root``'s raw_tests, its readings off by their last digits, its times exact."""
    folder = root / "raw_tests" / test.name
    shutil.copytree(test, folder, copy_function=shutil.copyfile)
    log = tomllib.loads((test / "test.toml").read_text(encoding="utf-8"))["log"]
    for number, name in enumerate(log["files"]):
        _rewrite(test / name, folder / name, log["time"]["column"], (draw, number))


def _rewrite(source: Path, target: Path, time: str, seed: Sequence[int]) -> None:
    import numpy as np

    rng = np.random.default_rng(seed)
    with source.open(encoding="utf-8", newline="") as read, target.open("w", encoding="utf-8", newline="") as write:
        header, *rows = csv.reader(read)
        out = csv.writer(write, lineterminator="\n")
        out.writerow(header)
        off = 1.0 + SIZE * rng.standard_normal((len(rows), len(header)))
        off[:, header.index(time)] = 1.0
        out.writerows(
            [times(cell, by) for cell, by in zip(*row, strict=True)] for row in zip(rows, off.tolist(), strict=True)
        )


def times(cell: str, by: float) -> str:
    """A reading times a factor, with all its digits; what is no number stays."""
    try:
        return repr(float(cell) * by)
    except ValueError:
        return cell


def analysed(root: Path, name: str, last: Sequence[str] = ("diagnose", "validate", "flight")) -> dict[str, Any]:
    """The contents of the products of a test, as far as these stages; what its log holds nothing for is left out."""
    from hfanalysis.errors import AbsentError
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    context = open_test(root, name)
    for stage in last:
        try:
            run_to(stage, context)
        except AbsentError as missing:
            print(f"{name}: no {stage}: {missing}", file=sys.stderr)
    return {p: context.read_json(p) for p in PRODUCTS if context.product(p).exists()}


def numbers(content: Any, place: str = "") -> Iterator[tuple[str, tuple[float, float]]]:
    """Every value with a standard deviation, by where it stands."""
    if isinstance(content, Mapping):
        value, std = content.get("value"), content.get("std")
        if isinstance(value, float) and isinstance(std, float) and std > 0.0:
            yield place, (value, std)
        for key, inner in content.items():
            if key not in ("provenance", "quoted"):  # what sentences quote stands elsewhere
                yield from numbers(inner, f"{place}/{key}" if place else key)
    elif isinstance(content, list):
        for i, inner in enumerate(content):
            label = inner.get("name", inner.get("site", i)) if isinstance(inner, Mapping) else i
            yield from numbers(inner, f"{place}/{label}")


def movements(draws: Sequence[Numbers]) -> dict[str, float]:
    """From the least to the greatest value of each number over the draws, in its least standard deviation.

    Infinite for one that not all of them have.
    """
    out = {}
    for name in dict.fromkeys(name for draw in draws for name in draw):
        found = [draw[name] for draw in draws if name in draw]
        values, stds = zip(*found, strict=True)
        out[name] = (max(values) - min(values)) / min(stds) if len(found) == len(draws) else float("inf")
    return out


@dataclass(frozen=True)
class Store:
    """What was found so far: a line for each draw of each case."""

    path: Path
    code: str

    def draws(self, case: str) -> dict[int, Numbers]:
        """The numbers of a case by draw."""
        if not self.path.exists():
            return {}
        rows = map(json.loads, self.path.read_text(encoding="utf-8").splitlines())
        return {r["draw"]: r["numbers"] for r in rows if (r["case"], r["code"]) == (case, self.code)}

    def add(self, case: str, draw: int, found: Numbers) -> None:
        """One draw more."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"case": case, "draw": draw, "code": self.code, "numbers": found}) + "\n")


def study(tests: Sequence[Path], draws: int, store: Store) -> None:
    """All draws of all tests that are not there yet: a first of each, then a second."""
    for draw in range(draws):
        for test in tests:
            if draw not in store.draws(test.name):
                with tempfile.TemporaryDirectory() as scratch:
                    perturbed(test, Path(scratch), draw)
                    found = analysed(Path(scratch), test.name)
                store.add(test.name, draw, dict(numbers(found)))
                print(f"{test.name}: draw {draw + 1}", file=sys.stderr)


def table(tests: Sequence[Path], store: Store) -> list[str]:
    """The tables in Markdown: of the cases, and of the numbers that move more than is allowed."""
    rows = [
        "| test | draws | numbers | move more than 2 % | farthest | by % of its deviation |",
        "|---|---|---|---|---|---|",
    ]
    far = ["| test | number | by % of its deviation |", "|---|---|---|"]
    for test in tests:
        draws = list(store.draws(test.name).values())
        moved = movements(draws)
        if len(draws) < 2:
            continue
        over = sorted((name for name, by in moved.items() if by > ALLOWED), key=lambda n: -moved[n])
        most = max(moved, key=lambda n: moved[n])
        rows.append(f"| {test.name} | {len(draws)} | {len(moved)} | {len(over)} | `{most}` | {_percent(moved[most])} |")
        far += [f"| {test.name} | `{name}` | {_percent(moved[name])} |" for name in over]
    return [*rows, "", *(far if len(far) > 2 else ["No number moves more than 2 % of its standard deviation."])]


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g}" if share < float("inf") else "not in every draw"


def main() -> int:
    """Analyse all draws, then compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=Path, help="folder with raw_tests/ of the tests whose truth is known")
    parser.add_argument("--draws", type=int, default=DRAWS)
    parser.add_argument("--only", nargs="+", metavar="TEST")
    parser.add_argument("--found", type=Path, default=ROOT / ".cache" / "last-digits.jsonl")
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    wanted = [ROOT / "raw_tests" / name for name in OWN]
    if asked.cases:
        wanted += [asked.cases / "raw_tests" / name for name in PRACTICE]
    tests = [test for test in wanted if not asked.only or test.name in asked.only]
    for test in [test for test in tests if not test.exists()]:
        print(f"{test} is not there: skipped", file=sys.stderr)
        tests.remove(test)
    store = Store(asked.found, code_digest())
    study(tests, asked.draws, store)
    lines = table(tests, store)
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "last-digits", lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
