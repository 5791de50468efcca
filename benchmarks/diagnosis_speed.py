"""The time that a diagnosis takes, beside an earlier revision of this repository: pairs in turn, one thread each.

python -m benchmarks.diagnosis_speed [--revision 26fccde] [--repeat 3] [--cases DIR [--only P04,P05]]

The earlier revision is checked out in a temporary folder, with compiled code of its own, and has the libraries that its
lock names, in .cache/earlier/REVISION; both are run once before anything is timed, on the replica as that revision had
it. CASES holds ``raw_tests/`` with tests of which the median
ratio is told; without it HF5 alone is timed. Only the stage itself counts, by the run's own log.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EARLIER = "26fccde"
"""The revision that docs/blind-benchmark.md was made by."""

REPLICA, MOST, MOST_OF_CASES = "HF5", 0.45, 0.7
"""What was promised: HF5's diagnosis in at most this part of the earlier time, and the median of cases."""


@dataclass(frozen=True)
class Checkout:
    """A version of the package, a folder for its products and its compiled code, and a Python with its libraries."""

    source: Path
    work: Path
    python: str

    def seconds(self, root: Path, test: str) -> float:
        """Wall time [s] of the stage."""
        out = self.work / "out"
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        compiled = {"NUMBA_CACHE_DIR": str(self.work / "compiled"), "PYTHONPATH": str(self.source / "src")}
        command = [self.python, "-m", "hfanalysis", "diagnose", test, "--root", str(root), "--out", str(out)]
        ended = subprocess.run(
            [*command, "--force", "--quiet"], env=os.environ | threads | compiled, cwd=self.work, text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )  # fmt: skip
        if ended.returncode:
            raise SystemExit(f"diagnosis_speed: {self.source} ended with {ended.returncode}:\n{ended.stderr[-800:]}")
        lines = (out / test / "run.log").read_text(encoding="utf-8").splitlines()
        stages = [row for row in map(json.loads, lines) if row.get("stage") == "diagnose"]
        return float(stages[-1]["seconds"])


@contextmanager
def checked_out(revision: str, folder: Path) -> Iterator[Path]:
    """A revision of this repository in a folder, for as long as it is needed."""
    git = ["git", "-C", str(ROOT), "worktree"]
    subprocess.run([*git, "add", "--detach", str(folder), revision], check=True, capture_output=True)
    try:
        yield folder
    finally:
        subprocess.run([*git, "remove", "--force", str(folder)], check=True, capture_output=True)


def python_of(revision: str, source: Path) -> str | None:
    """A Python with what the lock of a checked-out revision names; None where that cannot be had."""
    place = ROOT / ".cache" / "earlier" / revision
    script, lock = ROOT / "pipeline" / "setup.sh", source / "requirements.lock"
    made = subprocess.run(["sh", str(script), sys.executable, str(place), str(lock)])
    return str(place / "bin" / "python") if made.returncode == 0 else None


def ratio(now: Checkout, earlier: Checkout, root: Path, test: str, repeat: int) -> float:
    """Time of a diagnosis over that of the earlier revision [-]: the median of pairs in turn."""
    pairs = [(now.seconds(root, test), earlier.seconds(root, test)) for _ in range(repeat)]
    one, other = (statistics.median(side) for side in zip(*pairs, strict=True))
    found = statistics.median(a / b for a, b in pairs)
    print(f"  {test:<10} {one:7.1f} s, earlier {other:7.1f} s: {found:.2f}", flush=True)
    return found


def verdict(found: float, most: float) -> str:
    """Whether a ratio is within what was promised."""
    return f"{found:.2f}, {'within' if found <= most else 'NOT within'} {most:g}"


def main(given: Sequence[str] | None = None) -> int:
    """Time all, and say the ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--revision", default=EARLIER)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--cases", type=Path, metavar="DIR")
    parser.add_argument("--only", default="", help="of the cases, with commas")
    asked = parser.parse_args(given)
    known = subprocess.run(
        ["git", "-C", str(ROOT), "cat-file", "-e", f"{asked.revision}^{{commit}}"], capture_output=True
    )
    if known.returncode:
        print(f"diagnosis_speed: this clone has no revision {asked.revision}: nothing to compare with", file=sys.stderr)
        return 0
    with tempfile.TemporaryDirectory() as scratch, checked_out(asked.revision, Path(scratch) / "source") as source:
        python = python_of(asked.revision, source)
        if python is None:
            print(f"diagnosis_speed: the libraries of {asked.revision} cannot be installed here", file=sys.stderr)
            return 0
        now = Checkout(ROOT, Path(scratch) / "now", sys.executable)
        earlier = Checkout(source, Path(scratch) / "earlier", python)
        for one in (now, earlier):
            one.work.mkdir()
            one.seconds(source, REPLICA)
        print(f"wall time of diagnose, medians of {asked.repeat} pairs with {asked.revision}, one thread")
        print(f"{REPLICA}: {verdict(ratio(now, earlier, source, REPLICA, asked.repeat), MOST)}")
        if asked.cases:
            root = asked.cases.resolve()
            names = asked.only.split(",") if asked.only else sorted(p.name for p in (root / "raw_tests").iterdir())
            found = [ratio(now, earlier, root, name, 1) for name in names]
            print(f"median of {len(found)} cases: {verdict(statistics.median(found), MOST_OF_CASES)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
