"""Localisation on tests whose truth is known: is the right equation first, and is nothing claimed where nothing is?

python benchmarks/localisation.py --cases ../shared/blind [--write docs/localisation.md]

CASES holds ``raw_tests/`` and ``answers/``; products go to a temporary folder. The answers are read only after all
verdicts are there.
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

from hfanalysis.errors import AnalysisError
from hfanalysis.stages.opening import open_test
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


@dataclass(frozen=True)
class Verdict:
    """What was found on one case: the equations of the sources in their order, or why there is no verdict."""

    case: str
    equations: tuple[str, ...]
    first: str
    evidence: float
    seconds: float
    failure: str = ""


def verdict(cases: Path, name: str, scratch: Path) -> Verdict:
    """Diagnose one case."""
    started = perf_counter()
    try:
        context = run_to("diagnose", open_test(cases, name, out=scratch / name))
    except AnalysisError as error:
        return Verdict(name, (), "", 0.0, perf_counter() - started, str(error))
    product = context.read_json("diagnosis.json")
    places = product["localisation"]
    first = places[0]["site"] if places else "-"
    evidence = places[0]["significance"] if places else product["ranking"][0]["log_evidence"]
    return Verdict(name, tuple(p["equation"] for p in places), first, evidence, perf_counter() - started)


def judged(found: Verdict, answer: dict[str, Any]) -> tuple[str, str]:
    """The truth in words, and whether the verdict is right."""
    hidden = answer["effect"] if isinstance(answer["effect"], dict) else {answer["effect"]: answer.get("strength")}
    truth = " + ".join(hidden)
    if found.failure:
        return truth, "no verdict"
    if truth == "none":
        return truth, "right" if not found.equations else "false claim"
    if not found.equations:
        return truth, "not seen"
    right = set().union(*(EQUATIONS[name] for name in hidden))
    return truth, "right" if found.equations[0] in right else "other equation"


def table(found: Iterable[Verdict], answers: Path) -> list[str]:
    """The table in Markdown, and the counts."""
    rows = ["| case | hidden | first source | ln evidence | all equations | verdict |", "|---|---|---|---|---|---|"]
    counts: dict[str, int] = {}
    for one in found:
        truth, right = judged(one, json.loads((answers / f"{one.case}.json").read_text()))
        counts[right] = counts.get(right, 0) + 1
        equations = ", ".join(one.equations) or one.failure[:60] or "-"
        rows.append(f"| {one.case} | {truth} | {one.first} | {one.evidence:.0f} | {equations} | {right} |")
    return [*rows, "", ", ".join(f"{name}: {number}" for name, number in sorted(counts.items()))]


def main() -> int:
    """Diagnose all cases, then compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=Path, required=True)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    names = sorted(p.name for p in (asked.cases / "raw_tests").iterdir() if (p / "test.toml").exists())
    found = []
    with tempfile.TemporaryDirectory() as scratch:
        for name in names:
            found.append(verdict(asked.cases, name, Path(scratch)))
            print(f"{name}: {found[-1].first} ({found[-1].seconds:.1f} s) {found[-1].failure}", file=sys.stderr)
    lines = table(found, asked.cases / "answers")
    print("\n".join(lines))
    if asked.write:
        start, end = "<!-- practice: begin -->", "<!-- practice: end -->"
        page = asked.write.read_text()
        head, tail = page.split(start)[0], page.split(end)[1]
        asked.write.write_text(f"{head}{start}\n" + "\n".join(lines) + f"\n{end}{tail}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
