"""Ascents beside RocketPy's on one core, and ten thousand drawn flights on all of them.

Usage: flights.py [--test HF5] [--flights 10000] [--rocketpy PYTHON]

RocketPy flies the exported motor straight up without wind, in a process of its own: `make rocketpy` sets up
.venv-rocketpy for it. Its rate counts whole flights to apogee, the rocket being built once.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

from hfanalysis.flight.ascent import NOMINAL, RESULTS, arguments, ascend, fly_all
from hfanalysis.measured_flight.firing import Firing, firing
from hfanalysis.measured_flight.uncertainty import disperse, rows
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import read_log
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).resolve().parent.parent

THEIRS = """
import json, runpy, sys, time
s = runpy.run_path(sys.argv[1])
rocket = s["build"]()
environment = s["Environment"](elevation=s["ELEVATION"])
environment.set_atmospheric_model(type="standard_atmosphere")
def fly():
    return s["Flight"](rocket=rocket, environment=environment, rail_length=s["RAIL_LENGTH"], inclination=90.0,
                       heading=0.0, terminate_on_apogee=True)
flight = fly()
times = []
for _ in range(int(sys.argv[2])):
    start = time.perf_counter()
    flight = fly()
    times.append(time.perf_counter() - start)
print(json.dumps([flight.apogee - s["ELEVATION"], flight.out_of_rail_velocity, flight.max_speed, times]))
"""


def prepared(context: Context) -> Firing:
    """The test's firing, all stages before it done."""
    segments = context.read(Segments)
    log = read_log(context.product("ingest.h5"))
    return firing(log, segments, context.read(Calibration), context.definition)


def ours(found: Firing, repeats: int = 400) -> tuple[np.ndarray, float]:
    """Results of a flight straight up, and the time [s] that one takes on one core."""
    upright = replace(found.vehicle, launch_angle=0.0)
    reads = arguments(found.curve, upright, found.rail_length)
    many, results = np.tile(NOMINAL, (repeats, 1)), np.empty((repeats, RESULTS))
    none = np.empty((repeats, 0, 3))
    fly_all(*reads, many[:1], results[:1], 1.0, none[:1])
    times = []
    for _ in range(5):
        start = perf_counter()
        fly_all(*reads, many, results, 1.0, none)
        times.append((perf_counter() - start) / repeats)
    assert results[0, 0] == ascend(found.curve, upright, found.rail_length).height
    return results[0], median(times)


def theirs(python: str, script: Path, repeats: int = 5) -> tuple[list[float], float] | None:
    """Apogee, rail departure and peak speed of RocketPy's flight, and the time [s] of one; None without RocketPy."""
    one_core = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [python, "-W", "ignore", "-c", THEIRS, str(script), str(repeats)]
    try:
        ended = subprocess.run(command, capture_output=True, text=True, check=True, env=one_core)
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"no RocketPy to compare with: {error}")
        return None
    *values, times = json.loads(ended.stdout.splitlines()[-1])
    return values, median(times)


def compare(found: Firing, python: str, script: Path) -> bool:
    """Print both flights side by side; whether ours is at least a hundred times faster."""
    results, fast = ours(found)
    print(f"one ascent straight up, without wind, one core: {1e3 * fast:.3f} ms")
    other = theirs(python, script)
    if other is None:
        return True
    values, slow = other
    print(f"{'':22}{'hfanalysis':>12}{'RocketPy':>12}{'difference':>12}")
    for name, mine, yours in zip(("apogee [m]", "rail [m/s]", "peak [m/s]"), results[[0, 2, 3]], values, strict=True):
        print(f"{name:22}{mine:12.2f}{yours:12.2f}{100.0 * (mine / yours - 1.0):11.2f}%")
    print(f"{'time of one [ms]':22}{1e3 * fast:12.3f}{1e3 * slow:12.1f}{slow / fast:10.0f} x")
    return slow / fast >= 100.0


def main() -> int:
    """Print the comparison and the time of drawn flights."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--test", default="HF5")
    parser.add_argument("--flights", type=int, default=10_000)
    parser.add_argument("--rocketpy", default=os.environ.get("HFA_ROCKETPY", str(ROOT / ".venv-rocketpy/bin/python")))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as out:
        context = run_to("flight", open_test(ROOT, options.test, Path(out), settings={"flight.flights": 100}))
        found = prepared(context)
        fast_enough = compare(found, options.rocketpy, context.product("{test}_rocketpy.py"))
        rocket = context.definition.rocket
    assert rocket is not None
    start = perf_counter()
    drawn = disperse(found, rows(found, rocket, options.flights, 1), 35.0)
    spent = perf_counter() - start
    spread = drawn.spreads()["apogee"]
    print(f"{options.flights} drawn flights on {os.cpu_count()} cores: {spent:.1f} s; apogee +- {spread.std:.0f} m")
    return 0 if fast_enough else 1


if __name__ == "__main__":
    sys.exit(main())
