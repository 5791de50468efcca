"""Test directories on disk: raw_tests/ID/{test.toml, log.csv} for the engineer, answers/ID.json kept apart."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Sequence
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pandas as pd

from . import sensors as se
from . import slots as s
from .build import Built, answer, build
from .plan import Case
from .version import generator_digest

COLUMNS = {"p_tank": "PT-TANK", "p_run": "PT-RUN", "p_chamber": "PT-CC", "p_purge": "PT-PURGE", "thrust": "LC-THRUST",
           "m_tank": "LC-TANK"}  # fmt: skip
SUFFIX = {"psi": "psia", "lbf": "lbf", "kg": "kg"}


def column(channel: str) -> str:
    """Its heading in the log."""
    return f"{COLUMNS[channel]} ({SUFFIX[se.UNITS[channel]]})"


def channels_of(b: Built) -> list[str]:
    """A stand without a purge line has no sensor on it."""
    return [c for c in s.CHANNELS if c != "p_purge" or b.stand.supply is not None]


def _channel(name: str) -> str:
    zero = '\nzero = "ambient"' if name in se.ZEROED else ""
    tare = '\ntare = "auto"' if name == "thrust" else ""
    unit = se.UNITS[name]
    return (
        f'[channels.{name}]\ncolumn = "{column(name)}"\nunit = "{unit}"\n'
        f'accuracy = "{se.ACCURACY[name]:g} {unit}"{zero}{tare}\n'
    )


def document(b: Built) -> str:
    """test.toml: what an engineer knows."""
    x, t = b.stand, b.true
    end = min(v for v in (t.t_fuel_out, x.closing) if np.isfinite(v))
    stand = f'stand = "{b.case.stand}"\n' if b.case.stand else ""
    purge = f'[purge]\ncracking_pressure = "{x.cracking / 1e5:.6g} bar"\n\n' if x.supply is not None else ""
    left = (
        "" if np.isfinite(t.t_fuel_out) else f'fuel_mass_after = "{1e3 * b.weighed["fuel_mass_after"]:.0f} +/- 5 g"\n'
    )
    channels = "\n".join(_channel(name) for name in channels_of(b))
    return f"""schema = 1
[test]
id = "{b.case.id}"
kind = "hot_fire"
date = 2026-01-01
source = "synthetic"
description = "a hot fire"
{stand}
[log]
files = ["log.csv"]
time = {{ column = "Time (s)", unit = "s" }}

{channels}
[tank]
volume = "{1e3 * x.volume:.8g} L"
oxidizer_mass = "{b.weighed["oxidizer_mass"]:.3f} +/- 0.010 kg"

[injector]
holes = {x.holes}
hole_area = "{1e6 * x.hole_area:.8g} mm^2"

{purge}[grain]
mass = "{1e3 * x.fuel_mass:.8g} g"
length = "{1e3 * x.grain_length:.8g} mm"
density = "{x.fuel_density:.8g} kg/m^3"
outer_radius = "{1e3 * x.outer_radius:.8g} mm"

[chamber]
pre_volume = "{1e3 * x.pre_volume:.8g} L"
post_volume = "{1e3 * x.post_volume:.8g} L"

[nozzle]
throat_radius = "{1e3 * x.throat_radius:.8g} mm"
exit_radius = "{1e3 * x.exit_radius:.8g} mm"

[site]
ambient_pressure = "{x.ambient / 1e5:.8g} bar"

[observed]
burn_time = "{end:.1f} s"
{left}
[[exclude]]
channels = {json.dumps([c for c in channels_of(b) if c not in ("p_chamber", "thrust")])}
start = "{b.log.t_open + x.closing:.3f} s"
end = "{float(b.log.time[-1]) + 0.001:.3f} s"
"""


def write_case(case: Case, root: Path) -> Path:
    """Write one case; the answer comes last, whole, and is what says that the case is there."""
    b = build(case)
    folder = root / "raw_tests" / case.id
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "test.toml").write_text(document(b), encoding="utf-8")
    frame = pd.DataFrame({"Time (s)": [f"{t:.3f}" for t in b.log.time]})
    for name in channels_of(b):
        frame[column(name)] = b.log.values[:, s.CHANNELS.index(name)]
    frame.to_csv(folder / "log.csv", index=False, float_format="%.4f", lineterminator="\n")
    path = answer_path(case, root)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(answer(b) | {"generator": generator_digest()}, indent=1), encoding="utf-8")
    os.replace(part, path)
    return path


def answer_path(case: Case, root: Path) -> Path:
    """Where the answer to a case lies."""
    return root / "answers" / f"{case.id}.json"


def _job(job: tuple[Case, Path]) -> tuple[str, float, str | None]:
    start = time.perf_counter()
    try:
        write_case(*job)
    except Exception as e:
        return job[0].id, time.perf_counter() - start, f"{type(e).__name__}: {e}"
    return job[0].id, time.perf_counter() - start, None


def write_all(cases: Sequence[Case], root: Path, jobs: int = 1) -> list[str]:
    """Write the cases that are not there yet, telling how far it is; ids and reasons of those that failed."""
    todo = [(c, root) for c in cases if not answer_path(c, root).exists()]
    say = f"{len(cases)} cases, {len(cases) - len(todo)} there"
    print(say, file=sys.stderr, flush=True)
    failed, start = [], time.perf_counter()
    with get_context("spawn").Pool(jobs) as pool:
        for done, (name, seconds, error) in enumerate(pool.imap_unordered(_job, todo), 1):
            if error:
                failed.append(f"{name}: {error}")
                print(failed[-1], file=sys.stderr, flush=True)
            left = (time.perf_counter() - start) / done * (len(todo) - done)
            print(f"{done}/{len(todo)} {name} {seconds:.1f} s, {left:.0f} s to go", file=sys.stderr, flush=True)
    return failed
