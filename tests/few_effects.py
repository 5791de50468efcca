"""A library of a few effects, for tests in which a diagnosis has to end, not to choose among many."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hfanalysis import effects

FEW = ("chamber_tap_lag", "load_cell_drift", "nozzle_throat_erosion", "tank_heat")
"""One for the tank, one for the nozzle with its twin, one for a sensor."""

CODE = f"""
import hfanalysis.effects as effects
whole = effects.library
effects.library = lambda folder=None: {{name: effect for name, effect in whole(folder).items() if name in {FEW}}}
"""
"""Has a process know these alone, though all are loaded."""


def install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have diagnoses of this process try these alone."""
    whole = effects.library
    monkeypatch.setattr(effects, "library", lambda folder=None: {n: e for n, e in whole(folder).items() if n in FEW})


def environment(folder: Path) -> dict[str, str]:
    """In which processes of Python try these alone; ``folder`` takes the file that they start with."""
    (folder / "sitecustomize.py").write_text(CODE, encoding="utf-8")
    path = os.environ.get("PYTHONPATH")
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *([path] if path else [])])}
