"""Diagnosis of the replicas HF4 and HF5, each proven on the other, by the method and without each of its parts.

python -m benchmarks.replicas [--write docs/diagnosis.md] (`make replicas`)

The adopted constants of one test are frozen on the other. Products go to a temporary folder.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.studies import one_thread, percent, put

from hfanalysis.diagnose.naming.variants import VARIANTS
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).resolve().parent.parent
PAIRS = (("HF5", "HF4"), ("HF4", "HF5"))
ARMS = ("same", "held_out", "other_test", "placebo")
CHANNELS = {"p_tank": ("bar", 1e5), "p_run": ("bar", 1e5), "p_chamber": ("bar", 1e5), "thrust": ("N", 1.0)}


def diagnosed(test: str, other: str, variant: str, scratch: Path) -> dict[str, Any]:
    """The product of one diagnosis."""
    out = scratch / (variant or "method")
    settings = {"diagnose.proof_test": other, **({"diagnose.variant": variant} if variant else {})}
    run_to("calibrate", open_test(ROOT, other, out=out))
    return dict(run_to("diagnose", open_test(ROOT, test, out=out, settings=settings)).read_json("diagnosis.json"))


def row(test: str, variant: str, product: Mapping[str, Any]) -> str:
    """One line of the table."""
    gap = product["gap"]
    closed = " / ".join(percent(gap["closed_fraction"].get(arm)) for arm in ARMS)
    rms = "; ".join(
        f"{name} {gap['before'][name] / scale:.2f} to {gap['after'][name] / scale:.2f} {unit}"
        for name, (unit, scale) in CHANNELS.items()
        if name in gap["before"] and name in gap["after"]
    )
    m = [product["constants"][arm].get("m") for arm in ("without", "with") if arm in product["constants"]]
    exponents = " to ".join("-" if x is None else f"{x['value']:.3f} ± {x['std']:.3f}" for x in m)
    named = ", ".join(f"{e['name']} ({e['probability']:.2f})" for e in product["effects"]) or product["verdict"]
    return f"| {test} | {variant or 'the method'} | {named} | {closed} | {rms} | {exponents} |"


def sizes(test: str, product: Mapping[str, Any]) -> list[str]:
    """What each effect is, where and when, and whether that is possible."""
    plausible = {e["name"]: e["plausibility"]["why"] for e in product["effects"]}
    out = []
    for place in product["localisation"]:
        source, start, end = place["source"], place["t_start"], place["t_end"]
        why = plausible.get(place["site"], "no name explains it")
        out.append(
            f"| {test} | {place['site']} | {place['equation']} | {start['value']:.2f} to {end['value']:.2f} "
            f"| {source['value']:.4g} ± {source['std']:.2g} {source['unit']} | {why} |"
        )
    return out


def main() -> int:
    """Diagnose both replicas by every variant."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    rows = [
        f"| test | | named | gap closed: {' / '.join(ARMS)} | rms without and with | m without and with |",
        "|---|---|---|---|---|---|",
    ]
    places = ["| test | source | equation | from, to [s] | mean | possible? |", "|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as scratch:
        for variant in VARIANTS:
            for test, other in PAIRS:
                product = diagnosed(test, other, variant, Path(scratch))
                rows.append(row(test, variant, product))
                print(rows[-1], file=sys.stderr, flush=True)
                places += sizes(test, product) if not variant else []
    lines = [*places, "", *rows]
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "replicas", lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
