"""python -m benchmarks.fuzz run [--n 10000] [--jobs 2] [--seed 1] [--again] | table [--write PAGE] | show NUMBER FOLDER

Cases that have been run are kept in ``--out`` (.cache/fuzz), each with the digest of the code that ran it; a later run
goes on from there. ``--again`` runs those of another code anew: what came out wrong first, the
others once all have been run.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.studies import one_thread

one_thread()

from benchmarks.fuzz import cases, page  # noqa: E402
from benchmarks.fuzz.judge import Judged, judge  # noqa: E402

DEFECTS = ("traceback", "hang", "killed")
ROOT = Path(__file__).resolve().parents[2]
OF_CASES = ("cases", "document", "formats", "mutators", "table")
"""What makes the cases: with another of these a number is another case."""


def main() -> int:
    """Returns 1 where a case ended in a defect of ours."""
    options = _options()
    if options.do == "show":
        print(cases.put(cases.build(options.number, options.seed), options.folder))
        return 0
    if options.do == "work":
        _work(options)
        return 0
    if options.do == "run":
        options.out.mkdir(parents=True, exist_ok=True)
        _run(options)
    pairs = _judged(options)
    print(page.summary(pairs))
    if options.write:
        page.write(options.write, pairs, options.seed, code())
    return int(any(judged.end in DEFECTS for _, judged in pairs))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("do", choices=("run", "table", "show", "work"))
    parser.add_argument("number", type=int, nargs="?", default=0, help="case to show, or first one of a worker")
    parser.add_argument("folder", type=Path, nargs="?", default=Path("fuzz-case"))
    parser.add_argument("--n", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="run anew what other code ran")
    parser.add_argument("--out", type=Path, default=Path(".cache/fuzz"))
    parser.add_argument("--write", type=Path, help="the page to write the tables into")
    return parser.parse_args()


def _run(options: argparse.Namespace) -> None:
    """Workers that share the numbers out among themselves, each with a file of its own."""
    command = [sys.executable, "-m", "benchmarks.fuzz", "work"]
    shared = [word for name in ("n", "jobs", "seed", "out") for word in (f"--{name}", str(getattr(options, name)))]
    shared += ["--again"] if options.again else []
    running = [subprocess.Popen([*command, str(number), *shared]) for number in range(options.jobs)]
    try:
        for process in running:
            process.wait()
    except KeyboardInterrupt:
        for process in running:
            process.terminate()
        raise


def _work(options: argparse.Namespace) -> None:
    """Every ``--jobs``-th case from ``number`` on that has not been run."""
    from benchmarks.fuzz.attempt import attempt

    mine = code()
    warm()
    have = {row["base"] for row in _rows(options) if row.get("code") == mine and "base" in row}
    with (options.out / f"{options.seed}-{options.number}-of-{options.jobs}.jsonl").open("a") as file:

        def keep(row: dict[str, Any]) -> None:
            file.write(json.dumps({**row, "code": mine}) + "\n")
            file.flush()

        for number in _to_run(options, mine):
            case = cases.build(number, options.seed)
            base = f"{case.stand}.{case.format}"
            if base not in have:
                have.add(base)
                keep({"number": -1, "base": base, **attempt(cases.unspoilt(case.stand, case.format))})
            about = {"stand": case.stand, "format": case.format, "mutators": case.mutators, "hit": sorted(case.hit)}
            keep({"number": number, **about, **attempt(case)})


def _to_run(options: argparse.Namespace, mine: str) -> list[int]:
    """Numbers of this worker: those never run; with ``--again`` what came out wrong by other code before, and the rest
    of it after."""
    last = {row["number"]: row for row in _rows(options)}
    numbers = range(options.number, options.n, options.jobs)
    never = [number for number in numbers if number not in last]
    if not options.again:
        return never
    wrong = {row["number"] for row, judged in _judged(options) if judged.silent or judged.end in DEFECTS}
    old = [number for number in numbers if number in last and last[number].get("code") != mine]
    return [*(n for n in old if n in wrong), *never, *(n for n in old if n not in wrong)]


def code() -> str:
    """Digest of what runs a case and of what makes it."""
    own = [ROOT / "benchmarks" / "fuzz" / f"{name}.py" for name in OF_CASES]
    digest = hashlib.sha256()
    for path in [*sorted((ROOT / "src").rglob("*.py")), *own]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def warm() -> None:
    """What every case needs, once: imports and compiled code, by a case in this process."""
    import tempfile

    from benchmarks.fuzz.attempt import _run as run

    with tempfile.TemporaryDirectory() as folder:
        run(cases.put(cases.unspoilt("HF5", "csv"), Path(folder)))


def _rows(options: argparse.Namespace) -> list[dict[str, Any]]:
    """Everything that has been run with this seed; a line that a killed worker left unfinished does not count."""
    found = []
    for path in sorted(options.out.glob(f"{options.seed}-*.jsonl")):
        for line in path.read_text().splitlines():
            try:
                found.append(json.loads(line))
            except ValueError:
                continue
    return found


def _judged(options: argparse.Namespace) -> list[tuple[dict[str, Any], Judged]]:
    """The last outcome of each case, beside the unspoilt test as the same code had it."""
    rows = _rows(options)
    bases = {(row["base"], row.get("code")): row for row in rows if "base" in row}
    last = {row["number"]: row for row in rows}
    mutated = [last[number] for number in sorted(last) if 0 <= number < options.n]
    beside = [(row, bases.get((f"{row['stand']}.{row['format']}", row.get("code")))) for row in mutated]
    return [(row, judge(row, base)) for row, base in beside if base is not None]


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.exit(main())
