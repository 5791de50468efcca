"""Results as one tidy table: CSV, Parquet, a workbook."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import pytest
from pyarrow import parquet
from python_calamine import CalamineWorkbook

from hfanalysis.errors import InputError
from hfanalysis.products import tidy

CALIBRATION = {
    "test": "T1",
    "C_i": {"value": 0.3, "unit": "", "std": 0.01, "verdict": "identified"},
    "a": {"value": 4e-4, "unit": "m/s (kg/m²/s)⁻ⁿ", "ci95": [1e-4, 9e-4]},
    "m": {"value": None, "reason": "no vapor, =SUM(1) it seems"},
    "by_law": {"spi": {"value": 0.4, "unit": ""}},
    "C_i_history": {"time": [0.0], "value": [0.3], "unit": "", "drift": {"value": 1e-3, "unit": "1/s"}},
    "provenance": {"parameters": {"value": 1, "unit": "no quantity"}},
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "T1").mkdir()
    (tmp_path / "T1" / "calibration.json").write_text(json.dumps(CALIBRATION), encoding="utf-8")
    stand = {"name": "north", "constants": {"C_i": {"value": 0.31, "unit": "", "std": 0.02}}}
    (tmp_path / "campaign.json").write_text(json.dumps({"stands": [stand]}), encoding="utf-8")
    return tmp_path


def test_a_row_per_quantity_with_interval_or_reason(folder: Path) -> None:
    found = {row["name"]: row for row in tidy.rows_of_test(folder / "T1")}
    assert list(found) == ["C_i", "a", "m", "by_law.spi", "C_i_history.drift"]  # a course over time is no number
    assert found["C_i"]["low95"] == pytest.approx(0.3 - 0.0196, abs=1e-5)
    assert found["C_i"]["unit"] == "1"
    assert (found["a"]["low95"], found["a"]["high95"], found["a"]["std"]) == (1e-4, 9e-4, None)
    assert (found["m"]["value"], found["m"]["why"]) == (None, "no vapor, =SUM(1) it seems")


def test_a_campaign_s_common_numbers_are_rows_without_a_test(folder: Path) -> None:
    rows = tidy.rows_of_campaign(folder, ["T1"])
    assert [(row["test"], row["name"]) for row in rows][-1] == ("", "stands.north.constants.C_i")
    assert len(rows) == 6


@pytest.mark.parametrize("name", ["x.csv", "x.parquet", "x.xlsx"])
def test_each_format_gives_the_same_numbers_back(folder: Path, name: str) -> None:
    rows = tidy.rows_of_test(folder / "T1")
    tidy.write(folder / name, rows)
    if name.endswith("csv"):
        with (folder / name).open(encoding="utf-8", newline="") as file:
            back = [(r["name"], float(r["value"]) if r["value"] else None) for r in csv.DictReader(file)]
    elif name.endswith("parquet"):
        back = [(r["name"], r["value"]) for r in parquet.read_table(folder / name).to_pylist()]
    else:
        sheet = CalamineWorkbook.from_path(folder / name).get_sheet_by_index(0).to_python()
        assert sheet[0] == list(tidy.COLUMNS)
        back = [(str(r[2]), r[3] if r[3] != "" else None) for r in sheet[1:]]
    assert back == [(row["name"], row["value"]) for row in rows]


def test_without_what_writes_a_workbook_its_extra_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(InputError, match=r"pip install 'hfanalysis\[excel\]'"):
        tidy.write(folder / "x.xlsx", [])
    assert not (folder / "x.xlsx").exists()


def test_another_ending_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"x\.ods: expected a name that ends with \.csv, \.parquet, \.xlsx"):
        tidy.write(folder / "x.ods", [])
