"""Constants after an effect is adopted, beside what is true, on simulated tests of other worlds.

python -m benchmarks.adopted [--set development] [--limit 90] [--jobs 2] [--write docs/calibration.md]

Of every test that hides effects of the library, each visible, those effects alone are tried and what is found of them
is adopted: whether a name is right is another question. Then the constants are calibrated with them. A constant counts
where the test's law has it; flow, regression rate and what is left at the end of the liquid count everywhere. What came
of each test lies under .cache/adopted/SET.jsonl, and is found anew by another version of the package.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.blind.folder import PACKAGE
from benchmarks.blind.folder import digest as digest_of
from benchmarks.prediction import rows_of
from benchmarks.studies import one_thread, percent, put
from benchmarks.worlds import VISIBLE, Study
from simulated.worlds.plan import SETS, Test, plan

CACHE = Path(__file__).resolve().parents[1] / ".cache" / "adopted"

LAWFUL = {
    "C_i": ("injector", {"orifice"}),
    "K_loss": ("feed", {"quadratic"}),
    "m": ("vapor", {"polytrope"}),
    "a": ("grain", {"oxidizer_flux"}),
    "n": ("grain", {"oxidizer_flux"}),
}
"""Of each constant the equation of its law, and the laws that have it."""

RUN = ("oxidizer of the liquid phase", "oxidizer left at its end", "regression rate")
"""What every law has."""


def run_one(name: str, study: Study) -> dict[str, Any]:
    """One test from its log to its constants; it raises nothing."""
    (test,) = (test for test in study.tests if test.id == name)
    found: dict[str, Any] = {"test": name, "effects": test.effects, "digest": study.digest}
    try:
        with tempfile.TemporaryDirectory() as folder:
            found |= adopted(test, Path(folder))
    except Exception as error:
        from hfanalysis.interface.ending import plainly

        known = plainly(error)
        found |= {"failure": known[1] if known else traceback.format_exc(), "defect": known is None}
    return found


def adopted(test: Test, root: Path) -> dict[str, Any]:
    """What is hidden adopted, and the constants beside the truth."""
    from simulated.worlds.write import answer_path, write_test

    from hfanalysis.cli.adopt import adopt
    from hfanalysis.diagnose.diagnosis import diagnose
    from hfanalysis.effects import library
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.stages.diagnose import subject_of
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    write_test(test, root)
    answer = json.loads(answer_path(test.id, root).read_text(encoding="utf-8"))
    if min(e["d_prime"] for e in answer["effects"].values()) < VISIBLE:
        return {"left": "not visible"}
    context = run_to("calibrate", open_test(root, test.id))
    known = {name: effect for name, effect in library().items() if name in test.effects}
    product = diagnose(subject_of(context), known).product
    if product.verdict != "named":
        return {"left": f"found {product.verdict}"}
    adopt(context, product)
    found = run_to("calibrate", open_test(root, test.id)).read(Calibration)
    if found.joint is None or "n" not in found.joint.names:
        return {"left": "not fitted together: " + " ".join(found.warnings)[-200:]}
    return {"told": told(found, answer), "regression": answer["laws"]["grain"]}


def told(found: Any, answer: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Of every quantity that both have: value, deviation, ends of its interval, and truth."""
    true = {n: answer["truth"][n] for n, (equation, laws) in LAWFUL.items() if answer["laws"][equation] in laws}
    run, flux = answer["run"], found.regression.reference_flux.value
    pairs = {n: (getattr(found, n), value) for n, value in true.items()}
    pairs[RUN[0]] = found.oxidizer_mass_liquid_phase, run["gone_at_t_v"]
    pairs[RUN[1]] = found.vapor_mass_at_t_v, run["left_at_t_v"]
    by_flux = np.argsort(run["flux"])
    flows, rates = (np.log(np.array(run[name])[by_flux]) for name in ("flux", "rate"))
    pairs[RUN[2]] = found.regression_rate_reference, float(np.exp(np.interp(np.log(flux), flows, rates)))
    return {
        name: {"value": q.value, "std": q.std or 0.0, "low": q.interval[0], "high": q.interval[1], "true": value}
        for name, (q, value) in pairs.items()
        if q.value is not None and q.interval is not None
    }


def figures(rows: Sequence[dict[str, Any]]) -> list[str]:
    """How often intervals hold what is true, and how far constants are off, in Markdown."""
    done = [row["told"] for row in rows if "told" in row]
    left = [row for row in rows if "told" not in row]
    lines = [
        f"{len(rows)} tests with hidden effects: {len(done)} calibrated with them, {len(left)} left out.",
        "",
        "| quantity | tests | 95 % intervals that hold it | mean error | mean half-width |",
        "|---|---|---|---|---|",
    ]
    for name in (*LAWFUL, *RUN):
        lines.append(_row(name, [row[name] for row in done if name in row]))
    every = [row[name] for row in done for name in (*LAWFUL, *RUN) if name in row]
    return [*lines, _row("**all**", every), "", f"The regression rate holds {_by_law(rows)}."]


def _by_law(rows: Sequence[dict[str, Any]]) -> str:
    """In how many tests of each law of regression the rate is held, in words."""
    held: dict[str, list[bool]] = {}
    for row in rows:
        if "told" in row and RUN[2] in row["told"]:
            rate = row["told"][RUN[2]]
            held.setdefault(row["regression"], []).append(rate["low"] <= rate["true"] <= rate["high"])
    return ", ".join(
        f"in {sum(h)} of {len(h)} with a law by {law.replace('_', ' ')}" for law, h in sorted(held.items())
    )


def _row(name: str, found: Sequence[dict[str, float]]) -> str:
    if not found:
        return f"| {name} | 0 | - | - | - |"
    held = np.mean([q["low"] <= q["true"] <= q["high"] for q in found])
    scale = [1.0 if name in ("m", "n") else abs(q["true"]) for q in found]
    off = np.mean([abs(q["value"] - q["true"]) / size for q, size in zip(found, scale, strict=True)])
    half = np.mean([0.5 * (q["high"] - q["low"]) / size for q, size in zip(found, scale, strict=True)])
    shown = (f"{x:.3f}" if name in ("m", "n") else f"{100.0 * x:.1f} %" for x in (off, half))
    return f"| {name} | {len(found)} | {percent(float(held))} | " + " | ".join(shown) + " |"


def main() -> int:
    """Run the tests that are not done, and say what came of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--set", choices=sorted(SETS), default="development")
    parser.add_argument("--limit", type=int, default=90)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    from hfanalysis.campaign.cluster import Cluster

    tests = [t for t in plan(asked.set, max(asked.limit, 60))[: asked.limit] if t.kind in ("single", "pair")]
    digest, kept = digest_of(PACKAGE), CACHE / f"{asked.set}.jsonl"
    kept.parent.mkdir(parents=True, exist_ok=True)
    rows = {row["test"]: row for row in rows_of(kept, digest)}
    todo = [test.id for test in tests if test.id not in rows]
    with Cluster(asked.jobs) as cluster, kept.open("a", encoding="utf-8") as out:
        for name, row in cluster.each(run_one, todo, Study(CACHE, tuple(tests), digest)):
            if isinstance(row, str):
                raise SystemExit(row)
            rows[name] = row
            out.write(json.dumps(row) + "\n")
            out.flush()
            said = {n: round((q["value"] - q["true"]) / (q["std"] or 1.0), 1) for n, q in row.get("told", {}).items()}
            print(name, "+".join(row["effects"]), said or row.get("left") or row["failure"].strip().splitlines()[-1],
                  file=sys.stderr, flush=True)  # fmt: skip
    lines = figures([rows[test.id] for test in tests])
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "adopted", lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
