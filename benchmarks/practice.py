"""Diagnosis of tests whose truth is known: what is named, with which probability, and what of the gap closes.

python -m benchmarks.practice --cases DIR [--write docs/diagnosis.md [--table practice-other-stands]]

CASES holds ``raw_tests/`` and ``answers/``. What was found is kept under .cache/practice as it comes, and found anew
by another version of the package. The answers are read only after all verdicts are there.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.blind.folder import PACKAGE
from benchmarks.blind.folder import digest as digest_of
from benchmarks.studies import one_thread, percent, put

from hfanalysis.errors import AnalysisError
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

EQUATIONS = {
    "tank_heat": {"tank_energy"},
    "tank_wall_heat_capacity": {"tank_energy"},
    "tank_nonequilibrium": {"tank_energy", "tank_volume"},
    "tank_stratification": {"tank_energy", "tank_volume"},
    "n2_purge": {"tank_volume", "tank_energy"},
    "feed_line_fill": {"feed"},
    "injector_two_phase": {"injector"},
    "injector_choked_vapor": {"injector"},
    "combustion_efficiency": {"chamber_energy"},
    "chamber_heat_loss": {"chamber_energy"},
    "grain_pressure_regression": {"grain"},
    "ignition_transient": {"chamber_mass", "grain", "chamber_energy"},
    "fuel_sliver": {"grain"},
    "nozzle_throat_erosion": {"nozzle"},
    "nozzle_divergence": {"nozzle"},
    "load_cell_drift": {"sensor"},
    "pressure_transducer_offset": {"sensor"},
    "chamber_tap_lag": {"sensor"},
}
"""The equations in which each effect may rightly be placed."""


CACHE = Path(__file__).resolve().parents[1] / ".cache" / "practice"


@dataclass(frozen=True)
class Outcome:
    """What was found on one case, or why nothing was."""

    case: str
    product: dict[str, Any]
    seconds: float
    failure: str = ""


def diagnosed(cases: Path, name: str, scratch: Path) -> Outcome:
    """Diagnose one case; the time is that of the stage alone."""
    try:
        context = run_to("calibrate", open_test(cases, name, out=scratch))
        started = perf_counter()
        context = run_to("diagnose", context)
    except AnalysisError as error:
        return Outcome(name, {}, 0.0, str(error))
    return Outcome(name, context.read_json("diagnosis.json"), perf_counter() - started)


def kept(cases: Path, name: str, scratch: Path, digest: str) -> Outcome:
    """What this version of the package found before, or finds now."""
    path = CACHE / cases.name / f"{name}.json"
    if path.is_file() and (found := json.loads(path.read_text(encoding="utf-8")))["digest"] == digest:
        return Outcome(name, found["product"], found["seconds"], found["failure"])
    one = diagnosed(cases, name, scratch)
    path.parent.mkdir(parents=True, exist_ok=True)
    row = {"digest": digest, "product": one.product, "seconds": one.seconds, "failure": one.failure}
    path.write_text(json.dumps(row), encoding="utf-8")
    return one


def judged(found: Outcome, answer: dict[str, Any]) -> tuple[str, str]:
    """The truth in words, and what the verdict is worth."""
    hidden = answer["effect"] if isinstance(answer["effect"], dict) else {answer["effect"]: answer.get("strength")}
    truth = " + ".join(hidden)
    if found.failure:
        return truth, "no verdict"
    product = found.product
    named = {row["name"] for row in product["effects"]}
    if truth == "none":
        return truth, "right" if product["verdict"] == "none" else "false claim"
    if not set(hidden) <= set(EQUATIONS):
        return f"{truth} (outside the library)", "right" if product["verdict"] == "unknown" else "not called unknown"
    if product["verdict"] == "none":
        return truth, "not seen"
    if named == set(hidden):
        return truth, "right"
    if set(hidden) <= named:
        return truth, "right, and more"
    if set(hidden) & set(product["set90"]) or set(hidden) & named:
        return truth, "in the set"
    right = set().union(*(EQUATIONS[name] for name in hidden))
    placed = product["localisation"] and product["localisation"][0]["equation"] in right
    return truth, "right equation" if placed else "wrong"


def table(found: Iterable[Outcome], answers: Path) -> list[str]:
    """The table in Markdown, and the counts."""
    rows = [
        "| case | hidden | verdict | 90 % set | added | gap closed: same / held out | s | judged |",
        "|---|---|---|---|---|---|---|---|",
    ]
    counts: dict[str, int] = {}
    for one in found:
        truth, right = judged(one, json.loads((answers / f"{one.case}.json").read_text()))
        counts[right] = counts.get(right, 0) + 1
        p = one.product
        if one.failure:
            rows.append(f"| {one.case} | {truth} | {one.failure[:60]} | | | | | {right} |")
            continue
        top = p["posterior"]["none"] if p["verdict"] == "none" else max(p["posterior"].values())
        names = ", ".join(row["name"] for row in p["effects"]) or "-"
        closed = " / ".join(percent(p["gap"]["closed_fraction"].get(arm)) for arm in ("same", "held_out"))
        rows.append(
            f"| {one.case} | {truth} | {p['verdict']} ({top:.2f}) | {', '.join(p['set90'])} | {names} | {closed} "
            f"| {one.seconds:.0f} | {right} |"
        )
    return [*rows, "", ", ".join(f"{name}: {number}" for name, number in sorted(counts.items()))]


def main() -> int:
    """Diagnose all cases, then compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=Path, required=True)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--table", default="practice", help="which of the page's tables to write")
    asked = parser.parse_args()
    one_thread()
    names = sorted(p.name for p in (asked.cases / "raw_tests").iterdir() if (p / "test.toml").exists())
    found = []
    with tempfile.TemporaryDirectory() as scratch:
        for name in names:
            found.append(kept(asked.cases.resolve(), name, Path(scratch), digest_of(PACKAGE)))
            said = found[-1].product.get("verdict", found[-1].failure)
            print(f"{name}: {said} ({found[-1].seconds:.1f} s)", file=sys.stderr)
    lines = table(found, asked.cases / "answers")
    print("\n".join(lines))
    if asked.write:
        put(asked.write, asked.table, lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
