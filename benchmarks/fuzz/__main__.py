"""python -m benchmarks.fuzz run [--n 10000] [--jobs 2] [--seed 1] | table [--write PAGE] | show NUMBER FOLDER

Cases that have been run are kept in ``--out`` (.cache/fuzz), from where a later run goes on.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.studies import one_thread

one_thread()

from benchmarks.fuzz import cases, formats, page  # noqa: E402
from benchmarks.fuzz.judge import Judged, judge  # noqa: E402
from benchmarks.fuzz.table import STANDS  # noqa: E402

DEFECTS = ("traceback", "hang", "killed")


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
        page.write(options.write, pairs, options.seed)
    return int(any(judged.end in DEFECTS for _, judged in pairs))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("do", choices=("run", "table", "show", "work"))
    parser.add_argument("number", type=int, nargs="?", default=0, help="case to show, or first one of a worker")
    parser.add_argument("folder", type=Path, nargs="?", default=Path("fuzz-case"))
    parser.add_argument("--n", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(".cache/fuzz"))
    parser.add_argument("--write", type=Path, help="the page to write the tables into")
    return parser.parse_args()


def _run(options: argparse.Namespace) -> None:
    """Workers that share the numbers out among themselves, each with a file of its own."""
    command = [sys.executable, "-m", "benchmarks.fuzz", "work"]
    shared = [word for name in ("n", "jobs", "seed", "out") for word in (f"--{name}", str(getattr(options, name)))]
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

    warm()
    done = {row["number"] for row in _rows(options)}
    bases = [(f"{stand}.{format}", cases.unspoilt(stand, format)) for stand in STANDS for format in formats.NAMES]
    own = [(i, name, case) for i, (name, case) in enumerate(bases, 1) if i % options.jobs == options.number]
    with (options.out / f"{options.seed}-{options.number}-of-{options.jobs}.jsonl").open("a") as file:

        def keep(row: dict[str, Any]) -> None:
            file.write(json.dumps(row) + "\n")
            file.flush()

        for i, name, case in own:
            if -i not in done:
                keep({"number": -i, "base": name, **attempt(case)})
        for number in range(options.number, options.n, options.jobs):
            if number not in done:
                case = cases.build(number, options.seed)
                about = {"stand": case.stand, "format": case.format, "mutators": case.mutators, "hit": sorted(case.hit)}
                keep({"number": number, **about, **attempt(case)})


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
    rows = {row["number"]: row for row in _rows(options)}
    bases = {row["base"]: row for row in rows.values() if "base" in row}
    mutated = [rows[number] for number in sorted(rows) if 0 <= number < options.n]
    return [(row, judge(row, bases[f"{row['stand']}.{row['format']}"])) for row in mutated]


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.exit(main())
