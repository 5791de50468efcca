"""How often a fault is found and how often a healthy log is blamed: docs/health-rates.md. Goes on where stopped.

python -m benchmarks.health_rates [--healthy 400] [--each 50] [--write]
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from benchmarks.recovery import wilson
from benchmarks.studies import one_thread, put
from simulated.faults import healthy
from simulated.faults.kinds import FAULTS, Faulty, suits

from hfanalysis.health.judge import judge
from hfanalysis.products.health import KINDS, Finding, Health
from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log

ROOT = Path(__file__).resolve().parent.parent
PAGE, CACHE = ROOT / "docs" / "health-rates.md", ROOT / ".cache" / "health-rates"
FAULTY_SEEDS = 10_000
"""Where the seeds of logs with a fault begin, so that none is one of the healthy ones."""
FOUND, LEFT_OUT, OTHERWISE, MISSED = "found", "left out", "otherwise", "missed"


@dataclass(frozen=True)
class Case:
    """One log: the fault's kind ("" of a healthy one), its seed, what became of it, and what was found elsewhere."""

    kind: str
    seed: int
    size: str
    outcome: str
    findings: tuple[str, ...]


def judged(log: healthy.Log, folder: Path) -> tuple[TestLog, Health]:
    """The log as ingested, and its health."""
    healthy.write(folder / "T", log)
    definition = load_definition(folder / "T" / "test.toml")
    ingest(definition, folder / "ingest.h5")
    read = read_log(folder / "ingest.h5")
    return read, judge(read, definition)


def findings(health: Health) -> list[Finding]:
    """Each once."""
    found: list[Finding] = []
    for channel in health.channels.values():
        found += [f for f in channel.findings if f not in found]
    return found


def healthy_case(seed: int, folder: Path) -> Case:
    """A healthy log: whatever is found is wrong."""
    found = findings(judged(healthy.draw(seed), folder)[1])
    return Case("", seed, "", "blamed" if found else "healthy", _names(found))


def _names(found: list[Finding]) -> tuple[str, ...]:
    return tuple(f"{f.kind} {'/'.join(f.channels)}" for f in found)


def faulty_case(kind: str, seed: int, folder: Path) -> Case | None:
    """A log with a fault; None where it could not be told from that log by anybody."""
    clean = healthy.draw(FAULTY_SEEDS + seed)
    if not suits(clean, kind):
        return None
    faulty = FAULTS[kind](np.random.default_rng([7, seed]), clean)
    read, health = judged(faulty.log, folder)
    found = findings(health)
    own = [f for f in found if set(f.channels) & set(faulty.channels)]
    outcome = OTHERWISE if own else MISSED
    if any(f.kind == kind for f in own):
        outcome = FOUND
    elif _left_out(clean, faulty, read):
        outcome = LEFT_OUT
    return Case(kind, seed, faulty.size, outcome, _names(found))


def _left_out(clean: healthy.Log, faulty: Faulty, read: TestLog) -> bool:
    """Whether ingest has flagged every sample that is wrong already, so that no number comes from one."""
    if len(faulty.channels) != 1 or faulty.channels[0] not in clean.values or faulty.channels[0] not in read:
        return False
    name = faulty.channels[0]
    wrong = ~np.isclose(faulty.log.values[name], clean.values[name], rtol=1e-9, equal_nan=True)
    return len(wrong) == len(read[name].flags) and bool((read[name].flags[wrong] != 0).all())


def run(healthy_logs: int, each: int) -> Iterator[Case]:
    """All cases, those that are kept first."""
    CACHE.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=CACHE))
    try:
        yield from _kept_or_done(CACHE / "healthy.jsonl", healthy_logs, lambda seed: healthy_case(seed, folder))
        for kind in FAULTS:
            path = CACHE / f"{kind}.jsonl"
            yield from _kept_or_done(path, each, lambda seed, kind=kind: faulty_case(kind, seed, folder))  # type: ignore[misc]
    finally:
        shutil.rmtree(folder)


def _kept_or_done(path: Path, count: int, case) -> Iterator[Case]:  # type: ignore[no-untyped-def]
    rows = [json.loads(row) for row in path.read_text().splitlines()] if path.exists() else []
    kept = [Case(**{**row, "findings": tuple(row["findings"])}) for row in rows]
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
    yield "| kind | logs | named by its kind, or left out already | channel named at all | missed |"
    yield "|---|---|---|---|---|"
    for kind in FAULTS:
        of = Counter(c.outcome for c in cases if c.kind == kind)
        number = sum(of.values())
        good = of[FOUND] + of[LEFT_OUT]
        yield f"| `{kind}` | {number} | {limits(good, number)} | {limits(number - of[MISSED], number)} | {of[MISSED]} |"


def missed_table(cases: list[Case]) -> Iterator[str]:
    """Every fault that was not told by its kind."""
    yield "| kind | seed | size | told as |"
    yield "|---|---|---|---|"
    for c in cases:
        if c.kind and c.outcome in (OTHERWISE, MISSED):
            yield f"| `{c.kind}` | {c.seed} | {c.size} | {', '.join(dict.fromkeys(c.findings)) or '-'} |"


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
    parser.add_argument("--write", action="store_true", help="docs/health-rates.md")
    options = parser.parse_args()
    one_thread()
    cases = list(run(options.healthy, options.each))
    tables = {"healthy": healthy_table, "faults": faults_table, "missed": missed_table}
    for name, table in tables.items():
        print("\n".join(table(cases)), end="\n\n")
        if options.write:
            put(PAGE, name, table(cases))
    return 0


if __name__ == "__main__":
    sys.exit(main())
