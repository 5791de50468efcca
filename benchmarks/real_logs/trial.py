"""One log through ``hfa new``, its facts, and ``hfa run``."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from benchmarks.real_logs.facts import Facts, completed

LIMIT = 1800.0
"""[s] that a run may take."""
RISE = 60.0 * 6894.757
"""[Pa] that the run line has risen by at the hand analysis' zero of time."""


@dataclass
class Outcome:
    """What came of one log: how the commands ended, what they said, and the products there are."""

    facts: Facts
    drafted: str = ""
    status: int | None = None
    said: list[str] = field(default_factory=list)
    products: dict[str, Any] = field(default_factory=dict)
    origin: float = math.nan
    """[s after the opening] at which the times of the hand analysis begin."""

    def quantity(self, name: str) -> dict[str, Any] | None:
        """A quantity of the products, by its name."""
        if name == "flow_area":
            return self._flow_area()
        for product in ("segments", "calibration", "validation", "flight"):
            content = self.products.get(product, {})
            for place in (content, content.get("performance", {}).get("measured", {})):
                if isinstance(place.get(name), dict):
                    return dict(place[name])
        return None

    def _flow_area(self) -> dict[str, Any] | None:
        found, injector = self.quantity("C_i"), self.facts.add.get("injector", {})
        if found is None or "hole_diameter" not in injector:
            return None
        number, unit = injector["hole_diameter"].split()
        diameter = float(number) * {"mm": 1e-3, "in": 0.0254}[unit]
        area = injector["holes"] * math.pi / 4.0 * diameter**2
        joint = self.products.get("calibration", {}).get("joint")
        value = None if found.get("value") is None else area * found["value"]
        std = joint["std"][joint["names"].index("flow_area")] if joint else None  # what no error of the holes is in
        interval = None if value is None or std is None else [value - 1.96 * std, value + 1.96 * std]
        return {**found, "value": value, "std": std, "ci95": interval, "unit": "m^2"}


def tried(facts: Facts, logs: Path, root: Path) -> Outcome:
    """The outcome of one log, in a scratch root."""
    outcome = Outcome(facts)
    folder = root / "raw_tests" / facts.name
    shutil.rmtree(folder, ignore_errors=True)
    named = [option for path in facts.logs(logs / facts.name) for option in ("--log", str(path))]
    made = _hfa("new", facts.name, *named, "--root", str(root))
    outcome.drafted = next((line for line in made.stdout.splitlines() if line.startswith("of ")), "")
    outcome.status, outcome.said = made.returncode, made.stderr.splitlines()
    if made.returncode:
        return outcome
    draft = folder / "test.toml"
    draft.write_text(completed(draft.read_text(encoding="utf-8"), facts), encoding="utf-8")
    for name in facts.copy:
        shutil.copyfile(logs / facts.name / name, folder / name)
    ended = _hfa("run", facts.name, "--quiet", "--root", str(root))
    outcome.status, outcome.said = ended.returncode, ended.stderr.splitlines()
    return _with_products(outcome, root)


def _with_products(outcome: Outcome, root: Path) -> Outcome:
    folder = root / "processed" / outcome.facts.name
    for path in sorted(folder.glob("*.json")):
        outcome.products[path.stem] = json.loads(path.read_text(encoding="utf-8"))
    if outcome.facts.hand and (folder / "ingest.h5").is_file():
        outcome.origin = _origin(folder / "ingest.h5", outcome)
    return outcome


def kept(facts: Facts, root: Path) -> Outcome | None:
    """The outcome of an earlier trial in this root, None where there is none."""
    path = _record(facts, root)
    if not path.is_file():
        return None
    record = json.loads(path.read_text(encoding="utf-8"))
    return _with_products(Outcome(facts, record["drafted"], record["status"], record["said"]), root)


def keep(outcome: Outcome, root: Path) -> None:
    """Put what commands said beside their products, for :func:`kept`."""
    path = _record(outcome.facts, root)
    path.parent.mkdir(parents=True, exist_ok=True)
    record = {"drafted": outcome.drafted, "status": outcome.status, "said": outcome.said}
    path.write_text(json.dumps(record), encoding="utf-8")


def _record(facts: Facts, root: Path) -> Path:
    return root / "said" / f"{facts.name}.json"


def _hfa(*arguments: str) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            [sys.executable, "-m", "hfanalysis", *arguments], capture_output=True, text=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(arguments, 124, "", f"hfa: no end after {LIMIT:g} s")


def _origin(ingested: Path, outcome: Outcome) -> float:
    """When the times of the hand analysis begin, after the opening [s]."""
    opened = outcome.quantity("t_open")
    if outcome.facts.origin == "t_open" or opened is None or opened["value"] is None:
        return 0.0
    with h5py.File(ingested, "r") as file:
        if "p_run" not in file:
            return math.nan
        line = file["p_run"]
        time, pressure = file[line.attrs["clock"]][:], line[:]
    rest = np.nanmedian(pressure[time < opened["value"] - 0.5])
    after = np.flatnonzero((time > opened["value"] - 1.0) & (pressure > rest + RISE))
    return float(time[after[0]] - opened["value"]) if after.size else math.nan
