"""A first test.toml from what a log shows: right where the header says so, open where it does not."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hfanalysis.errors import InputError
from hfanalysis.record.definition import load_definition
from hfanalysis.record.draft import LogColumn, draft, guess_channel, new_test, read_columns

LOG = Path(__file__).parents[2] / "raw_tests" / "HF5" / "log.csv"


def test_a_draft_is_a_valid_definition(tmp_path: Path) -> None:
    definition = load_definition(new_test(tmp_path, "HF9", LOG))
    assert set(definition.channels) == {"p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank"}
    assert definition.channels["p_tank"].unit == "psia"
    assert definition.log.time is not None
    assert definition.log.time.column == "Time (s)"


def test_the_log_is_copied_beside_it_unchanged(tmp_path: Path) -> None:
    new_test(tmp_path, "HF9", LOG)
    assert (tmp_path / "raw_tests/HF9/log.csv").read_bytes() == LOG.read_bytes()


def test_a_log_already_in_its_place_stays_there(tmp_path: Path) -> None:
    folder = tmp_path / "raw_tests" / "HF9"
    folder.mkdir(parents=True)
    shutil.copy(LOG, folder)
    before = (folder / "log.csv").stat()
    new_test(tmp_path, "HF9", folder / "log.csv")
    assert (folder / "log.csv").stat().st_mtime_ns == before.st_mtime_ns


def test_nothing_is_ever_overwritten(tmp_path: Path) -> None:
    path = new_test(tmp_path, "HF9", LOG)
    path.write_text("mine")
    with pytest.raises(InputError, match="never overwritten"):
        new_test(tmp_path, "HF9", LOG)
    assert path.read_text() == "mine"
    (tmp_path / "raw_tests/HF8").mkdir()
    (tmp_path / "raw_tests/HF8/log.csv").write_text("another log")
    with pytest.raises(InputError, match="never overwritten"):
        new_test(tmp_path, "HF8", LOG)


@pytest.mark.parametrize("name", ["../x", "a/b", "", ".", "..", "a b", "-x"])
def test_a_name_must_be_a_folder_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="cannot name a test"):
        new_test(tmp_path, name, LOG)
    assert list(tmp_path.iterdir()) == []


def test_an_empty_log_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(InputError, match="empty"):
        new_test(tmp_path, "HF9", tmp_path / "empty.csv")
    assert not (tmp_path / "raw_tests").exists()


@pytest.mark.parametrize(
    ("name", "unit", "channel"),
    [
        ("PT-TANK", "psia", "p_tank"),
        ("P_oxtank", "bar", "p_tank"),
        ("PT-CC", "psi", "p_chamber"),
        ("Pc", "bar", "p_chamber"),
        ("chamber pressure", "bar", "p_chamber"),
        ("chamber pressure", "", None),
        ("PT-N2", "psi", "p_purge"),
        ("LC-THRUST", "lbf", "thrust"),
        ("Thrust", "psi", None),
        ("LC-TANK", "kg", "m_tank"),
        ("TC-TANK", "degC", "T_tank"),
        ("TC-TANK", "lbf", None),
        ("Mode", "", None),
    ],
)
def test_a_guess_needs_name_and_unit_to_agree(name: str, unit: str, channel: str | None) -> None:
    assert guess_channel(LogColumn(name, name, unit)) == channel


def test_a_log_without_names_or_units_leaves_everything_open(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("seconds,col1,PT-TANK\n0,1,2\n1,2,3\n2,3,4\n")
    text = draft("X", log)
    assert 'time = { column = "seconds", unit = "s" }   # unit not stated in the log: check' in text
    assert '# column = "col1"' in text
    assert "# [channels.p_tank]" in text


def test_hostile_names_stay_text(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text('time,"PT-TANK ""]\\ (psia)"\n0,1\n1,2\n2,3\n')
    definition = load_definition(new_test(tmp_path, "X", log))
    assert definition.channels["p_tank"].column == 'PT-TANK "]\\ (psia)'


@pytest.mark.parametrize(
    ("label", "name", "unit"),
    [
        ("tank psig", "tank", "psig"),
        ("thrust_lbf", "thrust", "lbf"),
        ("T_tank_K", "T_tank", "K"),
        ("Zeit s", "Zeit", "s"),
        ("p_c", "p_c", ""),
        ("mass_flow", "mass_flow", ""),
        ("PT-RUN", "PT-RUN", ""),
    ],
)
def test_a_name_may_end_in_its_unit_without_brackets(label: str, name: str, unit: str, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text(f"time,{label}\n0.0,1.0\n0.1,2.0\n", encoding="utf-8")
    found = read_columns(log)[1]
    assert (found.name, found.unit) == (name, unit)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("time,p\n2024-05-01T12:00:00.001,7\n2024-05-01T12:00:00.002,7\n", "datetime"),
        ("time;p\n01.05.2024 12:00:00,001;7,5\n01.05.2024 12:00:00,002;7,5\n", "datetime"),
        ("time;p\n12:03:04,120;50,1\n12:03:04,130;50,2\n", "clock"),
        ("begun,12:03:04\ntime,p\n0.1,3\n0.2,4\n", "s"),
    ],
)
def test_stamps_that_are_written_as_dates_or_times_of_day_are_drafted_so(text: str, unit: str, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text(text, encoding="utf-8")
    assert f'column = "time", unit = "{unit}"' in draft("T1", log)
