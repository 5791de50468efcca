"""Two published firings of the McGill stand: what the page says of their sensors, by itself."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest

from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

HERE = Path(__file__).parent / "real"
LOGS = Path(os.environ.get("HFA_REAL_TESTS", Path(__file__).parents[3] / "shared" / "real_tests"))


def validated(root: Path, test: str) -> dict[str, Any]:
    if not (LOGS / test / "log.csv").is_file():
        pytest.skip(f"no log of {test} in {LOGS}")
    folder = root / "raw_tests" / test
    folder.mkdir(parents=True)
    shutil.copy(HERE / test / "test.toml", folder)
    shutil.copy(LOGS / test / "log.csv", folder)
    out = run_to("validate", open_test(root, test)).out
    found: dict[str, Any] = json.loads((out / "validation.json").read_text())
    return found


def told(root: Path, test: str) -> set[str]:
    """The kinds of what health tells of the thrust cell."""
    health = json.loads((root / "processed" / test / "health.json").read_text())
    return {finding["kind"] for finding in health["channels"]["thrust"]["findings"]}


def test_a_cell_that_stays_off_zero_and_a_thrust_that_no_nozzle_gives(tmp_path: Path) -> None:
    """HF3.1: some 170 N when the chamber is empty, and half the thrust that its chamber pressure makes."""
    found = validated(tmp_path, "MRT-HF3.1")
    assert told(tmp_path, "MRT-HF3.1") == {"zero", "scale"}
    measured = found["performance"]["measured"]
    assert measured["total_impulse"]["value"] < 0.75 * measured["total_impulse_of_file"]["value"]
    assert measured["peak_thrust"]["value"] == pytest.approx(1699.0, rel=0.05)


def test_a_thrust_that_fits_its_chamber_pressure(tmp_path: Path) -> None:
    """HF3.4: the cell is off by hundreds of newtons after the burn, the thrust in the burn is plausible."""
    found = validated(tmp_path, "MRT-HF3.4")
    assert told(tmp_path, "MRT-HF3.4") == {"zero"}
    measured = found["performance"]["measured"]
    assert 18_000.0 < measured["total_impulse"]["value"] < 28_583.0  # their integral over the whole file
    assert measured["peak_chamber_pressure"]["value"] == pytest.approx(582 * 6894.757, rel=0.06)
