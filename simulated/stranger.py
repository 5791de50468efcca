"""The log of a stand that nobody has described: an engine of simulated/engine.py as another team's logger writes it.

python -m simulated.stranger fire.csv [--seed 11]

Time in milliseconds that says no unit, semicolons and decimal commas, gauge pressures, thrust and tank in kilograms, a
chamber column without a unit, a relay and an unused input beside them: docs/tutorial.md goes from there to a verdict.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from simulated.engine import EngineTruth, make_log
from simulated.stand import AMBIENT, PSI, Array

SEED = 11
"""A firing that shows its phases: 8.7 s of liquid, fuel to the end of it, 200 samples a second."""
GRAVITY = 9.80665
"""[m/s^2]. Source: standard gravity."""
LATE = 48_211.0
"""[ms] that the logger had run when the log begins."""


def write(path: Path, seed: int = SEED) -> EngineTruth:
    """Write the log to ``path``; returns what is in it."""
    with tempfile.TemporaryDirectory() as folder:
        truth = make_log(Path(folder), seed)
        plain = pd.read_csv(Path(folder) / "log.csv")
    columns = _as_theirs(plain, truth.stand.t_open, np.random.default_rng([7, seed]))
    pd.DataFrame(columns).to_csv(path, sep=";", decimal=",", index=False, float_format="%.3f", lineterminator="\n")
    return truth


def _as_theirs(plain: pd.DataFrame, opening: float, generator: np.random.Generator) -> dict[str, Array]:
    """Their columns, in their units; the igniter's relay closes before the valve opens, at ``opening`` [s]."""
    seconds = plain["Time (s)"].to_numpy(dtype=float)
    return {
        "millis": np.round(LATE + 1e3 * (seconds - seconds[0])),
        "PT_NOS_TANK (barg)": _gauge(plain["PT-TANK (psia)"]),
        "PT_MANIFOLD (barg)": _gauge(plain["PT-RUN (psia)"]),
        "CHAMBER": _gauge(plain["PT-CC (psia)"]),
        "N2 line (barg)": _gauge(plain["PT-PURGE (psia)"]),
        "Thrust (kg)": plain["LC-THRUST (N)"].to_numpy(dtype=float) / GRAVITY,
        "Tank scale (kg)": plain["LC-TANK (kg)"].to_numpy(dtype=float),
        "IGN": np.where(np.abs(seconds - opening) < 0.7, 1.0, 0.0),
        "AUX3": 2.5 + 0.004 * generator.standard_normal(seconds.size),
    }


def _gauge(pressure: pd.Series) -> Array:
    """A pressure [psi] above the ambient one, in bar."""
    return (pressure.to_numpy(dtype=float) * PSI - AMBIENT) / 1e5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, help="the log to write")
    parser.add_argument("--seed", type=int, default=SEED, help="another firing")
    asked = parser.parse_args()
    write(asked.log, asked.seed)


if __name__ == "__main__":
    main()
