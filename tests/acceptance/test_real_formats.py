"""Published logs in the formats of other programs go through the whole pipeline; they are not in the repository."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.record.log import Flag, TestLog, read_log
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import open_log

HERE = Path(__file__).parent / "real"
LOGS = Path(os.environ.get("HFA_REAL_TESTS", Path(__file__).parents[3] / "shared" / "real_tests"))
TESTS = ("AESIR-HT2.1", "AJ-CF1", "AJ-HF1", "LAB-burn1", "RICE-HF2")


@pytest.fixture(scope="module")
def products(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, Path]]:
    """Exit status and products of the tests whose logs are there."""
    root = tmp_path_factory.mktemp("root")
    found = {}
    for test in TESTS:
        if (LOGS / test).is_dir():
            shutil.copytree(LOGS / test, root / "raw_tests" / test)
            shutil.copy(HERE / test / "test.toml", root / "raw_tests" / test)
            found[test] = (run(root, test), root / "processed" / test)
    return found


def run(root: Path, test: str) -> int:
    command = [sys.executable, "-c", "from hfanalysis.cli import main; main()", "run", "--root", str(root), test]
    return subprocess.run(command, check=False, capture_output=True).returncode


def product(products: dict[str, tuple[int, Path]], test: str) -> Path:
    if test not in products:
        pytest.skip(f"no log of {test} in {LOGS}")
    return products[test][1]


def log_of(products: dict[str, tuple[int, Path]], test: str) -> TestLog:
    return read_log(product(products, test) / "ingest.h5")


def segments(products: dict[str, tuple[int, Path]], test: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((product(products, test) / "segments.json").read_text())
    return content


@pytest.mark.parametrize("test", TESTS)
def test_the_pipeline_ends_well_or_says_what_the_log_does_not_hold(products: Any, test: str) -> None:
    folder = product(products, test)
    assert products[test][0] in (0, 3)
    assert (folder / "segments.json").is_file()
    definition = load_definition(find_definition(folder.parents[1], test))
    assert set(read_log(folder / "ingest.h5").channels) == set(definition.channels)


def test_the_phases_of_aj_hf1_are_those_in_its_authors_notes(products: Any) -> None:
    """Valve at sample 3116, liquid out at 3227, counted from 1 as MATLAB does.

    The valve takes some tenths of a second to pass what the tank and the chamber can feel, at 8.6 Hz three to four
    samples; the liquid's end was read off the curve, to no better than that.
    """
    time = log_of(products, "AJ-HF1")["p_tank"].time
    found = segments(products, "AJ-HF1")
    t_open = found["t_open"]["value"]
    assert t_open - time[3115] == pytest.approx(0.25, abs=0.35)
    assert t_open + found["t_v"]["value"] == pytest.approx(time[3226], abs=0.5)
    assert found["t_end"]["value"] < time[3370] - t_open


def test_the_cold_flow_begins_where_its_authors_marked_it(products: Any) -> None:
    """DumpInd of AJ-CF1: sample 8694, counted from 1, at 9.6 Hz; one sample's doubt on either side."""
    time = log_of(products, "AJ-CF1")["p_tank"].time
    found = segments(products, "AJ-CF1")
    assert found["kind"] == "cold_flow"
    assert found["t_open"]["value"] == pytest.approx(time[8693], abs=0.22)


def test_every_channel_of_aesir_has_its_own_clock(products: Any) -> None:
    log = log_of(products, "AESIR-HT2.1")
    rates = {name: 1.0 / np.median(np.diff(log[name].time)) for name in ("p_tank", "p_run", "m_tank")}
    assert rates["p_tank"] == pytest.approx(100.0, rel=0.02)
    assert rates["m_tank"] == pytest.approx(2.0, rel=0.02)
    assert len(log["p_tank"].time) != len(log["p_run"].time)
    dropped = (log["p_run"].flags & Flag.DROPOUT) != 0
    assert dropped.sum() >= 67, "readings of -10 bar"
    assert np.nanmin(log["p_run"].values[~dropped]) > -10e5 + 101325.0


def test_the_stamps_of_rice_are_spread_within_their_seconds(products: Any) -> None:
    log = log_of(products, "RICE-HF2")
    time = log["p_tank"].time
    assert time[0] == pytest.approx(1708759806.0)
    assert (np.diff(time) > 0.0).mean() > 0.99
    assert np.nanmax(log["T_chamber"].values) > 320.0


def test_labview_units_and_numbers_are_those_in_the_file(products: Any) -> None:
    log = log_of(products, "LAB-burn1")
    assert log["p_chamber"].time[0] == pytest.approx(60.273930)
    assert log["p_chamber"].values[0] == pytest.approx(12.561845 * 6894.757, rel=1e-6)
    assert log["oxidizer_flow"].values[0] == 0.0


def test_a_native_tdms_log_shows_its_channels() -> None:
    """PSP-coldflow2 holds two thermocouples and no clock: the sample rate stands in the name of its group."""
    logs = sorted((LOGS / "PSP-coldflow2").glob("*.tdms"))
    if not logs:
        pytest.skip(f"no log of PSP-coldflow2 in {LOGS}")
    source = open_log(logs[0], FileSpec(logs[0].name))
    assert [name.rpartition(".")[2] for name in source.columns] == ["tc-fu-201", "tc-ox-201"]
    assert source.stamps_of(0) is None
    (chunk,) = source.chunks([0, 1], [], lambda share: None)
    assert {len(numbers) for numbers in chunk.columns.values()} == {72730}
