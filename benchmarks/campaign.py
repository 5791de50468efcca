"""A campaign on two local workers beside two processes that share the tests: throughput, memory, and workers killed.

python -m benchmarks.campaign [--tests 500] [--kills 20] [--write docs/campaign.md] (`make campaign-study`)

The tests are generated (HF5 at 20 Hz, each with noise of its own) and go from the log to the page, without diagnosis:
once in two processes, each pinned to a processor and with every other test; once by a campaign on two workers; once by
a campaign whose workers are killed at random instants. What the three make is compared byte by byte.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import psutil
from benchmarks.archive import generate
from benchmarks.studies import one_thread, put

WORKERS = 2
OF_THE_RUN = ("run.log", "hashes.json", ".lock")
"""Files of a test that tell of a run and not of the test: times, and what was hashed when."""


def pinned(root: Path, out: Path, tests: list[str]) -> float:
    """Seconds that two processes take for the tests, each pinned to a processor."""
    begun = time.perf_counter()
    code = (
        "import os, sys; from pathlib import Path; from hfanalysis.campaign.side_by_side import Work, run_one\n"
        "os.sched_setaffinity(0, {int(sys.argv[1])})\n"
        "work = Work(Path(sys.argv[2]), Path(sys.argv[3]), to='report')\n"
        "for test in sys.argv[4:]: assert not run_one(test, work).defect"
    )
    processors = sorted(os.sched_getaffinity(0))[:WORKERS]
    running = [
        subprocess.Popen([sys.executable, "-c", code, str(cpu), str(root), str(out), *tests[i::WORKERS]])
        for i, cpu in enumerate(processors)
    ]
    if any(process.wait() for process in running):
        raise SystemExit("a pinned process failed")
    return time.perf_counter() - begun


def by_campaign(
    root: Path, out: Path, tests: list[str], beside: Callable[[threading.Event], None]
) -> tuple[float, list[str]]:
    """Seconds that a campaign takes for them, and the tests that did not go well; ``beside`` runs in a thread."""
    from hfanalysis.campaign.cluster import Cluster
    from hfanalysis.campaign.side_by_side import Work, run_all

    over, done = threading.Event(), list[str]()
    watching = threading.Thread(target=beside, args=(over,))
    begun = time.perf_counter()
    with Cluster(WORKERS) as cluster:
        watching.start()
        found = run_all(tests, Work(root, out, to="report"), cluster, lambda test, _how: _told(done, test, len(tests)))
        over.set()
        watching.join()
    return time.perf_counter() - begun, [test for test, how in found.items() if how.status]


def _told(done: list[str], test: str, of: int) -> None:
    done.append(test)
    print(f"\r{len(done)} of {of} tests", end="", file=sys.stderr)


def workers() -> list[psutil.Process]:
    """The processes that run tests: children of those that watch over them."""
    out = []
    for process in psutil.Process().children(recursive=True):
        with suppress(psutil.Error):
            if "spawn_main" in " ".join(process.cmdline()):
                out.append(process)
    return out


def measuring(sizes: list[float]) -> Callable[[threading.Event], None]:
    """Takes the memory of all workers [MB] every second."""

    def measure(over: threading.Event) -> None:
        while not over.wait(1.0):
            with suppress(psutil.Error):
                sizes.append(sum(process.memory_info().rss for process in workers()) / 1e6)

    return measure


def killing(count: int, every: float, killed: list[int]) -> Callable[[threading.Event], None]:
    """Kills so many workers, one ``every`` so many seconds on average."""
    rng = random.Random(57)

    def kill(over: threading.Event) -> None:
        while len(killed) < count and not over.wait(rng.expovariate(1.0 / every)):
            if found := workers():
                one = rng.choice(found)
                with suppress(psutil.Error):
                    one.kill()
                    killed.append(one.pid)

    return kill


def products(folder: Path) -> dict[str, bytes]:
    """What was made, by name, without what is of the run."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name not in OF_THE_RUN)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def main() -> int:
    """All three, and what they have made."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=500)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    names = [f"G{i:04d}" for i in range(asked.tests)]
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch)
        for seed, name in enumerate(names):
            generate(root, name, seed)
        pinned(root, root / "warm", names[:WORKERS])  # compiled, and tables made, once
        alone = pinned(root, root / "alone", names)
        sizes, killed = list[float](), list[int]()
        together, failed = by_campaign(root, root / "together", names, measuring(sizes))
        disturbed, lost = by_campaign(
            root, root / "killed", names, killing(asked.kills, together / asked.kills, killed)
        )
        made = {name: products(root / name) for name in ("alone", "together", "killed")}
    same = [name for name in ("together", "killed") if made[name] == made["alone"]]
    tenth = max(len(sizes) // 10, 1)
    early, late = (sum(part) / len(part) for part in (sizes[2 * tenth : 3 * tenth], sizes[-tenth:]))
    rows = [
        ("two pinned processes", alone, asked.tests, ""),
        ("a campaign on two workers", together, asked.tests - len(failed), _same("together", same)),
        (f"the same, {len(killed)} workers killed", disturbed, asked.tests - len(lost), _same("killed", same)),
    ]
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    lines = [
        "| | seconds | tests that ended well | files beside those of two pinned processes |",
        "|---|---|---|---|",
        *(f"| {what} | {seconds:.0f} | {well} | {other} |" for what, seconds, well, other in rows),
        "",
        f"Throughput {alone / together:.2f} of that of two pinned processes, {together / asked.tests:.2f} s a test.",
        f"Memory of both workers {early:.0f} MB in the third tenth of the time, {late:.0f} MB in the last one; of the",
        f"process that spreads the work {own:.0f} MB at its peak.",
    ]
    print("\n".join(["", *lines]))
    if asked.write:
        put(asked.write, "campaign", lines)
    return 0


def _same(name: str, same: list[str]) -> str:
    return "the same" if name in same else "**other**"


if __name__ == "__main__":
    sys.exit(main())
