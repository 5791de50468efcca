"""Oscillations found in simulated burns whose oscillations are known, smooth ones among them; and begin and end.

python -m benchmarks.oscillations [--n 200] [--write docs/validation.md]

Lines of 5 to 200 Hz and 0.5 to 20 % of the mean, one or two, some that move, driven by the feed or not, sampled at
50 Hz to 5 kHz beside a hum of the mains; as many burns without any; and as many whose begin and end are known
(:mod:`simulated.oscillating`). What is found is kept in .cache/oscillations/, of which a later run goes on.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.studies import one_thread, percent, put

if TYPE_CHECKING:
    from simulated.oscillating import Case, Swing

    from hfanalysis.products.stability import Line, Stability

KEPT = Path(".cache/oscillations/found.jsonl")
KINDS = "swings", "smooth", "starts"

Row = dict[str, Any]


def found(kind: str, seed: int) -> Row:
    """One burn."""
    return {"kind": kind, "seed": seed, **(_starts(seed) if kind == "starts" else _swings(seed, kind == "smooth"))}


def _starts(seed: int) -> Row:
    from simulated.oscillating import END, started

    from hfanalysis.performance.measured import Fire
    from hfanalysis.performance.transients import transients

    made = started(seed)
    told = transients(made.log, made.segments, made.definition, Fire(END, 0.02, ""))
    inside = {}
    for name, true in made.true.items():
        interval = told[name].interval
        inside[name] = None if interval is None else bool(interval[0] <= true <= interval[1])
    return {"inside": inside}


def _swings(seed: int, smooth: bool) -> Row:
    from simulated.oscillating import END, case, modes_of, oscillating

    from hfanalysis.performance.stability.stability import stability

    of = case(seed, smooth)
    log, segments = oscillating(of)
    told = stability(log, segments, END, lambda _start, _end: modes_of(of))
    lines = [line for line in told.lines if "at rest" not in line.cause]
    return {
        "rate": of.rate,
        "lines": len(lines),
        "swings": [_beside(swing, of, told, lines) for swing in of.swings],
        "verdict": told.verdict,
    }


def _beside(swing: Swing, of: Case, told: Stability, lines: Sequence[Line]) -> Row:
    """A true line beside the one that was found for it."""
    from simulated.oscillating import LIQUID, OWN

    from hfanalysis.performance.stability.causes import FEED, aliased

    ends = [swing.frequency + swing.chirp * t for t in (0.0, LIQUID)]
    mean = 0.5 * (ends[0] + ends[1])
    folded = max(ends) > 0.5 * of.rate
    shown = aliased(mean, of.rate)
    liquid = [line for line in lines if line.phase == "liquid" and "p_chamber" in line.channels]
    limit = told.detection_limit.value if told.detection_limit is not None else None
    row: Row = {"frequency": mean, "share": swing.share, "chirp": swing.chirp, "fed": swing.fed, "folded": folded,
                "above": limit is not None and swing.share > limit}  # fmt: skip
    near = [line for line in liquid if abs((line.frequency.value or 0.0) - shown) < max(2.0, 0.05 * shown)]
    if not near:
        return row
    line = min(near, key=lambda each: abs((each.frequency.value or 0.0) - shown))
    low, high = line.frequency.interval or (0.0, 0.0)
    untold = "cannot be told" in line.cause
    right = line.cause == (FEED if swing.fed else OWN)
    return row | {
        "seen": True,
        "in band": low <= shown <= high,
        "off": abs((line.amplitude.value or 0.0) / (swing.share) - 1.0),
        "right": right,
        "untold": untold,
        "true among": swing.fed or OWN in line.cause,
        "cause": line.cause,
    }


def run(number: int) -> list[Row]:
    """Those that are kept, and the others."""
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    rows = [json.loads(line) for line in KEPT.read_text("utf-8").splitlines()] if KEPT.exists() else []
    done = {(row["kind"], row["seed"]) for row in rows}
    asked = [(kind, seed) for seed in range(number) for kind in KINDS]
    with KEPT.open("a", encoding="utf-8") as file:
        for kind, seed in asked:
            if (kind, seed) in done:
                continue
            rows.append(found(kind, seed))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
            if len(rows) % 50 == 0:
                print(f"{len(rows)} of {len(asked)}", flush=True)
    return [row for row in rows if row["seed"] < number]


COLUMNS = ("lines above the detection limit", "n", "found", "frequency in its band", "amplitude within 20 %",
           "cause right", "cannot be told", "wrong")  # fmt: skip


def table(rows: Sequence[Row]) -> Iterator[str]:
    """Lines of Markdown."""
    swings = [(row["rate"], s) for row in rows if row["kind"] == "swings" for s in row["swings"]]
    plain = [(rate, s) for rate, s in swings if not s["folded"] and s["above"]]
    yield "| " + " | ".join(COLUMNS) + " |"
    yield "|---" * len(COLUMNS) + "|"
    yield _row("all, below half the rate", [s for _, s in plain])
    for rate in sorted({rate for rate, _ in plain}):
        yield _row(f"at {rate:.0f} Hz", [s for of, s in plain if of == rate])
    yield _row("that move", [s for _, s in plain if s["chirp"]])
    yield _row("driven by the feed", [s for _, s in plain if s["fed"]])
    yield _row("of the combustion", [s for _, s in plain if not s["fed"]])
    yield ""
    folded = [s for _, s in swings if s["folded"] and s.get("seen")]
    ok = sum(bool(s["untold"] or s["true among"]) for s in folded)
    if folded:
        yield f"Folded down by the rate: {len(folded)} found; {ok} offer the true one or say that it cannot be told."
    smooth = [row for row in rows if row["kind"] == "smooth"]
    yield f"Of {len(smooth)} smooth burns {sum(row['lines'] > 0 for row in smooth)} have a line."
    starts = [row["inside"] for row in rows if row["kind"] == "starts"]
    for name in starts[0] if starts else ():
        told = [row[name] for row in starts if row[name] is not None]
        words = name.replace("_", " ").replace("5 percent", "(5 %)")
        inside, missing = percent(sum(told) / max(len(told), 1)), len(starts) - len(told)
        yield f"{words}: {inside} of {len(told)} in their intervals, {missing} not told."


def _row(name: str, part: Sequence[Row]) -> str:
    seen = [s for s in part if s.get("seen")]
    if not seen:
        return f"| {name} | {len(part)} | - | - | - | - | - | - |"

    def share(kept: Sequence[bool]) -> str:
        return percent(sum(kept) / len(kept))

    judged = ([s["in band"] for s in seen], [s["off"] < 0.2 for s in seen], [s["right"] for s in seen],
              [s["untold"] for s in seen], [not s["right"] and not s["untold"] for s in seen])  # fmt: skip
    return f"| {name} | {len(part)} | {percent(len(seen) / len(part))} | " + " | ".join(map(share, judged)) + " |"


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=200, help="burns of each kind")
    parser.add_argument("--write", type=Path, help="the page with the table")
    asked = parser.parse_args()
    one_thread()
    lines = list(table(run(asked.n)))
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "oscillations", lines)


if __name__ == "__main__":
    main()
