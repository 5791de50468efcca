"""A test on disk whose log is a run of the stand's engine with effects in it, read by sensors with a little noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tests.engine.stand import engine_on_stand

from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import burn

NOISE = {"p_tank": 3e3, "p_run": 3e3, "p_chamber": 2e3, "thrust": 4.0}
"""Standard deviation of a sample [SI]."""

RATE, REST, AFTER = 200.0, 4.0, 3.0
"""Samples per second; seconds at rest before the opening, and after the burn."""

DEFINITION = """schema = 1
[test]
id = "T1"
kind = "hot_fire"
source = "synthetic"
stand = "paper"
[log]
files = ["log.csv"]
time = { column = "time", unit = "s" }
[channels]
p_tank = { column = "p_tank", unit = "Pa", accuracy = "5 kPa" }
p_run = { column = "p_run", unit = "Pa", accuracy = "5 kPa" }
p_chamber = { column = "p_chamber", unit = "Pa", accuracy = "5 kPa" }
thrust = { column = "thrust", unit = "N", accuracy = "5 N", tare = "none" }
[tank]
volume = "16.5 +/- 0 L"
oxidizer_mass = "8.35 +/- 0.01 kg"
[injector]
holes = 22
hole_area = "3.142 +/- 0 mm^2"
[grain]
mass = "1594 g"
length = "610 mm"
density = "788.9 kg/m^3"
outer_radius = "39.497 mm"
[chamber]
pre_volume = "0.218 L"
post_volume = "0.885 L"
[nozzle]
throat_radius = "23.3 mm"
exit_radius = "38.1 mm"
[site]
ambient_pressure = "100900 Pa"
[rocket]
dry_mass = "52.5 kg"
drag_coefficient = 0.529
diameter = "157.48 mm"
launch_angle = "6 deg"
rail_length = "6.05 m"
launch_altitude = "1402 m"
"""


def make_root(root: Path, *effects: Active) -> Path:
    """A root with the test T1; ``effects`` are in its log and in nothing else."""
    folder = root / "raw_tests" / "T1"
    folder.mkdir(parents=True)
    (folder / "test.toml").write_text(DEFINITION, encoding="utf-8")
    time, values = _readings(*effects)
    table = np.column_stack((time + 100.0, *values.values()))
    header = ",".join(("time", *values))
    np.savetxt(folder / "log.csv", table, fmt="%.9g", delimiter=",", header=header, comments="")
    return root


def _readings(*effects: Active) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    engine = engine_on_stand(effects=effects)
    done = burn(engine, 30.0, run_on=True)
    rng = np.random.default_rng(4)
    time = np.arange(-REST, min(done.burn_time + AFTER, 29.0), 1.0 / RATE)
    running = observe(done, np.maximum(time, 0.0))
    still = {"p_tank": running["p_tank"][0], "p_run": engine.ambient, "p_chamber": engine.ambient, "thrust": 0.0}
    out = {}
    for name, noise in NOISE.items():
        true = np.where(time < 0.0, still[name], running[name])
        out[name] = true + noise * rng.standard_normal(time.size)
    return time, out
