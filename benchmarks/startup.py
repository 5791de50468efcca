"""Start-up beside the bare import of the stack: `hfa calibrate` done anew and found fresh, and the quick look at the
stand, each in a new process.

Usage: startup.py [--test HF5] [--repeat 7] [--against CHECKOUT]
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STACK = "import numpy, scipy.optimize, scipy.interpolate, h5py, numba, pydantic, typer, rich.table"
IMPORTED = "import sys; from hfanalysis.cli import main\ntry: main()\nexcept SystemExit: pass\nprint(*sys.modules)"
HEAVY = ("pandas", "xarray", "matplotlib", "CoolProp", "pint", "numba", "scipy", "h5py", "pydantic", "numpy")


BARE = """
from hfanalysis.performance.reconstruction.reconstruct import Reconstructed
from hfanalysis.products.reconstruction import Reconstruction
from hfanalysis.validate import validation
validation.reconstructed = lambda *_: Reconstructed(Reconstruction(variant=None, reason="left out"))
validation._Work._stability = lambda *_: {}
validation.transients = lambda *_: {}
from hfanalysis.cli import main
main()
"""
"""The command line with a validate that looks at no reconstruction, stability and transients."""

SLOWER = 0.5
"""By which these may make it slower [s]. Source: what was promised."""

AT_STAND = 3.0
"""Within which `hfa run TEST --quick` has answered [s]. Source: what was promised (docs/at-the-stand.md)."""


def processor(command: Sequence[str]) -> float:
    """Processor time [s] of a command and of all it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=ROOT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def beside(calibrate: Sequence[str], other: Sequence[str], log: Path, repeat: int) -> float:
    """Processor time of a calibration done anew over that of another command [-]: the median of pairs in turn.

    ``log``: the run's own, which says how long the health took; that does not count.
    """
    ratios = []
    for _ in range(repeat):
        against, whole = processor(other), processor(calibrate)
        stages = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
        health = [stage["seconds"] for stage in stages if stage["stage"] == "health"][-1:]
        ratios.append((whole - sum(health)) / against)
    return statistics.median(ratios)


def added(test: str, out: str, repeat: int) -> tuple[float, float]:
    """Processor time [s] that reconstruction, stability and transients add to validate, warm, and its ratio with over
    without: medians of pairs in turn."""
    arguments = ["validate", test, "--out", out, "--force"]
    whole = [str(Path(sys.executable).with_name("hfa")), *arguments]
    bare = [sys.executable, "-c", BARE, *arguments]
    pairs = [(processor(whole), processor(bare)) for _ in range(repeat + 1)][1:]
    return statistics.median(a - b for a, b in pairs), statistics.median(a / b for a, b in pairs)


def elsewhere(checkout: Path, test: str, out: str) -> list[str]:
    """The calibration done anew by the source of another checkout, on its own copy of the test, warm."""
    there = f"os.chdir({str(checkout)!r}); sys.path.insert(0, {str(checkout / 'src')!r})"
    code = f"import os, sys; {there}; from hfanalysis.cli import main; main()"
    command = [sys.executable, "-c", code, "calibrate", test, "--out", str(Path(out) / "elsewhere"), "--force"]
    processor(command)
    return command


def median_wall(command: Sequence[str], repeat: int) -> float:
    """Median wall time [s] of a command, after one run that warms the caches."""
    times = []
    for _ in range(repeat + 1):
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=ROOT)
        times.append(time.perf_counter() - start)
    return statistics.median(times[1:])


def imported(arguments: Sequence[str]) -> list[str]:
    """Which heavy libraries the command really loads."""
    code = IMPORTED.replace("main()", f"sys.argv = {['hfa', *arguments]!r}; main()", 1)
    found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=ROOT)
    modules = set(found.stdout.splitlines()[-1].split())
    return [name for name in HEAVY if name in modules]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--test", default="HF5")
    parser.add_argument("--repeat", type=int, default=7)
    parser.add_argument(
        "--against", type=Path, metavar="CHECKOUT", help="another checkout, to compare a calibration with"
    )
    options = parser.parse_args()
    hfa = str(Path(sys.executable).with_name("hfa"))
    with tempfile.TemporaryDirectory() as out:
        calibrate = [hfa, "calibrate", options.test, "--out", out]
        rows = [
            ("bare interpreter", [sys.executable, "-c", ""]),
            ("bare import of the stack", [sys.executable, "-c", STACK]),
            ("hfa --version", [hfa, "--version"]),
            ("hfa --help", [hfa, "--help"]),
            (f"hfa calibrate {options.test} --force", [*calibrate, "--force"]),
            (f"hfa calibrate {options.test}, nothing changed", calibrate),
            (quick := f"hfa run {options.test} --quick --force", [hfa, "run", *calibrate[2:], "--quick", "--force"]),
        ]
        print(f"wall time, median of {options.repeat} fresh processes, warm caches")
        took = {}
        for name, command in rows:
            took[name] = median_wall(command, options.repeat)
            print(f"  {name:<42} {took[name]:7.3f} s", flush=True)
        verdict = "within" if took[quick] <= AT_STAND else "NOT within"
        print(f"  the quick look: {verdict} {AT_STAND:g} s")
        more, times = added(options.test, out, options.repeat)
        print(
            f"  hfa validate {options.test} --force: reconstruction, stability and transients add {more:.2f} s of "
            f"processor time ({times:.2f} times, in pairs), {'within' if more <= SLOWER else 'NOT within'} {SLOWER:g} s"
        )
        other, what = [sys.executable, "-c", STACK], "the stack's import"
        if options.against:
            other, what = elsewhere(options.against, options.test, out), f"the one of {options.against}"
        ratio = beside([*calibrate, "--force"], other, Path(out) / options.test / "run.log", options.repeat)
        print(f"processor time of a calibration done anew, over that of {what}, in pairs: {ratio:.2f}")
        for name, arguments in (("redone", [*calibrate[1:], "--force"]), ("nothing changed", calibrate[1:])):
            print(f"  heavy libraries loaded, {name}: {', '.join(imported(arguments)) or 'none'}")


if __name__ == "__main__":
    main()
