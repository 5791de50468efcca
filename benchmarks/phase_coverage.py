"""How often the 95 % intervals of the phases hold the truth, on simulated logs of all kinds: into docs/phases.md.

Constants were chosen on seeds from 0 on, which are not reported. Results are kept in .cache/: goes on where stopped.

    python -m benchmarks.phase_coverage [--cases 300] [--first 1000] [--write]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from benchmarks.recovery import run, wilson
from benchmarks.studies import one_thread, put

PAGE = Path(__file__).resolve().parent.parent / "docs" / "phases.md"
EVENTS = ("t_feed", "t_v", "t_purge", "t_fuel_out", "t_fuel_gone", "t_end")
KINDS: dict[str, Callable[[dict[str, Any]], bool]] = {
    "all": lambda kind: True,
    "20 and 50 Hz": lambda kind: kind["rate"] < 100.0,
    "100 and 200 Hz": lambda kind: 100.0 <= kind["rate"] < 500.0,
    "500 Hz to 2 kHz": lambda kind: kind["rate"] >= 500.0,
    "uneven times": lambda kind: kind["jitter"] > 0.0,
    "readings of 10 bits": lambda kind: kind["bits"] == 10,
    "white noise": lambda kind: kind["slow"] == 0.0,
    "slow noise": lambda kind: kind["slow"] > 0.0,
    "sensors lag by up to 2 ms": lambda kind: kind["lag"] > 0.0,
    "fuel ends before the liquid": lambda kind: kind["fuel"] == "before",
    "fuel ends with the liquid": lambda kind: kind["fuel"] == "with",
    "fuel ends after the liquid": lambda kind: kind["fuel"] == "after",
    "fades over 0.03 to 0.1 s": lambda kind: kind["fuel"] != "left" and kind["fade"] < 0.1,
    "fades over 0.1 to 0.3 s": lambda kind: kind["fuel"] != "left" and 0.1 <= kind["fade"] < 0.3,
    "fades over 0.3 to 2 s": lambda kind: kind["fuel"] != "left" and kind["fade"] >= 0.3,
    "nitrogen before the liquid is gone": lambda kind: kind["purge"] == "early",
    "nitrogen after it": lambda kind: kind["purge"] == "late",
    "two firings": lambda kind: kind["firings"] == 2,
}


def case(seed: int) -> dict[str, Any]:
    """One log, its truth, and what is found of it."""
    from simulated.phased import as_found, draw

    return {"case": seed, **as_found(draw(seed))}


def held(results: list[dict[str, Any]], name: str) -> tuple[int, int]:
    """In how many logs an event's interval holds the truth, of how many in which it is there and found."""
    pairs = [(r["truth"][name], r["found"][name]) for r in results]
    inside = [f["ci95"][0] <= t <= f["ci95"][1] for t, f in pairs if t is not None and f["value"] is not None]
    return sum(inside), len(inside)


def lines(results: list[dict[str, Any]]) -> Iterator[str]:
    """The table: for every kind of log the part of the intervals that hold, and for all how many answer."""
    yield f"{len(results)} logs. Per cent of the 95 % intervals that hold the truth (of how many):\n"
    yield f"| logs | {' | '.join(EVENTS)} |"
    yield f"|---|{'---|' * len(EVENTS)}"
    for name, belongs in KINDS.items():
        some = [r for r in results if belongs(r["kind"])]
        yield f"| {name} | {' | '.join(_share(*held(some, event)) for event in EVENTS)} |"
    yield f"| all, 95 % limits | {' | '.join(_limits(*held(results, event)) for event in EVENTS)} |"
    yield f"| event is there, not found | {' | '.join(str(_missing(results, event)) for event in EVENTS)} |"
    yield f"| found, is not there | {' | '.join(str(_invented(results, event)) for event in EVENTS)} |"


def _share(k: int, n: int) -> str:
    return f"{100.0 * k / n:.0f} ({n})" if n else "-"


def _limits(k: int, n: int) -> str:
    low, high = wilson(k, n)
    return f"{100.0 * low:.1f} to {100.0 * high:.1f}"


def _missing(results: list[dict[str, Any]], name: str) -> int:
    return sum(r["truth"][name] is not None and r["found"][name]["value"] is None for r in results)


def _invented(results: list[dict[str, Any]], name: str) -> int:
    return sum(r["truth"][name] is None and r["found"][name]["value"] is not None for r in results)


def main() -> None:
    """Go through the logs that have no result yet, and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="docs/phases.md")
    arguments = parser.parse_args()
    one_thread()
    seeds = range(arguments.first, arguments.first + arguments.cases)
    results = run("phases", seeds, case, arguments.processes)
    table = list(lines(results))
    print("\n".join(table))
    if arguments.write:
        put(PAGE, "coverage", table)


if __name__ == "__main__":
    main()
