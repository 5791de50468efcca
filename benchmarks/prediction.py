"""The second of two tests of a stand predicted from the first, on simulated stands: whether the bands hold, and rivals.

python -m benchmarks.prediction [--set scored] [--limit 60] [--jobs 2] [--write docs/predict.md]

The first test is diagnosed, and what is named is adopted; with ``--bare`` it is not. Tests and what came of them lie
under .cache/prediction/SET; a run goes on where it was stopped, and what another version of the package found is found
anew.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
import tomllib
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from statistics import mean
from time import perf_counter
from typing import Any

import numpy as np
from benchmarks.blind.folder import PACKAGE
from benchmarks.blind.folder import digest as digest_of
from benchmarks.studies import one_thread, percent, put
from simulated.worlds.pairs import SETS, plan, tests_of, write_pair

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / ".cache" / "prediction"
RIVALS = {"as_last_time": "as last time", "without_effects": "without effects"}
FREEDOMS = (2, 3, 4, 6, 10, 30)
"""Degrees of freedom that are tried."""


@dataclass(frozen=True)
class Study:
    """Where pairs lie, which set they are of, and of which version what is found is."""

    root: Path
    which: str
    count: int
    digest: str
    bare: bool
    out: Path | None = None


def plan_of(root: Path, test: str, temperature: str, name: str = "") -> Path:
    """The test.toml of a fired test as it was before, of another ``name``: without what the log adds, with the tank's
    temperature."""
    from hfanalysis.record.planned import FIRED
    from hfanalysis.record.written import table_lines

    content = tomllib.loads((root / "raw_tests" / test / "test.toml").read_text(encoding="utf-8"))
    content["tank"]["temperature"] = temperature
    content["test"]["id"] = name or test
    sections = {key: part for key, part in content.items() if key not in FIRED and isinstance(part, dict)}
    lines = [line for key, part in sections.items() for line in table_lines(part, key)]
    path = root / f"{name or test}.toml"
    path.write_text("\n".join(["schema = 1", *lines]) + "\n", encoding="utf-8")
    return path


def run_one(name: str, study: Study) -> dict[str, Any]:
    """One pair from its logs to the score, or what it ended with; it raises nothing."""
    pair = next(p for p in plan(study.which, study.count) if p.id == name)
    root, began = study.root / name, perf_counter()
    shutil.rmtree(root, ignore_errors=True)
    found: dict[str, Any] = {"pair": name, "effects": pair.effects, "digest": study.digest}
    try:
        write_pair(pair, root)
        answer = json.loads((root / "answers" / f"{tests_of(pair)[1]}.json").read_text(encoding="utf-8"))
        found |= predicted(tests_of(pair), answer["temperature"], root, study.bare) | {"true": answer["scatter"]}
    except Exception as error:
        from hfanalysis.interface.ending import plainly

        known = plainly(error)
        found |= {"failure": known[1] if known else traceback.format_exc(), "defect": known is None}
    shutil.rmtree(root, ignore_errors=True)
    return {**found, "seconds": perf_counter() - began}


def predicted(tests: tuple[str, str], temperature: str, root: Path, bare: bool) -> dict[str, Any]:
    """The second of two tests from the first, which is diagnosed, and what is named adopted, unless ``bare``."""
    from hfanalysis.interface import predicting
    from hfanalysis.interface.bringing import bring
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.simulation.foretelling import logs_of

    first, second = tests
    adopted = () if bare else adopt_named(root, first)
    predicting.predict(plan_of(root, second, temperature), [first], root)
    score = predicting.score(second, root)
    both = [bring("calibrate", root, test).read(Calibration) for test in tests]
    return {
        "adopted": adopted,
        "scored": {
            quantity: {"holds": s.holds, "error": s.error, "rivals": s.rivals, "off": _off(s)}
            for quantity, s in score.scored.items()
        },
        "moved": {name: values[1] - values[0] for name, values in logs_of(both).items()},
    }


def replicas() -> list[str]:
    """HF4 and HF5, each from the other, with the temperature that its own log tells: with effects and without."""
    lines = [
        "| replica | from | effects adopted | bands that hold | mean error | as last time |",
        "|---|---|---|---|---|---|",
    ]
    for first, second in (("HF4", "HF5"), ("HF5", "HF4")):
        for bare in (True, False):
            with tempfile.TemporaryDirectory() as scratch:
                root = Path(scratch)
                for test in (first, second):
                    shutil.copytree(ROOT / "raw_tests" / test, root / "raw_tests" / test)
                found = predicted((first, second), _of_the_log(root, second), root, bare)
            scored = list(found["scored"].values())
            held, errors = [s["holds"] for s in scored], [abs(s["error"]) for s in scored]
            last = [abs(s["rivals"]["as_last_time"]) for s in scored]
            adopted = ", ".join(found["adopted"]) or "none"
            lines.append(f"| {second} | {first} | {adopted} | {sum(held)} of {len(held)} | {percent(mean(errors))} | "
                         f"{percent(mean(last))} |")  # fmt: skip
    return lines


def _of_the_log(root: Path, test: str) -> str:
    from hfanalysis.interface.bringing import bring
    from hfanalysis.interface.of_test import engine_of_test

    return f"{engine_of_test(bring('validate', root, test)).full.engine.temperature:.2f} K"


def adopt_named(root: Path, test: str) -> tuple[str, ...]:
    """Diagnose a test and adopt what is named, as ``hfa diagnose --apply``."""
    from hfanalysis.cli.adopt import adopt
    from hfanalysis.errors import AbsentError
    from hfanalysis.interface.bringing import bring
    from hfanalysis.products.diagnosis import Diagnosis

    context = bring("diagnose", root, test)
    found = context.read(Diagnosis)
    try:
        adopt(context, found)
    except AbsentError:
        return ()
    return tuple(effect.name for effect in found.effects)


def _off(scored: Any) -> float | None:
    """How far what was measured lies off the median, over half the band."""
    measured, told = scored.measured.value, scored.foretold
    if scored.holds is None:
        return None
    return float((measured - told.value) / (0.5 * (told.high - told.low)))


def rows_of(kept: Path, digest: str) -> list[dict[str, Any]]:
    """What this version of the package has found so far."""
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.is_file() else []
    return [row for row in map(json.loads, lines) if row["digest"] == digest]


def figures(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Tables of how often the bands held, and of the errors beside the rivals'."""
    done = [row for row in rows if "scored" in row]
    adopted = [row for row in done if row["adopted"]]
    out = [
        f"{len(rows)} pairs: {len(done)} predicted and scored, {len(rows) - len(done)} refused; "
        f"in {len(adopted)} an effect is adopted from the first test.",
        "",
        "| quantity | bands that hold | mean error | as last time | without effects |",
        "|---|---|---|---|---|",
    ]
    out += _rows(done, "{}") + _rows(adopted, "{}, where effects are adopted")
    for name in ("C_i", "regression rate") if done else ():
        spread = sqrt(mean(row["moved"][name] ** 2 for row in done) / 2.0)
        true = sqrt(mean(row["true"][name] ** 2 for row in done))
        scale, freedom = fitted([row["moved"][name] for row in done])
        said = f"From test to test {name} as calibrated scatters by {100.0 * spread:.1f} %"
        law = f"Student's t of {freedom} degrees of freedom and {100.0 * scale:.1f} % fits it best"
        out += ["", f"{said} (root mean square; of the truth {100.0 * true:.1f} %); {law}."]
    for row in rows:
        if "failure" in row:
            out += ["", f"- {row['pair']}: {row['failure'].strip().splitlines()[-1]}"]
    return out


def fitted(moved: Sequence[float]) -> tuple[float, int]:
    """Scale [-] and degrees of freedom of how far a test is from the stand's mean, by the differences of two."""
    from scipy.stats import t

    off = np.array(moved) / sqrt(2.0)
    found = [(t.fit(off, f0=freedom, floc=0.0)[2], freedom) for freedom in FREEDOMS]
    return max(found, key=lambda one: float(t.logpdf(off, one[1], scale=one[0]).sum()))


def _rows(pairs: Sequence[dict[str, Any]], label: str) -> list[str]:
    """A row for each quantity, and one for all."""
    every = [(quantity, s) for row in pairs for quantity, s in row["scored"].items()]
    names = dict.fromkeys(name for name, _ in every)
    return [
        *(_row(label.format(name), [s for own, s in every if own == name]) for name in names),
        _row(label.format("**all**"), [s for _, s in every]),
    ]


def _row(name: str, of: Sequence[dict[str, Any]]) -> str:
    told = [s["holds"] for s in of if s["holds"] is not None]
    whole = [s for s in of if s["error"] is not None and None not in s["rivals"].values()]
    errors = [mean(abs(s["error"]) for s in whole)] if whole else [None]
    errors += [mean(abs(s["rivals"][rival]) for s in whole) if whole else None for rival in RIVALS]
    held = f"{percent(mean(told))} ({sum(told)} of {len(told)})" if told else "-"
    return f"| {name} | {held} | " + " | ".join("-" if e is None else f"{100.0 * e:.1f} %" for e in errors) + " |"


def main() -> int:
    """Run the pairs that are not done, and say what came of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--set", choices=sorted(SETS), default="scored")
    parser.add_argument("--limit", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--bare", action="store_true", help="without diagnosis and effects")
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    from hfanalysis.campaign.cluster import Cluster

    digest = digest_of(PACKAGE)
    study = Study(
        CACHE / (f"{asked.set}-bare" if asked.bare else asked.set), asked.set, asked.limit, digest, asked.bare
    )
    study.root.mkdir(parents=True, exist_ok=True)
    kept = study.root.with_suffix(".jsonl")
    done = {row["pair"] for row in rows_of(kept, digest)}
    names = [pair.id for pair in plan(asked.set, asked.limit)]
    todo = [name for name in names if name not in done]
    if todo:
        with Cluster(asked.jobs) as cluster, kept.open("a", encoding="utf-8") as file:
            for name, row in cluster.each(run_one, todo, study):
                found = (
                    row if isinstance(row, dict) else {"pair": name, "digest": digest, "failure": row, "defect": True}
                )
                file.write(json.dumps(found) + "\n")
                file.flush()
                print(f"{name}: {_said(found)}", file=sys.stderr, flush=True)
    rows = [row for row in rows_of(kept, digest) if row["pair"] in names]
    lines = [*figures(rows), "", *replicas()] if not asked.bare else figures(rows)
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "prediction", lines)
    return int(any(row.get("defect") for row in rows))


def _said(row: dict[str, Any]) -> str:
    if "failure" in row:
        return str(row["failure"]).strip().splitlines()[-1]
    told = [s["holds"] for s in row["scored"].values() if s["holds"] is not None]
    return (
        f"{sum(told)} of {len(told)} hold, {'+'.join(row['effects']) or 'nothing'} -> {'+'.join(row['adopted']) or '-'}"
    )


if __name__ == "__main__":
    sys.exit(main())
