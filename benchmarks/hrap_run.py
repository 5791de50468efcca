"""A 17 s run of an engine like HF5's beside HRAP's run of a comparable engine.

HRAP (https://pypi.org/project/hrap/) gets an environment of its own below ``.cache/``, made when it is missing; nothing
of it is needed elsewhere. Both engines have the same tank, load, injector, grain, nozzle, chamber and combustion gas.
HRAP compiles with JAX at its first call; the ratio is that of the quickest later calls, compiled as a whole. Its step
is the 1 ms of its window and examples; both its cheap steppers are shown, forward Euler being that of its example.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import venv
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from simulated.engines import HOLE_AREA, HOLES, hf5_like

from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.flight.constant_thrust import Vehicle
from hfanalysis.thermo.combustion import equilibrium

ENVIRONMENT = Path(__file__).resolve().parent.parent / ".cache" / "hrap"
PACKAGES = ("hrap", "matplotlib")
"""hrap 0.1.8 imports matplotlib without asking for it."""

SECONDS = 17.0
STEP = 1e-3
STAND = 1e12
"""Dry mass [kg] of what stays where it is."""

DISCHARGE = 0.294


def hf5() -> Engine:
    """Hot Fire 5 of the report (its tables of C_i and of the grain), bolted down, at a tank of 25 degC."""
    return replace(
        hf5_like(),
        feed=FeedSystem(16.5e-3, HOLES * HOLE_AREA * DISCHARGE),
        temperature=298.15,
        polytropic_exponent=None,
        a=5e-4,
        n=0.156,
        vehicle=Vehicle(STAND, 1.0, 1.0, 0.0, 0.0),
        ambient_pressure=None,
        oxidizer_enthalpy=None,
    )


def run(engine: Engine) -> Burn:
    """From ignition through vapor and cold gas."""
    return burn(engine, longest=SECONDS, run_on=True)


def for_hrap(engine: Engine, repeats: int) -> dict[str, Any]:
    """The engine in HRAP's terms, the gas from the same equilibrium."""
    ratios, pressures = np.linspace(1.0, 40.0, 40), np.linspace(1e5, 40e5, 14)
    gases = [[equilibrium(float(p), float(r)) for p in pressures] for r in ratios]
    volume = engine.dead_volume + pi * engine.outer_radius**2 * engine.grain_length
    return {
        "tank_volume": engine.feed.volume, "holes": HOLES, "hole_area": HOLE_AREA * DISCHARGE,
        "oxidizer_mass": engine.oxidizer_mass, "temperature": engine.temperature,
        "port_diameter": 2.0 * engine.port_radius, "grain_diameter": 2.0 * engine.outer_radius,
        "grain_length": engine.grain_length, "fuel_density": engine.fuel_density, "a": engine.a, "n": engine.n,
        "throat_diameter": 2.0 * sqrt(engine.throat_area / pi), "area_ratio": engine.exit_area / engine.throat_area,
        "chamber_volume": volume, "ambient": 101_325.0, "step": STEP, "seconds": SECONDS, "repeats": repeats,
        "ratios": list(ratios), "pressures": list(pressures),
        "k": [[g.gamma for g in row] for row in gases],
        "M": [[g.molar_mass for g in row] for row in gases],
        "T": [[g.temperature for g in row] for row in gases],
    }  # fmt: skip


def python() -> Path:
    """The Python of HRAP's environment, which is made where it is missing; raises OSError where that fails."""
    found = ENVIRONMENT / "bin" / "python"
    if not (ENVIRONMENT / "complete").exists():
        print(f"making {ENVIRONMENT} with {', '.join(PACKAGES)} (once)", flush=True)
        venv.create(ENVIRONMENT, with_pip=True, clear=True)
        pip = [str(found), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PACKAGES]
        done = subprocess.run(pip, capture_output=True, text=True, check=False)
        if done.returncode:
            raise OSError(f"pip could not install them: {(done.stderr.strip().splitlines() or ['?'])[-1]}")
        (ENVIRONMENT / "complete").touch()
    return found


def theirs(engine: Engine, repeats: int) -> list[dict[str, Any]]:
    """HRAP's times; raises OSError where it cannot run."""
    script = [str(python()), str(Path(__file__).with_name("hrap_engine.py"))]
    case = json.dumps(for_hrap(engine, repeats))
    done = subprocess.run(script, input=case, capture_output=True, text=True, check=False)
    if done.returncode:
        raise OSError(f"HRAP did not run: {(done.stderr.strip().splitlines() or ['?'])[-1]}")
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


def ours(engine: Engine, repeats: int) -> tuple[list[float], Burn]:
    """Seconds of each run, the first included."""
    times = []
    for _ in range(1 + repeats):
        start = perf_counter()
        done = run(engine)
        times.append(perf_counter() - start)
    return times, done


def report(times: list[float], done: Burn, hrap: list[dict[str, Any]]) -> float:
    """Print both and return the ratio of the later runs, with the fastest way of calling HRAP."""
    peak, impulse = done.output("chamber_pressure").max(), done.state("impulse")[-1]
    print(f"{'':30}{'first, ms':>10}{'later, ms':>10}{'end, s':>8}{'impulse, kN s':>15}{'peak p_c, bar':>15}")
    later = min(times[1:])
    print(
        f"{'hfanalysis':30}{1e3 * times[0]:10.1f}{1e3 * later:10.2f}{done.time[-1]:8.2f}{impulse / 1e3:15.2f}"
        f"{peak / 1e5:15.2f}"
    )
    for found in hrap:
        for way in ("called", "jit"):
            print(
                f"{'HRAP, ' + found['stepper'] + ', ' + way:30}{1e3 * found[way]['first']:10.0f}"
                f"{1e3 * found[way]['later']:10.1f}{found['sound_until']:8.2f}{found['impulse'] / 1e3:15.2f}"
                f"{found['peak_chamber_pressure'] / 1e5:15.2f}"
            )
    if any(found["sound_until"] < SECONDS - STEP for found in hrap):
        print("where a row of HRAP ends early, its thrust or pressure are no numbers from there on; it computes on")
    fastest = min(found[way]["later"] for found in hrap for way in ("called", "jit"))
    print(f"HRAP's fastest takes {fastest / later:.1f} times as long")
    return fastest / later


def main() -> int:
    """Exit status 0 also where HRAP is not to be had, which is said."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--least", type=float, default=0.0, help="fail below this ratio")
    options = parser.parse_args()
    engine = hf5()
    try:
        hrap = theirs(engine, options.repeats)
    except OSError as error:
        print(f"skipped: {error}")
        return 0
    ratio = report(*ours(engine, options.repeats), hrap)
    return int(ratio < options.least)


if __name__ == "__main__":
    sys.exit(main())
