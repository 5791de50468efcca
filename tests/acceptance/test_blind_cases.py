"""A case of the blind generator without an effect goes through the whole way, and its calibration finds the truth."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.blind.plan import Case
from tests.blind.write import write_case


def test_a_test_without_an_effect_is_accepted_and_calibrates_to_its_truth(tmp_path: Path) -> None:
    answer = json.loads(
        write_case(Case("NONE", "none", (), 0.0, "flicker", 77, 77), tmp_path).read_text(encoding="utf-8")
    )
    command = [sys.executable, "-m", "hfanalysis", "run", "NONE", "--root", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    product = tmp_path / "processed" / "NONE"
    found = json.loads((product / "calibration.json").read_text(encoding="utf-8"))
    segments = json.loads((product / "segments.json").read_text(encoding="utf-8"))
    truth = answer["truth"]
    assert found["C_i"]["value"] == pytest.approx(truth["C_i"], rel=0.02)
    assert found["m"]["value"] == pytest.approx(truth["m"], rel=0.05)
    assert found["K_loss"]["value"] == pytest.approx(truth["K_loss"], rel=0.1)
    assert segments["t_v"]["value"] == pytest.approx(truth["t_v"], abs=0.01)
    assert segments["t_purge"]["value"] == pytest.approx(truth["t_purge"], abs=0.05)
