"""The McGill stand's published logs are read by the definitions kept here; the logs are not in the repository."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

HERE = Path(__file__).parent / "real"
LOGS = Path(os.environ.get("HFA_REAL_TESTS", Path(__file__).parents[3] / "shared" / "real_tests"))
TESTS = sorted(path.parent.name for path in HERE.glob("MRT-*/test.toml"))


def read(root: Path, test: str) -> TestLog:
    """The test ingested from a copy of its definition and log."""
    if not (LOGS / test / "log.csv").is_file():
        pytest.skip(f"no log of {test} in {LOGS}")
    folder = root / "raw_tests" / test
    folder.mkdir(parents=True)
    shutil.copy(HERE / test / "test.toml", folder)
    shutil.copy(LOGS / test / "log.csv", folder)
    ingest(load_definition(find_definition(root, test)), root / "ingest.h5")
    return read_log(root / "ingest.h5")


@pytest.mark.parametrize("test", TESTS)
def test_a_real_log_is_read_whole(test: str, tmp_path: Path) -> None:
    log = read(tmp_path, test)
    for name in ("p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank"):
        channel = log[name]
        assert channel.good.mean() > 0.97, name
        assert (np.diff(channel.time[channel.good]) > 0).all()
    assert 20e5 < np.nanmax(log["p_tank"].values) < 80e5
    assert log["p_chamber"].zero_std is not None
    assert log["thrust"].zero_std is not None


def test_the_drift_of_the_cell_that_does_not_return_to_zero_is_taken_off(tmp_path: Path) -> None:
    assert read(tmp_path, "MRT-HF3.1")["thrust"].drift == pytest.approx(190.0, abs=10.0)


@pytest.mark.parametrize(
    ("test", "faults"),
    [
        ("MRT-HF3.1", ["thrust zero off", "thrust and chamber pressure scale off"]),
        ("MRT-HF3.4", ["thrust zero off"]),
    ],
)
def test_the_verdict_of_the_page_names_by_itself_what_is_wrong_with_the_sensors(
    test: str, faults: list[str], tmp_path: Path
) -> None:
    read(tmp_path, test)
    context = run_to("report", open_test(tmp_path, test))
    lead = re.findall(r'<p class="lead">(.*?)</p>', context.product("report.html").read_text(encoding="utf-8"))
    assert len(lead) == 1
    assert [fault for fault in faults if fault in lead[0]] == faults
    assert ("Sensors:" in lead[0]) == bool(faults)


def test_peaks_are_those_of_the_teams_own_table(tmp_path: Path) -> None:
    log = read(tmp_path, "MRT-HF3.4")
    psi = 6894.757
    assert np.nanmax(log["p_tank"].values) / psi == pytest.approx(977, abs=3)
    assert np.nanmax(log["p_chamber"].values) / psi == pytest.approx(582, abs=5)
    assert np.nanmax(log["thrust"].values) == pytest.approx(6204, abs=30)


@pytest.mark.parametrize(
    ("test", "falls", "set90", "beside"),
    [
        ("MRT-HF2.3", None, ["n2_purge"], {}),
        ("MRT-HF2.4", 9.5, ["tank_stratification", "tank_nonequilibrium"], {"n2_purge": 1.0}),
        ("MRT-HF3.1", 7.8, ["tank_nonequilibrium"], {"n2_purge": 1.0, "tank_stratification": 0.5}),
        ("MRT-HF3.4", 19.3, ["tank_nonequilibrium"], {"n2_purge": 1.0, "tank_stratification": 0.5}),
    ],
)
def test_without_an_engine_the_pressures_tell_of_the_tank_and_the_nitrogen(
    test: str, falls: float | None, set90: list[str], beside: dict[str, float], tmp_path: Path
) -> None:
    """Each of these cells rests high after its firing: that is told of the cell, and is no name."""
    read(tmp_path, test)
    found = run_to("diagnose", open_test(tmp_path, test)).read_json("diagnosis.json")
    assert found["set90"] == set90
    assert sum(found["posterior"][name] for name in set90) > 0.95
    assert {name: p / (1.0 - found["posterior"]["unknown"]) for name, p in found["partners"].items()} == pytest.approx(
        beside
    )
    assert not {"load_cell_drift"} & {*found["posterior"], *found["partners"]}
    assert any(sentence.startswith("Thrust (zero): reads") for sentence in found["sentences"])
    tank = [row["source"]["value"] for row in found["localisation"] if row["channel"] == "p_tank"]
    assert tank == pytest.approx([] if falls is None else [-1e5 * falls], rel=0.02)
