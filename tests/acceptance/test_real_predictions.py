"""What docs/predict.md says of real firings: which cannot be predicted from which, and why.

The logs are no part of the repository: skips where they are not beside it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from benchmarks.prediction import plan_of
from tests.acceptance.test_real_performance import HERE, LOGS

from hfanalysis.errors import AbsentError
from hfanalysis.interface import predicting

PAGE = (Path(__file__).parents[2] / "docs" / "predict.md").read_text(encoding="utf-8")
CHAMBER = '\n[chamber]\npre_volume = "0.2 +/- 0.1 L"\npost_volume = "0.8 +/- 0.3 L"\n'
NOZZLE = '[nozzle]\nexit_radius = "31 +/- 2 mm"\n'
INJECTOR = '\n[injector]\nholes = 22\nhole_diameter = "2.0 +/- 0.1 mm"\n'
"""Ranges, for what is not stated of either."""


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for test in ("MRT-HF3.1", "MRT-HF3.4"):
        if not (LOGS / test / "log.csv").is_file():
            pytest.skip(f"no log of {test} in {LOGS}")
        folder = tmp_path / "raw_tests" / test
        folder.mkdir(parents=True)
        shutil.copy(LOGS / test / "log.csv", folder)
        text = (HERE / test / "test.toml").read_text(encoding="utf-8") + CHAMBER
        if "[nozzle]" in text:
            text = text.replace("[nozzle]\n", NOZZLE)
        else:
            text += f'{NOZZLE}throat_radius = "18.7 +/- 0.4 mm"\n'
        (folder / "test.toml").write_text(text if "[injector]" in text else text + INJECTOR, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("planned", "fired", "temperature", "reason", "told"),
    [
        ("MRT-HF3.4", "MRT-HF3.1", "0 +/- 3 degC", "over the oxidizer's flow is 1168 m/s", "1168 m/s"),
        (
            "MRT-HF3.1",
            "MRT-HF3.4",
            "15 +/- 3 degC",
            "of 11.40 kg in 15.3 L comes down to 56",
            "56 bar",
        ),
    ],
)
def test_it_cannot_be_predicted_because(
    planned: str, fired: str, temperature: str, reason: str, told: str, root: Path
) -> None:
    with pytest.raises(AbsentError, match=reason):
        predicting.predict(plan_of(root, planned, temperature), [fired], root, draws=20)
    assert told in PAGE
    assert not (root / "predictions" / f"{planned}.json").exists()
