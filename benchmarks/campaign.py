"""A campaign on two local workers beside two processes that share the tests: throughput, memory, and what dies in it.

python -m benchmarks.campaign [--tests 500] [--kills 20] [--write docs/campaign.md] (`make campaign-study`)

The tests are generated (HF5 at 20 Hz, each with noise of its own) and go from the log to the page, without diagnosis:
once in two processes, each pinned to a processor and with every other test; once by a campaign on two workers; once by
a campaign whose workers are killed at random instants, in which one more test ends each process that runs it, and which
is killed itself with its scheduler when half of the tests are done, and started again. What the three make is compared
byte by byte. What is done of a run that was stopped is kept below `.cache/campaign`, for these sources.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import resource
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from heapq import heapify, heapreplace
from pathlib import Path
from typing import Any

import psutil
from benchmarks.archive import generate
from benchmarks.studies import one_thread, put

ROOT = Path(__file__).resolve().parent.parent
WORKERS = 2
OF_THE_RUN = ("run.log", "hashes.json", ".lock")
"""Files of a test that tell of a run and not of the test: times, and what was hashed when."""

DEADLY = "deadly"
"""The test that ends each process in which it is run."""

EMPTY = 2000
"""Tasks that do nothing, by which the cost of spreading one is taken."""

STARTING = 8.0
"""Seconds that workers are left to begin in [s]: one killed sooner ends the start of a campaign, and hfa says so."""

LINK = 125e6
"""Of a laboratory's network [bytes/s]: 1 Gbit/s."""

Part = dict[str, Any]


def timed(name: str, work: Any) -> tuple[int, float]:
    """A worker's run of one test: its exit status and its duration [s]."""
    from hfanalysis.campaign.side_by_side import run_one

    if name == DEADLY:
        os._exit(1)
    begun = time.perf_counter()
    return run_one(name, work).status, time.perf_counter() - begun


def nothing(_name: str, _work: Any) -> None:
    """A worker's task that is over at once."""


def pinned(root: Path, out: Path, tests: list[str]) -> float:
    """Seconds that two processes take for the tests, each pinned to a processor."""
    begun = time.perf_counter()
    code = (
        "import os, sys; from pathlib import Path; from hfanalysis.campaign.side_by_side import Work, run_one\n"
        "os.sched_setaffinity(0, {int(sys.argv[1])})\n"
        "work = Work(Path(sys.argv[2]), Path(sys.argv[3]), to='report')\n"
        "for test in sys.argv[4:]: assert not run_one(test, work).status"
    )
    processors = sorted(os.sched_getaffinity(0))[:WORKERS]
    running = [
        subprocess.Popen([sys.executable, "-c", code, str(cpu), str(root), str(out), *tests[i::WORKERS]])
        for i, cpu in enumerate(processors)
    ]
    if any(process.wait() for process in running):
        raise SystemExit("a pinned process failed")
    return time.perf_counter() - begun


def by_campaign(root: Path, out: Path, tests: list[str], beside: Callable[[threading.Event], None]) -> Part:
    """A campaign over them on local workers: seconds in all and of each test, those that did not go well with what was
    said of them, and the seconds of an empty task; ``beside`` runs in a thread."""
    import cloudpickle

    from hfanalysis.campaign.cluster import Cluster
    from hfanalysis.campaign.side_by_side import Work

    cloudpickle.register_pickle_by_value(sys.modules[timed.__module__])
    over, took, failed = threading.Event(), dict[str, float](), dict[str, str]()
    watching = threading.Thread(target=beside, args=(over,))
    begun = time.perf_counter()
    with Cluster(WORKERS) as cluster:
        started = time.perf_counter()
        watching.start()
        for test, ended in cluster.each(timed, tests, Work(root, out, to="report")):
            if isinstance(ended, str) or ended[0]:
                failed[test] = ended if isinstance(ended, str) else f"status {ended[0]}"
            else:
                took[test] = ended[1]
            print(f"\r{out.name}: {len(took) + len(failed)} of {len(tests)} tests", end="", file=sys.stderr)
        over.set()
        watching.join()
        done = time.perf_counter()
        for _ in cluster.each(nothing, [str(i) for i in range(EMPTY)], Work(root)):
            pass
        empty = (time.perf_counter() - done) / EMPTY
    return {
        "seconds": done - begun, "start": started - begun, "took": took, "failed": failed, "empty": empty,
        "own": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
    }  # fmt: skip


def workers(of: psutil.Process) -> list[psutil.Process]:
    """The processes that run tests: children of those that watch over them."""
    out = []
    with suppress(psutil.Error):
        for process in of.children(recursive=True):
            with suppress(psutil.Error):
                if "spawn_main" in " ".join(process.cmdline()):
                    out.append(process)
    return out


def measuring(sizes: list[float]) -> Callable[[threading.Event], None]:
    """Takes the memory of all workers [MB] every second."""

    def measure(over: threading.Event) -> None:
        while not over.wait(1.0):
            with suppress(psutil.Error):
                sizes.append(sum(process.memory_info().rss for process in workers(psutil.Process())) / 1e6)

    return measure


def undisturbed(root: Path, out: Path, tests: list[str]) -> Part:
    """A campaign that nobody disturbs, with the memory of its workers over time [MB]."""
    sizes = list[float]()
    return {**by_campaign(root, out, tests, measuring(sizes)), "sizes": sizes}


def disturbed(root: Path, out: Path, tests: list[str], kills: int, every: float) -> Part:
    """A campaign in a process of its own, of which ``kills`` workers are killed, one ``every`` so many seconds on
    average, and the process itself when half of the tests are done; it is started again then."""
    rng, killed, ended = random.Random(57), 0, list[int]()
    result = out.with_suffix(".json")
    begun = time.perf_counter()
    while not result.exists():
        process = psutil.Popen(
            [sys.executable, "-m", "benchmarks.campaign", "--part", str(result), "--root", str(root), *tests],
            start_new_session=True, cwd=ROOT,
        )  # fmt: skip
        following = time.perf_counter() + STARTING + rng.expovariate(1.0 / every)
        while process.poll() is None:
            time.sleep(0.2)
            if killed < kills and time.perf_counter() > following and (found := workers(process)):
                with suppress(psutil.Error):
                    rng.choice(found).kill()
                    killed += 1
                following = time.perf_counter() + rng.expovariate(1.0 / every)
            done = len(list(out.glob("*/report.html")))
            if not ended and done >= len(tests) // 2:
                others = process.children(recursive=True)
                process.kill()
                ended.append(done)
                psutil.wait_procs([process, *others], timeout=60.0)
        if not ended and process.returncode:
            raise SystemExit("the disturbed campaign failed")
    return {**json.loads(result.read_text()), "seconds": time.perf_counter() - begun, "kills": killed, "ended": ended}


def products(folder: Path, tests: Sequence[str]) -> str:
    """A hash of what was made of the tests, without what is of the run."""
    found = hashlib.sha256()
    for test in tests:
        for path in sorted((folder / test).rglob("*")):
            if path.is_file() and path.name not in OF_THE_RUN:
                found.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()


def size(folder: Path) -> int:
    """Bytes of the files below a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def estimate(took: Sequence[float], tests: int, count: int, each: float, sent: float, given: float) -> float:
    """Seconds that ``count`` workers would take for so many tests, each as long as one of those that were measured.

    The scheduler takes ``each`` seconds for every test, one after the other; all are behind one network link of it
    (:data:`LINK`), by which every worker is sent ``sent`` bytes before it begins, and gives back ``given`` of a test.
    """
    rng = random.Random(57)
    free = [(i + 1) * sent / LINK for i in range(count)]
    heapify(free)
    handed = link = last = 0.0
    for _ in range(tests):
        handed = max(handed + each, free[0])
        over = handed + rng.choice(took)
        heapreplace(free, over)
        link = max(link, over) + given / LINK if given else max(link, over)
        last = max(last, link)
    return last


def main() -> int:
    """All three, and what they have made."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=500)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--part", type=Path, help="of the disturbed campaign: its result")
    parser.add_argument("--root", type=Path)
    parser.add_argument("names", nargs="*")
    asked = parser.parse_args()
    one_thread()
    if asked.part:
        found = by_campaign(asked.root, asked.part.with_suffix(""), asked.names, lambda _over: None)
        asked.part.write_text(json.dumps(found))
        return 0
    from hfanalysis.campaign.cluster import version

    kept = ROOT / ".cache" / "campaign" / hashlib.sha256(f"{version()} {asked.tests}".encode()).hexdigest()[:12]
    names = [f"G{i:04d}" for i in range(asked.tests)]
    for seed, name in enumerate(names):
        if not (kept / "raw_tests" / name).exists():
            generate(kept, name, seed)

    def part(name: str, make: Callable[[Path], Part]) -> Part:
        result = kept / f"{name}.made.json"
        if not result.exists():
            shutil.rmtree(kept / name, ignore_errors=True)
            found = make(kept / name)
            result.write_text(json.dumps(found | {"products": products(kept / name, names)}))
        return dict(json.loads(result.read_text()))

    part("warm", lambda out: {"seconds": pinned(kept, out, names[:WORKERS])})  # compiled, and tables made, once
    alone = part("alone", lambda out: {"seconds": pinned(kept, out, names)})
    together = part("together", lambda out: undisturbed(kept, out, names))
    every = together["seconds"] / max(asked.kills, 1)
    killed = part("killed", lambda out: disturbed(kept, out, [*names, DEADLY], asked.kills, every))
    sent, given = size(kept / "raw_tests"), size(kept / "together") / asked.tests
    lines = told(asked.tests, alone, together, killed, sent, given)
    print("\n".join(["", *lines]))
    if asked.write:
        put(asked.write, "campaign", lines)
    return 0


def told(tests: int, alone: Part, together: Part, killed: Part, sent: float, given: float) -> list[str]:
    """The lines of the page."""
    took = list(together["took"].values())
    sizes = together["sizes"]
    tenth = max(len(sizes) // 10, 1)
    early, late = (sum(part) / len(part) for part in (sizes[2 * tenth : 3 * tenth], sizes[-tenth:]))
    rows = [
        ("two pinned processes", alone, tests),
        ("a campaign on two workers", together, len(took)),
        (f"the same, {killed['kills']} workers killed, and all of it once", killed, len(killed["took"])),
    ]
    between = WORKERS * (together["seconds"] - together["start"]) - sum(took)
    hundred = [
        (many, sum(took) / len(took) * many / 100.0, *(estimate(took, many, 100, together["empty"], *way)
            for way in ((0.0, 0.0), (sent * many / tests, given))))
        for many in (tests, 20 * tests)
    ]  # fmt: skip
    return [
        "| | seconds | tests that ended well | what it made |",
        "|---|---|---|---|",
        *(
            f"| {what} | {part['seconds']:.0f} | {well} of {tests} | "
            f"{'the same, byte by byte' if part['products'] == alone['products'] else '**other**'} |"
            for what, part, well in rows
        ),
        "",
        f"Throughput {alone['seconds'] / together['seconds']:.2f} of that of two pinned processes,",
        f"{sum(took) / len(took):.2f} s of a processor a test. Between two tests a worker waits "
        f"{1e3 * between / tests:.0f} ms; a task that does nothing takes {1e3 * together['empty']:.1f} ms.",
        f"Memory of both workers {early:.0f} MB in the third tenth of the time, {late:.0f} MB in the last one; of the",
        f"process that spreads the work {together['own']:.0f} MB at its peak.",
        "",
        f"The disturbed one was killed with its scheduler when {killed['ended'][0]} tests were done, and begun again.",
        f'One more test, that ends each process that runs it: "{killed["failed"].get(DEADLY, "**not named**")}".',
        "",
        "A hundred workers were not tried. What would come of it, if a worker takes as long for a test as here, the",
        f"scheduler {1e3 * together['empty']:.1f} ms for each, one after the other, and all are behind one link of "
        f"{LINK * 8e-9:.0f} Gbit/s ({1e-6 * sent / tests:.2f} MB of",
        f"every test to every worker, {1e-6 * given:.1f} MB back from each):",
        "",
        "| tests | a hundredth of the work [s] | workers that see the folder [s] | workers that are sent it [s] |",
        "|---|---|---|---|",
        *(f"| {many} | {ideal:.0f} | {shared:.0f} | {carried:.0f} |" for many, ideal, shared, carried in hundred),
    ]


if __name__ == "__main__":
    sys.exit(main())
