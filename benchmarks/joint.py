"""One regression law of several tests of a stand: is it right, is it tighter, and is the test with another fuel named?

python -m benchmarks.joint [--draws 400] [--write docs/campaign.md] (`make joint-study`)

Six simulated stands whose laws are the model's (simulated/worlds, without departures), each with twenty tests of other
loads, holes and temperatures and six more whose fuel regresses a tenth faster. Every draw takes 2 to 10 tests of a
stand; half of the draws of two, and of four and more, have one of the other fuel among them. Tests stand in several
draws. Each is calibrated as a campaign has it, and the draws' tests have one law as a campaign gives it.
What is done of a run that was stopped is kept below `.cache/joint`, for these sources.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.studies import one_thread, percent, put

ROOT = Path(__file__).resolve().parent.parent
STANDS, ALIKE, OTHER, FASTER = 6, 20, 6, 1.1
SEED = 9_000_000
LOGGER = "250 Hz, quiet, a minute of rest"
SIZES = (2, 10)
FROM_FOUR = 4
"""Tests of a draw from which on one can be odd."""


@dataclass(frozen=True)
class Draw:
    """Tests of a stand, and which of them has the other fuel."""

    name: str
    tests: tuple[str, ...]
    odd: str | None


def names(stand: int, other: bool) -> list[str]:
    """The tests of a stand with its fuel, or with the other one."""
    return [f"J{stand}{'x' if other else ''}{i:02d}" for i in range(OTHER if other else ALIKE)]


def write_stand(name: str, work: Any) -> None:
    """The tests of one stand, and what is true of it."""
    from simulated.blind.plan import Case
    from simulated.worlds import engines, laws, loggers
    from simulated.worlds.pairs import another
    from simulated.worlds.write import constants, fired, put

    number = int(name)
    rng = np.random.default_rng(SEED + number)
    plain = laws.World(np.zeros(laws.LAWS), "coolprop", (0.0, 0.0)).fading(0.01, 0.01)
    engine, logger = engines.QUICK[number % 4], loggers.LOGGERS[LOGGER]
    end = ("late", "left", "early")[number % 3]
    first = engines.drawn(rng, engine, end, plain)
    for other in (False, True):
        for test in names(number, other):
            own = another(rng, first, end, plain, {"C_i": 0.01, "regression rate": 0.0})
            stand = replace(own, a=own.a * (FASTER if other else 1.0))
            case = Case(test, "joint", (), 0.0, LOGGER, number, number, stand=f"joint {number}")
            made = fired(rng, case, stand, plain, (), logger, loggers.drawn(rng, logger, stand))
            put(made, {"id": test, "truth": constants(stand)}, work.root)


def plan(count: int) -> list[Draw]:
    """The draws, always the same."""
    rng = np.random.default_rng(SEED)
    out = []
    for i in range(count):
        stand, size = int(rng.integers(STANDS)), int(rng.integers(SIZES[0], SIZES[1] + 1))
        odd = str(rng.choice(names(stand, True))) if i % 2 and size != 3 else None
        alike = rng.choice(names(stand, False), size - (odd is not None), replace=False).tolist()
        out.append(Draw(f"D{i:03d}", (*alike, *([odd] if odd else [])), odd))
    return out


def judge(draw: Draw, laws: Mapping[str, Any]) -> dict[str, Any]:
    """What the tests of a draw say together, by the ``laws`` of all; a test that says nothing of its fuel is left
    out."""
    from hfanalysis.campaign.common_law import common_law, counts
    from hfanalysis.errors import AbsentError

    silent = [test for test in draw.tests if test not in laws or not counts(laws[test])]
    tests = [test for test in draw.tests if test not in silent]
    out = {"tests": tests, "silent": silent, "odd": draw.odd if draw.odd in tests else None}
    try:
        law = common_law({test: laws[test] for test in tests})
    except AbsentError as error:
        return out | {"reason": str(error)}
    return out | {
        "a": law.a.to_json(), "n": law.n.to_json(), "agree": law.agreement.probability,
        "named": law.odd.test if law.odd else None,
        "alone": {test: own.n.interval for test, own in law.alone.items()},
    }  # fmt: skip


def main() -> int:
    """The pool, the draws, and the lines of the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=400)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    from benchmarks import joint as own  # by which workers find it

    from hfanalysis.campaign.cluster import Cluster, version
    from hfanalysis.campaign.regression import law_in
    from hfanalysis.campaign.side_by_side import Work, run_one
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.disk import read_json

    kept = ROOT / ".cache" / "joint" / hashlib.sha256(version().encode()).hexdigest()[:12]
    work = Work(kept, to="calibrate")
    tests = [test for i in range(STANDS) for other in (False, True) for test in names(i, other)]
    files = {test: kept / "processed" / test / Calibration.file for test in tests}
    with Cluster() as cluster:
        stands = [str(i) for i in range(STANDS) if not (kept / "answers" / f"{names(i, True)[-1]}.json").exists()]
        _all(cluster, own.write_stand, stands, work)
        _all(cluster, run_one, [test for test, file in files.items() if not file.exists()], work)
    laws = {test: law_in(Calibration.from_json(read_json(file))) for test, file in files.items() if file.exists()}
    found, truth = [judge(draw, laws) for draw in plan(asked.draws)], _truth(kept)
    lines = [*told(found, truth), "", *by_stand(found, laws, truth)]
    print("\n".join(["", *lines]))
    if asked.write:
        put(asked.write, "joint", lines)
    return 0


def _all(cluster: Any, task: Any, todo: Sequence[str], work: Any) -> None:
    for done, (name, outcome) in enumerate(cluster.each(task, todo, work), start=1):
        if isinstance(outcome, str):
            raise SystemExit(outcome)
        print(f"\r{task.__name__}: {done} of {len(todo)} ({name})", end="", file=sys.stderr)


def _truth(kept: Path) -> dict[str, dict[str, float]]:
    """a and n of each stand, by its number."""
    answers = {str(i): kept / "answers" / f"{names(i, False)[0]}.json" for i in range(STANDS)}
    return {number: json.loads(path.read_text())["truth"] for number, path in answers.items()}


def told(found: Sequence[dict[str, Any]], truth: dict[str, dict[str, float]]) -> list[str]:
    """The lines of the page."""
    known = [one for one in found if "n" in one]
    level = [one for one in known if one["odd"] is None]
    odd = [one for one in known if one["odd"] is not None and len(one["tests"]) >= FROM_FOUR]
    pairs = [one for one in known if one["odd"] is not None and len(one["tests"]) == 2]
    many = [one for one in level if len(one["tests"]) >= FROM_FOUR]
    lines = [
        "| of draws without another fuel | a | n |",
        "|---|---|---|",
        *_intervals(level, truth),
        f"| narrower than the narrowest of the tests alone | | {_share(map(_narrower, level))} |",
        "",
        "| | |",
        "|---|---|",
        f"| one of 4 to 10 tests has another fuel: named | {_share(one['named'] == one['odd'] for one in odd)} |",
        f"| another one is named there | {_share(one['named'] not in (None, one['odd']) for one in odd)} |",
        f"| 4 to 10 tests of one fuel: one is named | {_share(one['named'] is not None for one in many)} |",
        f"| one of two has another fuel: they are said to disagree | {_share(one['agree'] < 0.01 for one in pairs)} |",
        f"| tests of one fuel are said to disagree | {_share(one['agree'] < 0.01 for one in level)} |",
    ]
    silent = sum(len(one["silent"]) for one in found)
    return [
        *lines,
        "",
        f"{len(known)} of {len(found)} draws; tests that said nothing of a and n were left out {silent} times.",
    ]


def _intervals(level: Sequence[dict[str, Any]], truth: dict[str, dict[str, float]]) -> list[str]:
    def of(one: dict[str, Any], name: str) -> tuple[float, float, tuple[float, float]]:
        right = truth[one["tests"][0][1]][name]
        return one[name]["value"], right, tuple(one[name]["ci95"] or (np.nan, np.nan))

    off: dict[str, list[float]] = {"a": [], "n": []}
    held: dict[str, list[bool]] = {"a": [], "n": []}
    for one in level:
        for name in off:
            value, right, (low, high) = of(one, name)
            off[name].append(value / right - 1.0 if name == "a" else value - right)
            held[name].append(low <= right <= high)
    a, n = (np.array(off[k]) for k in off)
    return [
        f"| mean error | {100.0 * a.mean():+.1f} % | {n.mean():+.4f} |",
        f"| standard deviation | {100.0 * a.std():.1f} % | {n.std():.4f} |",
        f"| 95 % intervals that hold the truth | {_share(held['a'])} | {_share(held['n'])} |",
    ]


def _narrower(one: dict[str, Any]) -> bool:
    low, high = one["n"]["ci95"]
    return bool(high - low < min(b - a for a, b in one["alone"].values()))


def by_stand(found: Sequence[dict[str, Any]], laws: Mapping[str, Any], truth: dict[str, dict[str, float]]) -> list[str]:
    """How far the rates of single tests are from the truth at their own flux, and how often the odd one is named."""
    lines = ["| stand | rates of single tests scatter by | the odd one of 4 to 10 is named |", "|---|---|---|"]
    for number, right in truth.items():
        own = [laws[test] for test in names(int(number), False) if test in laws]
        rates = [(law.regression_rate_reference.value, law.regression.reference_flux) for law in own]
        off = [np.log(rate / (right["a"] * flux.value ** right["n"])) for rate, flux in rates if rate and flux]
        odd = [one for one in found if one["odd"] and one["odd"][1] == number and len(one["tests"]) >= FROM_FOUR]
        named = _share(one.get("named") == one["odd"] for one in odd)
        lines.append(f"| {number} | {100.0 * float(np.std(off)):.1f} % | {named} |")
    return lines


def _share(found: Any) -> str:
    """A share in words, with how many of how many."""
    all_of = list(found)
    return f"{percent(sum(all_of) / len(all_of) if all_of else None)} ({sum(all_of)} of {len(all_of)})"


if __name__ == "__main__":
    sys.exit(main())
