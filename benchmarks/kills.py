"""`make all` killed at random instants, and run twice at once: the rerun's products are those of a run left in peace.

python -m benchmarks.kills [--n 200] [--seed 1] [--write docs/fuzz.md]

What has been done is kept in ``--out`` (.cache/kills), from where a later run goes on.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any, TextIO

from benchmarks.fuzz import document, formats
from benchmarks.fuzz.table import STANDS, base_log
from benchmarks.studies import put

REPOSITORY = Path(__file__).resolve().parents[1]
VENV = Path(sys.prefix)
TWICE, INTERRUPTED, HALF_DONE = 0.1, 0.2, 0.3
"""Shares of the runs that are two at once, that are interrupted, and that begin from some of the products."""
KEPT_APART = ("run.log", "hashes.json", ".lock")
"""What no product is: a log, hashes by the clock, and the lock."""
OF_ALL = "index.html"
"""The page that lists what is there: of fewer tests it is another one, and whole where it ends as it should."""


def main() -> int:
    """Returns 1 where anything came out otherwise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(".cache/kills"))
    parser.add_argument("--write", type=Path, help="the page to write the result into")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / f"{options.seed}.jsonl"
    if len(rows_of(kept)) < options.n:
        with tempfile.TemporaryDirectory(prefix="kills-") as folder, kept.open("a") as file:
            study(Path(folder), options.n, options.seed, kept, file)
    said, wrong = result(rows_of(kept)[: options.n])
    print("\n".join([said, *wrong]))
    if options.write:
        put(options.write, "kills", [said, *(f"- {line}" for line in wrong)])
    return int(bool(wrong))


def rows_of(kept: Path) -> list[dict[str, Any]]:
    """What has been done so far."""
    lines = kept.read_text().splitlines() if kept.exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]  # not what a killed study left unfinished


def study(folder: Path, n: int, seed: int, kept: Path, file: TextIO) -> None:
    """Disturb what has not been disturbed, each by a generator of its own number."""
    checkout(folder)
    make(folder).wait()  # compiles what is not
    shutil.rmtree(folder / "processed")
    raw, start = contents(folder / "raw_tests"), time.monotonic()
    if make(folder).wait() != 0:
        raise SystemExit("make all failed without being disturbed")
    lasting, whole = time.monotonic() - start, contents(folder / "processed")
    for i in range(len(rows_of(kept)), n):
        kind = disturbed(folder, random.Random(f"{seed} {i}"), lasting)
        row = {"kind": kind, "faults": faults(folder, whole, raw), "files": len(whole), "lasting": round(lasting)}
        file.write(json.dumps(row) + "\n")
        file.flush()


def result(rows: list[dict[str, Any]]) -> tuple[str, list[str]]:
    """What was done, and all that came out otherwise."""
    wrong = [f"{i}, {row['kind']}: {fault}" for i, row in enumerate(rows) for fault in row["faults"]]
    done = Counter(row["kind"] for row in rows)
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(done.items()))
    each = f"{rows[-1]['files']} files of {len(STANDS)} tests" if rows else "none"
    return f"{len(rows)} disturbed runs of `make all` ({kinds}), {each}: {len(wrong)} faults.", wrong


def checkout(folder: Path) -> None:
    """What make works on: rules, source and two small tests."""
    for name in ("Makefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(REPOSITORY / name, folder)
    shutil.copytree(REPOSITORY / "pipeline", folder / "pipeline")
    (folder / "src").symlink_to(REPOSITORY / "src")
    for stand in STANDS:
        content = document.base(stand, "csv")
        content["test"]["id"] = stand
        (folder / "raw_tests" / stand).mkdir(parents=True)
        (folder / "raw_tests" / stand / "test.toml").write_text(document.text(content))
        (folder / "raw_tests" / stand / "log.csv").write_bytes(formats.WRITERS["csv"][1](base_log(stand)))


def make(folder: Path) -> subprocess.Popen[bytes]:
    """`make all` there, in a group of processes of its own."""
    command = ["make", "--no-print-directory", f"VENV={VENV}", "-o", f"{VENV}/.set-up", "all"]
    quiet = subprocess.DEVNULL
    return subprocess.Popen(command, cwd=folder, stdout=quiet, stderr=quiet, start_new_session=True)


def disturbed(folder: Path, rng: random.Random, lasting: float) -> str:
    """One run that does not go its way; returns what was done to it."""
    if rng.random() < HALF_DONE:
        pages = list((folder / "processed").glob("*/report.html"))  # by these make tells whether it has to ask
        for path in {*rng.sample(sorted((folder / "processed").glob("*/[!.]*.*")), 3), *pages}:
            path.unlink()
    else:
        shutil.rmtree(folder / "processed", ignore_errors=True)
    if rng.random() < TWICE:
        ended = [run.wait() for run in (make(folder), make(folder))]
        return "two at once" if ended == [0, 0] else f"two at once that ended with {ended}"
    stop = signal.SIGINT if rng.random() < INTERRUPTED else signal.SIGKILL
    run = make(folder)
    time.sleep(rng.uniform(0.0, 1.1 * lasting))
    try:
        os.killpg(run.pid, stop)
    except ProcessLookupError:
        return "ended before"
    run.wait()
    return "killed" if stop == signal.SIGKILL else "interrupted"


def faults(folder: Path, whole: dict[str, bytes], raw: dict[str, bytes]) -> list[str]:
    """What is wrong after the disturbance, and after the rerun."""
    left = contents(folder / "processed")
    found = [f"{name} was left half made" for name, content in left.items() if not _made(name, content, whole)]
    if make(folder).wait() != 0:
        found.append("the rerun failed")
    now = contents(folder / "processed")
    found += [f"{name} differs after the rerun" for name in whole if now.get(name) != whole[name]]
    found += [f"{name} is left over" for name in now if name not in whole]
    found += ["a raw file changed"] if contents(folder / "raw_tests") != raw else []
    return found


def _made(name: str, content: bytes, whole: dict[str, bytes]) -> bool:
    """Whether a file that a disturbed run left is as it should be; one that is left over is told after the rerun."""
    if name == OF_ALL:
        return content.rstrip().endswith(b"</html>")
    return name not in whole or content == whole[name]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder but what is kept apart."""
    paths = [path for path in folder.rglob("*") if path.is_file() and path.name not in KEPT_APART]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


if __name__ == "__main__":
    sys.exit(main())
