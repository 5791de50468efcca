"""Logs in which readers once went wrong: the unspoilt numbers come out, or one message names the cause."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log

FAULTS = Path(__file__).parents[3] / "shared" / "faults" / "files"
UNSPOILT = FAULTS / "K03_last_line_without_newline" / "ctrl_z" / "raw_tests" / "T" / "log.csv"
PSI, LBF = 6894.757293168, 4.4482216152605
CHANNELS = {"p_tank": PSI, "p_run": PSI, "p_chamber": PSI, "p_purge": PSI, "thrust": LBF, "m_tank": 1.0}
READ = {
    "K02": None,
    "K03": None,
    "K04": None,
    "K05": None,
    "K06": None,
    "K14": None,
    "K15": ("mat_matrix_T", "mat_structarray", "octave_text", "tdms_append_gap", "tdms_stringtime"),
    "K17": None,
}
"""Kinds of which all cases are read, or these."""
REFUSED = {
    "K1_counter_col_nameless": "which names which column cannot be told",
    "K1_two_short": "which names which column cannot be told",
    "iso_comma_ms_incsv": "which names which column cannot be told",
    "r_rownames": "which names which column cannot be told",
    "r_rownames_quoted_ws": "which names which column cannot be told",
    "jsonl": "column 'time' not in log.csv; it has 't', 'PT'",
    "mat_cells": "it has 'time', 'data.1'",
    "mdf4": "MDF",
    "parquet": "cannot be read as a Parquet",
    "sqlite": "SQLite",
    "tdms_index": "index of a .tdms",
    "windaq": "WinDaq",
    "xls_old": "cannot be read as a spreadsheet",
}
SCALED = ("K2_crossing_1000",)
"""Cases whose tank pressure is another's on purpose."""
pytestmark = pytest.mark.skipif(not UNSPOILT.exists(), reason="needs ../shared/faults beside the repository")


def cases(kinds: dict[str, tuple[str, ...] | None]) -> list[str]:
    folders = sorted(path for kind in kinds for path in FAULTS.glob(f"{kind}_*/*") if path.is_dir())
    return [str(p.relative_to(FAULTS)) for p in folders if p.name in (kinds[p.parent.name[:3]] or (p.name,))]


def read(case: str, folder: Path) -> TestLog:
    ingest(load_definition(FAULTS / case / "raw_tests" / "T" / "test.toml"), folder / "ingest.h5")
    return read_log(folder / "ingest.h5")


def table() -> Array:
    """Time [s] and the columns, as logged, (1200, 7)."""
    return np.genfromtxt(UNSPOILT, delimiter=",", skip_header=1, max_rows=1200)


@pytest.mark.parametrize("case", cases(READ) or ["none"])
def test_the_unspoilt_numbers_come_out(case: str, tmp_path: Path) -> None:
    log, right = read(case, tmp_path), table()
    for column, (name, unit) in enumerate(CHANNELS.items(), start=1):
        if name not in log.channels:
            continue
        channel = log[name]
        found = (channel.raw if channel.raw is not None else channel.values)[-1200:] / unit
        both = np.isfinite(found) & np.isfinite(right[:, column])
        assert np.isfinite(right[:, column]).sum() - both.sum() <= 1
        if not (case.endswith(SCALED) and name == "p_tank"):
            np.testing.assert_allclose(found[both], right[both, column], atol=0.6)
        time = channel.time[-1200:] - channel.time[-1]
        gap = 60.0 * (np.arange(1200) < 150) * case.endswith("tdms_append_gap")
        np.testing.assert_allclose(time, right[:, 0] - right[-1, 0] - gap, atol=0.021)


@pytest.mark.parametrize("case", [case for case in cases(dict.fromkeys(("K01", "K15"))) if Path(case).name in REFUSED])
def test_what_cannot_be_told_is_named(case: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=REFUSED[Path(case).name]):
        read(case, tmp_path)


@pytest.mark.parametrize(("blank", "channel"), [("cells", "p_run"), ("purge", "p_purge")])
def test_blank_cells_are_no_readings(blank: str, channel: str, tmp_path: Path) -> None:
    log = read(f"K01_header_shorter_than_data/K1_fixedwidth_blank_{blank}", tmp_path)
    assert 790 < np.isfinite(log[channel].values).sum() < 800
    np.testing.assert_allclose(np.nanmax(log["m_tank"].values), np.nanmax(table()[:, 6]), atol=1e-3)
