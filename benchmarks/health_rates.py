"""How often a fault is found and how often a healthy log is blamed: docs/health-rates.md. Goes on where stopped.

python -m benchmarks.health_rates [--healthy 400] [--each 50] [--kinds zero,scale] [--write]

A fault *moves an answer* where a number that the log would give without any look at its channels' health has an
interval that does not hold what the same log without the fault gives.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np
from benchmarks.recovery import wilson
from benchmarks.studies import one_thread, put
from simulated.faults import healthy
from simulated.faults.kinds import FAULTS, Faulty, suits

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.errors import AnalysisError
from hfanalysis.health.judge import judge
from hfanalysis.performance.measured import measured
from hfanalysis.products.health import KINDS, Finding, Health
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log
from hfanalysis.segment.phases import find_phases

ROOT = Path(__file__).resolve().parent.parent
PAGE, CACHE = ROOT / "docs" / "health-rates.md", ROOT / ".cache" / "health-rates"
HEALTHY_SEEDS, FAULTY_SEEDS = 50_000, 60_000
"""Where the seeds of healthy logs and of those with a fault begin: none of them was looked at before the detectors were
as they are."""
FOUND, LEFT_OUT, NEIGHBOR, OTHERWISE, MISSED = "found", "left out", "neighbor", "otherwise", "missed"
NAMED = (FOUND, LEFT_OUT)
NEIGHBORS = {"scale": "unit", "unit": "scale", "zero": "drift", "drift": "zero"}
"""Kinds that say the same of a channel: that it is off by a factor, by an offset. The doubt is as wide."""
SAMPLES = 30
"""Drawn inputs of a calibration: intervals are known to an eighth."""


@dataclass(frozen=True)
class Case:
    """One log: the fault's kind ("" of a healthy one), its seed, what became of it, all findings, answers it moved."""

    kind: str
    seed: int
    size: str
    outcome: str
    findings: tuple[str, ...]
    moved: tuple[str, ...] = ()


def ingested(log: healthy.Log, folder: Path) -> tuple[TestLog, TestDefinition]:
    """The log as ingested, and what is stated."""
    healthy.write(folder / "T", log)
    definition = load_definition(folder / "T" / "test.toml")
    ingest(definition, folder / "ingest.h5")
    return read_log(folder / "ingest.h5"), definition


def answers(log: TestLog, definition: TestDefinition) -> dict[str, Quantity]:
    """The numbers that a log gives where nobody asks whether its channels can be believed."""
    try:
        segments = find_phases(log, definition)
        found = {"t_v": segments.t_v, **measured(log, segments, definition, None)}
    except AnalysisError:
        return {}
    try:
        constants = calibrate(log, segments, definition, SAMPLES).constants.quantities
    except AnalysisError:
        constants = {}
    return found | {name: constants[name] for name in ("C_i", "m") if name in constants}


def moved(right: dict[str, Quantity], found: dict[str, Quantity]) -> tuple[str, ...]:
    """The answers whose interval does not hold the right value."""
    there = {name: q for name, q in right.items() if q.value is not None and name in found}
    return tuple(name for name, q in there.items() if _outside(q.value, found[name]))


def _outside(right: float | None, found: Quantity) -> bool:
    if right is None or found.value is None or found.interval is None:
        return False
    low, high = found.interval
    return not low <= right <= high


def findings(health: Health) -> list[Finding]:
    """Each once."""
    found: list[Finding] = []
    for channel in health.channels.values():
        found += [f for f in channel.findings if f not in found]
    return found


def healthy_case(seed: int, folder: Path) -> Case:
    """A healthy log: whatever is found is wrong."""
    found = findings(judge(*ingested(healthy.draw(HEALTHY_SEEDS + seed), folder)))
    return Case("", seed, "", "blamed" if found else "healthy", _names(found))


def _names(found: list[Finding]) -> tuple[str, ...]:
    return tuple(f"{f.kind} {'/'.join(f.channels)}" for f in found)


def faulty_case(kind: str, seed: int, folder: Path) -> Case | None:
    """A log with a fault; None where it could not be told from that log by anybody."""
    clean = healthy.draw(FAULTY_SEEDS + seed)
    if not suits(clean, kind):
        return None
    faulty = FAULTS[kind](np.random.default_rng([FAULTY_SEEDS, seed]), clean)
    read, definition = ingested(faulty.log, folder)
    found = findings(judge(read, definition))
    outcome = _outcome(kind, [f.kind for f in found if set(f.channels) & set(faulty.channels)])
    if outcome != FOUND and _left_out(clean, faulty, read):
        outcome = LEFT_OUT
    # that a fault moves an answer is asked of those only that are not named
    silent = () if outcome in NAMED else moved(_right(seed, folder), answers(read, definition))
    return Case(kind, seed, faulty.size, outcome, _names(found), silent)


def _outcome(kind: str, own: list[str]) -> str:
    """By the kinds of what was found of the channels that are wrong."""
    if kind in own:
        return FOUND
    return (NEIGHBOR if NEIGHBORS.get(kind) in own else OTHERWISE) if own else MISSED


@cache
def _right(seed: int, folder: Path) -> dict[str, Quantity]:
    """The answers of the log without its fault."""
    return answers(*ingested(healthy.draw(FAULTY_SEEDS + seed), folder))


def _left_out(clean: healthy.Log, faulty: Faulty, read: TestLog) -> bool:
    """Whether ingest has flagged every sample that is wrong already, so that no number comes from one."""
    if len(faulty.channels) != 1 or faulty.channels[0] not in clean.values or faulty.channels[0] not in read:
        return False
    name = faulty.channels[0]
    wrong = ~np.isclose(faulty.log.values[name], clean.values[name], rtol=1e-9, equal_nan=True)
    return len(wrong) == len(read[name].flags) and bool(wrong.any() and (read[name].flags[wrong] != 0).all())


def run(healthy_logs: int, each: int, kinds: Sequence[str]) -> Iterator[Case]:
    """All cases, those that are kept first."""
    CACHE.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=CACHE))
    try:
        yield from _kept_or_done(CACHE / "healthy.jsonl", healthy_logs, lambda seed: healthy_case(seed, folder))
        for kind in kinds:
            path = CACHE / f"{kind}.jsonl"
            yield from _kept_or_done(path, each, lambda seed, kind=kind: faulty_case(kind, seed, folder))  # type: ignore[misc]
    finally:
        shutil.rmtree(folder)


def _kept_or_done(path: Path, count: int, case) -> Iterator[Case]:  # type: ignore[no-untyped-def]
    rows = [json.loads(row) for row in path.read_text().splitlines()] if path.exists() else []
    kept = [Case(**{**row, "findings": tuple(row["findings"]), "moved": tuple(row["moved"])}) for row in rows]
    yield from kept[:count]
    seed = kept[-1].seed if kept else 0
    done = len(kept)
    while done < count:
        seed += 1
        made = case(seed)
        if made is not None:
            done += 1
            with path.open("a") as file:
                file.write(json.dumps(asdict(made)) + "\n")
            print(f"{path.stem} {done}/{count}: {made.outcome} {', '.join(made.findings)}", file=sys.stderr, flush=True)
            yield made


def limits(hits: int, number: int) -> str:
    """A share with Wilson's 95 % limits."""
    low, high = wilson(hits, number)
    return f"{hits / number:.3f} ({low:.3f} to {high:.3f})" if number else "-"


def faults_table(cases: list[Case]) -> Iterator[str]:
    """What became of every kind of fault."""
    yield (
        "| kind | logs | named by its kind, or left out already | by a neighbor | otherwise | missed | of these two, "
        "an answer moves | named, so or by a neighbor, or no answer moves |"
    )
    yield "|---|---|---|---|---|---|---|---|"
    for kind in FAULTS:
        yield _row(f"`{kind}`", [c for c in cases if c.kind == kind])
    yield _row("all", [c for c in cases if c.kind])


def _row(name: str, logs: list[Case]) -> str:
    of, number = Counter(c.outcome for c in logs), len(logs)
    wrong = sum(c.outcome in (OTHERWISE, MISSED) and bool(c.moved) for c in logs)
    return (
        f"| {name} | {number} | {limits(of[FOUND] + of[LEFT_OUT], number)} | {of[NEIGHBOR]} | {of[OTHERWISE]} | "
        f"{of[MISSED]} | {wrong} | {limits(number - wrong, number)} |"
    )


def missed_table(cases: list[Case]) -> Iterator[str]:
    """Every fault that was not told by its kind."""
    yield "| kind | seed | size | told as | answers that it moves |"
    yield "|---|---|---|---|---|"
    for c in cases:
        if c.kind and c.outcome in (NEIGHBOR, OTHERWISE, MISSED):
            told, answers_ = ", ".join(dict.fromkeys(c.findings)) or "-", ", ".join(c.moved) or "-"
            yield f"| `{c.kind}` | {c.seed} | {c.size} | {told} | {answers_} |"


def healthy_table(cases: list[Case]) -> Iterator[str]:
    """False findings per healthy log, kind by kind."""
    logs = [c for c in cases if not c.kind]
    of = Counter(name.split()[0] for c in logs for name in dict.fromkeys(f.split()[0] for f in c.findings))
    yield f"| of {len(logs)} healthy logs, with a finding | share |"
    yield "|---|---|"
    for kind in (k for k in KINDS if of[k]):
        yield f"| `{kind}` | {limits(of[kind], len(logs))} |"
    yield f"| of any kind | {limits(sum(bool(c.findings) for c in logs), len(logs))} |"


def main() -> int:
    """Run what is missing and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--healthy", type=int, default=400, help="healthy logs")
    parser.add_argument("--each", type=int, default=50, help="logs with a fault of each kind")
    parser.add_argument("--kinds", default=",".join(FAULTS), help="of fault, with commas")
    parser.add_argument("--write", action="store_true", help="docs/health-rates.md")
    options = parser.parse_args()
    one_thread()
    cases = list(run(options.healthy, options.each, [k for k in options.kinds.split(",") if k]))
    tables = {"healthy": healthy_table, "faults": faults_table, "missed": missed_table}
    for name, table in tables.items():
        print("\n".join(table(cases)), end="\n\n")
        if options.write:
            put(PAGE, name, table(cases))
    return 0


if __name__ == "__main__":
    sys.exit(main())
