"""Answers, products and work made up for tests of the scorer and of the benchmark."""

from __future__ import annotations

import os
import signal
import time
from typing import Any

from benchmarks.blind.work import Job, Result

STEP = {"unit": "W", "channel": None, "start": 0.025, "step": 0.05, "values": [500.0] * 200}


def answer(name: str | None, d: float = 10.0, kind: str = "single", inside: bool = True, **more: Any) -> dict[str, Any]:
    effects = [] if name is None else [
        {"name": n, "inside_library": inside, "equation": "tank_energy", "equations_accepted": ["tank_energy"],
         "phases": ["liquid"], "onset": 1.0, "onset_kind": "step", "source": STEP} for n in name.split("+")
    ]  # fmt: skip
    base = {"kind": "none" if name is None else kind, "effects": effects, "d_prime": d, "target_d_prime": d,
            "against": {"tank_heat": 9.0, "n2_purge": 8.0}, "given_others": {}, "after_best_of_library": d,
            "noise": {"family": "ar1"}}  # fmt: skip
    return base | more


def product(label: str, p: float = 0.95, place: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    named = label not in ("none", "unknown")
    base = {"verdict": "named" if named else label, "effects": [{"name": label}] if named else [],
            "posterior": {label: p, "tank_wall_heat_capacity": 1.0 - p}, "set90": [label],
            "localisation": [place] if place else []}  # fmt: skip
    return base | more


def work(job: Job) -> Result:
    """What the job's name says: die, die once, take for ever, fail; else a moment."""
    begun = time.monotonic()
    mark = job.products / f"{job.id}.tried"
    if job.id.startswith("die") and not ("once" in job.id and mark.exists()):
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if job.id.startswith("for-ever"):
        time.sleep(600.0)
    if job.id.startswith("fail"):
        raise ValueError("no pressure in this log")
    time.sleep(0.1)
    return Result(begun, time.monotonic(), {"worker": os.getpid()})


def nothing() -> None:
    """What this work needs loaded."""


def broken() -> None:
    """What cannot be loaded."""
    raise ImportError("no such library")
