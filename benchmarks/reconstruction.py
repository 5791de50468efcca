"""Mixtures reconstructed from simulated burns whose mixture is known: errors, bands, and what cannot be told.

python -m benchmarks.reconstruction [--n 300] [--draws 500] [--write docs/validation.md]

Burns of many sizes, loggers and worlds (:mod:`simulated.mixtures`), each reconstructed with all measurements, without
the throat's radius after, without that and thrust, and without the fuel weighed. What is found is kept in
.cache/reconstruction/, of which a later run goes on. One burn is measured anew DRAWS times, with errors drawn each
time: what the results scatter by, over what they say of themselves.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks.studies import one_thread, percent, put

KEPT = Path(".cache/reconstruction/found.jsonl")
MEASURED: dict[str, dict[str, bool]] = {
    "all": {},
    "no radius after": {"calipered": False},
    "neither radius after nor thrust": {"calipered": False, "thrust": False},
    "fuel not weighed": {"weighed": False},
}
"""What is left out of a burn's measurements."""

Row = dict[str, Any]


def found(seed: int, measured: str) -> Row:
    """Of one burn what its reconstruction says beside what was so."""
    import numpy as np
    from simulated.mixtures import burn, world

    from hfanalysis.performance.reconstruction.reconstruct import reconstruct

    of = replace(world(seed), **MEASURED[measured])
    made = burn(of, seed)
    again = reconstruct(made.test)
    row: Row = {"seed": seed, "measured": measured, "falls": of.falls, "erodes": of.erodes, "noise": of.noise,
                "throat": of.throat, "fades": of.fades, "of_fuel": of.of_fuel}  # fmt: skip
    if not again.histories:
        return row | {"refused": str(again.product.reason)}
    true = {"of_ratio": made.of_ratio, "c_star_efficiency": made.efficiency, "throat_radius": made.throat}
    for name, history in true.items():
        at = np.interp(again.time, made.time, history)
        center, low, high = again.histories[name]
        inside = (at >= low) & (at <= high)
        row |= {f"{name} inside": float(inside.mean()), f"{name} at end": bool(inside[-1])}
        if name == "of_ratio":
            off = np.abs(center / at - 1.0)
            told = again.told > 0.5
            row |= {"off": float(np.median(off)), "told": float(told.mean()),
                    "off told": float(np.median(off[told])) if told.any() else None}  # fmt: skip
    n = again.product.n
    if n is not None and n.value is not None and n.interval is not None:
        row |= {
            "n off": n.value - of.exponent,
            "n std": n.std,
            "n inside": n.interval[0] <= of.exponent <= n.interval[1],
        }
    return row


def run(number: int) -> list[Row]:
    """Those that are kept, and the others."""
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    rows = [json.loads(line) for line in KEPT.read_text("utf-8").splitlines()] if KEPT.exists() else []
    done = {(row["seed"], row["measured"]) for row in rows}
    asked = [(seed, measured) for seed in range(number) for measured in MEASURED]
    with KEPT.open("a", encoding="utf-8") as file:
        for seed, measured in asked:
            if (seed, measured) in done:
                continue
            rows.append(found(seed, measured))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
            if len(rows) % 100 == 0:
                print(f"{len(rows)} of {len(asked)}", flush=True)
    return [row for row in rows if row["seed"] < number]


def scatter(draws: int) -> Row:
    """One lean burn measured ``draws`` times."""
    import numpy as np
    from simulated.mixtures import World, burn

    from hfanalysis.performance.reconstruction.reconstruct import reconstruct

    means, stds = [], []
    for seed in range(draws):
        mean = reconstruct(burn(World(mixture=8.0, erodes=2e-4, noise=0.003), seed).test).product.of_ratio_mean
        if mean is not None and mean.value is not None and mean.std is not None:
            means.append(mean.value)
            stds.append(mean.std)
    return {"n": len(means), "scatter": float(np.std(means)), "said": float(np.median(stds))}


GROUPS: dict[str, Callable[[Row], bool]] = {
    "all measured, efficiency constant": lambda r: r["measured"] == "all" and r["falls"] == 0.0,
    "all measured, efficiency falls by up to 0.08": lambda r: r["measured"] == "all" and r["falls"] > 0.0,
    "of these, throat below 12 mm": lambda r: r["measured"] == "all" and r["throat"] < 0.012,
    "of these, throat of 20 mm and more": lambda r: r["measured"] == "all" and r["throat"] >= 0.02,
    "of these, noise of 1 %": lambda r: r["measured"] == "all" and r["noise"] == 0.01,
    "of these, the throat erodes": lambda r: r["measured"] == "all" and r["erodes"] > 0.0,
    "of these, fuel that fades": lambda r: r["measured"] == "all" and r["fades"] > 0.0,
    "no radius after": lambda r: r["measured"] == "no radius after",
    "neither radius after nor thrust": lambda r: r["measured"] == "neither radius after nor thrust",
    "fuel not weighed: `a`": lambda r: r["measured"] == "fuel not weighed",
}
"""Rows of the table."""


COLUMNS = ("burns", "n", "error of O/F", "told", "error where told", "O/F in its band", "efficiency in its band",
           "throat at the end in its band")  # fmt: skip


def table(rows: Sequence[Row], again: Row) -> Iterator[str]:
    """Lines of Markdown."""
    yield "| " + " | ".join(COLUMNS) + " |"
    yield "|---" * len(COLUMNS) + "|"
    for name, of in GROUPS.items():
        yield _row(name, [row for row in rows if of(row)])
    yield ""
    law = [r for r in rows if r["measured"] == "all" and r["of_fuel"] == 0.0 and r["fades"] == 0.0 and "n off" in r]
    yield from _exponents("is constant", [row for row in law if row["falls"] == 0.0])
    yield from _exponents("falls", [row for row in law if row["falls"] > 0.0])
    yield f"{sum('refused' in row for row in rows)} of {len(rows)} were refused."
    if again["n"]:
        yield (f"One burn measured {again['n']} times, its errors drawn anew: the mean O/F scatters by "
               f"{again['scatter']:.2f}, and says +/- {again['said']:.2f}.")  # fmt: skip


def _exponents(course: str, part: Sequence[Row]) -> Iterator[str]:
    """What n is off by."""
    if not part:
        return
    off, said = (sum(row[key] for row in part) / len(part) for key in ("n off", "n std"))
    inside = percent(sum(row["n inside"] for row in part) / len(part))
    yield (f"n where r = a G_o^n and the efficiency {course}: {off:+.3f} off in the mean of {len(part)} burns that say "
           f"+/- {said:.2f}; {inside} in their intervals.")  # fmt: skip


def _row(name: str, part: Sequence[Row]) -> str:
    import numpy as np

    part = [row for row in part if "refused" not in row]
    if not part:
        return f"| {name} | 0 | - | - | - | - | - | - |"

    def mean(key: str) -> str:
        return f"{100.0 * float(np.mean([row[key] for row in part])):.1f} %"

    told = [row["off told"] for row in part if row["off told"] is not None]
    of_told = f"{100.0 * float(np.median(told)):.1f} %" if told else "-"
    off = 100.0 * float(np.median([row["off"] for row in part]))
    ends = " | ".join(mean(k) for k in ("of_ratio inside", "c_star_efficiency inside", "throat_radius at end"))
    return f"| {name} | {len(part)} | {off:.1f} % | {mean('told')} | {of_told} | {ends} |"


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=300, help="burns")
    parser.add_argument("--draws", type=int, default=500, help="measurements of one burn")
    parser.add_argument("--write", type=Path, help="the page with the table")
    asked = parser.parse_args()
    one_thread()
    lines = list(table(run(asked.n), scatter(asked.draws)))
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "reconstruction", lines)


if __name__ == "__main__":
    main()
