"""What the numbers of a log say: clocks and their units, shapes, sizes, signals that are there twice."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.drafting.columns import MOST, read_log_file
from hfanalysis.drafting.document import document
from hfanalysis.drafting.shapes import shape
from hfanalysis.drafting.survey import Surveyed, survey

TIME = np.arange(0.0, 40.0, 0.02)


def firing(time: Array = TIME) -> Array:
    """Zero, from 10 s on one that fades slowly, gone at 18 s."""
    return np.where((time > 10.0) & (time < 18.0), 1.0 - 0.05 * (time - 10.0), 0.0)


def emptying(time: Array = TIME) -> Array:
    """One until 10 s, zero from 18 s on."""
    return np.clip((18.0 - time) / 8.0, 0.0, 1.0)


def noise(scale: float, size: int = TIME.size, seed: int = 3) -> Array:
    return np.random.default_rng(seed).normal(0.0, scale, size)


def written(folder: Path, **columns: Array) -> Surveyed:
    """A log of these columns, surveyed."""
    path = folder / "log.csv"
    np.savetxt(
        path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="", fmt="%.6g"
    )
    return survey([read_log_file(path)])


@pytest.mark.parametrize(
    ("values", "word"),
    [
        (200.0 * firing() + noise(2.0), "pulse"),
        (200.0 * firing() + 60.0 * (TIME > 18.0) + noise(2.0), "pulse"),
        (-200.0 * firing() + noise(2.0), "dip"),
        (50.0 * emptying() + noise(0.3), "falls"),
        (
            50.0 * np.minimum(np.clip((TIME - 1.0) / 8.0, 0.0, 1.0), np.clip((16.0 - TIME) / 3.0, 0.0, 1.0))
            + noise(0.1),
            "fills",
        ),
        (noise(1.0), "noise"),
        (np.where(TIME > 20.0, 1.0, 0.0), "state"),
        (np.full(TIME.size, 7.0), "constant"),
        (TIME, "clock"),
        (15.0 + 200.0 * np.clip(TIME - 20.0, 0.0, 5.0) + noise(1.0), "rises"),
        (np.full(TIME.size, np.nan), "empty"),
    ],
)
def test_shapes(values: Array, word: str) -> None:
    assert shape(values).word == word


def test_a_wild_sample_hides_no_shape() -> None:
    values = 200.0 * firing() + noise(2.0)
    values[[5, 900]] = 8388607.0, -1e6
    assert shape(values).word == "pulse"


def test_a_burn_of_four_seconds_in_a_log_of_half_an_hour_is_seen() -> None:
    time = np.arange(0.0, 1800.0, 0.05)
    values = np.where((time > 900.0) & (time < 904.0), 300.0, 0.0) + noise(1.0, time.size)
    assert shape(values).word == "pulse"


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("size", [60, 900, 4000, 30_000])
def test_noise_is_noise_in_logs_of_any_length(size: int, seed: int) -> None:
    assert shape(noise(1.0, size, seed)).word == "noise"


@pytest.mark.parametrize(
    ("name", "stamps", "unit"),
    [
        ("time", np.round(1e3 * TIME), "ms"),
        ("t", 1e3 * TIME + 1.7e12, "ms"),
        ("time", TIME + 1.7e9, "s"),
        ("Time (ms)", 1e3 * TIME, "ms"),
        ("time_us", 1e6 * TIME, "us"),
        ("millis", 5.0 * np.arange(TIME.size), "ms"),
        ("timestamp", 45000.25 + TIME / 86400.0, "day"),
        ("seconds", TIME, "s"),
        ("col1", TIME, "s"),  # by its shape alone
    ],
)
def test_clocks_are_found_with_their_unit(name: str, stamps: Array, unit: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    np.savetxt(
        path,
        np.column_stack([firing() + noise(0.01), stamps]),
        delimiter=",",
        header=f"thrust (N),{name}",
        comments="",
        fmt="%.17g",
    )
    found = survey([read_log_file(path)]).stamps["log.csv"]
    assert found.column is not None
    assert (found.column.number, found.unit) == (2, unit)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("time,p\n2024-05-01T12:00:00.001,7\n2024-05-01T12:00:00.002,8\n2024-05-01T12:00:00.003,7\n", "datetime"),
        ("time;p\n01.05.2024 12:00:00,001;7,5\n01.05.2024 12:00:00,002;7,6\n01.05.2024 12:00:00,003;7,6\n", "datetime"),
        ("time;p\n12:03:04,120;50,1\n12:03:04,130;50,2\n12:03:04,140;50,2\n", "clock"),
        ("begun,12:03:04\ntime,p\n0.1,3\n0.2,4\n0.3,4\n", "s"),
    ],
)
def test_stamps_that_are_written_as_dates_or_times_of_day_are_drafted_so(text: str, unit: str, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text(text, encoding="utf-8")
    assert f'column = "time", unit = "{unit}"' in document("T1", survey([read_log_file(log)]))


def test_a_clock_that_stands_for_many_rows_is_spread(tmp_path: Path) -> None:
    found = written(tmp_path, **{"time (s)": np.floor(TIME), "p_c (bar)": 20.0 * firing() + noise(0.1)})
    assert "spread = true" in document("T", found)
    assert found.columns[0].rate == pytest.approx(50.0, rel=0.05)


def test_columns_without_names_are_guessed_by_what_they_do(tmp_path: Path) -> None:
    """Raw volts are told from what was made of them; nothing is taken for a channel."""
    chamber = 14.7 + 300.0 * firing() + noise(0.5, seed=1)
    line = 14.7 + 500.0 * firing() + noise(0.5, seed=2)
    found = written(
        tmp_path, time=TIME, c1=0.8 + 0.002 * chamber, c2=chamber, c3=line,
        c4=14.7 + 700.0 * emptying() + noise(0.5, seed=4), c5=7.0 * emptying() + noise(0.02, seed=5),
        c6=2500.0 * firing() + noise(3.0, seed=6), c7=noise(1.0, seed=7),
    )  # fmt: skip
    best = {one.column.label: one.best.channel if one.best else None for one in found.columns}
    assert best == {
        "c1": None,
        "c2": "p_chamber",
        "c3": "p_run",
        "c4": "p_tank",
        "c5": "m_tank",
        "c6": "thrust",
        "c7": None,
    }
    assert "raw volts" in found.columns[0].remark
    assert [one.best.unit for one in found.columns[1:4] if one.best] == ["psi", "psi", "psi"]
    assert not found.chosen


def test_a_chamber_that_rests_at_zero_is_drafted_as_a_gauge_pressure(tmp_path: Path) -> None:
    names = {"chamber (psi)": 300.0 * firing() + noise(0.5), "tank (psi)": 700.0 * emptying() + noise(0.5, seed=4)}
    text = document("T", written(tmp_path, **{"time (s)": TIME}, **names))
    chamber, _, tank = text.partition("[channels.p_tank]")
    assert "gauge = true   #" in chamber.partition("[channels.p_chamber]")[2]
    assert not tank.splitlines()[3].startswith("gauge")


def test_readings_that_stand_for_none_are_named(tmp_path: Path) -> None:
    tank = 48.0 * emptying() + noise(0.1, seed=4)
    tank[[7, 900, 1200]] = -10.0
    text = document("T", written(tmp_path, **{"time (s)": TIME, "tank (bar)": tank, "chamber (bar)": 20.0 * firing()}))
    assert re.findall(r"# missing = .*", text) == [
        "# missing = [-10.0]   # 3 readings of exactly that, far from all others"
    ]


def test_a_long_log_is_thinned_and_its_extremes_are_kept(tmp_path: Path) -> None:
    size = 3 * MOST
    values = np.zeros(size)
    values[71_111] = 99.0
    np.savetxt(
        tmp_path / "log.csv",
        np.column_stack([0.001 * np.arange(size), values]),
        delimiter=",",
        header="t (s),x",
        comments="",
        fmt="%.6g",
    )
    file = read_log_file(tmp_path / "log.csv")
    assert (file.columns[1].samples, file.columns[1].largest) == (size, 99.0)
    assert file.columns[1].values.size <= MOST
    assert survey([file]).columns[0].rate == pytest.approx(1000.0)


def test_a_unit_that_is_not_stated_is_that_of_the_others_gauge_or_absolute(tmp_path: Path) -> None:
    """A chamber that may be in bar or psi by its size, beside a tank in barg."""
    names = {"CHAMBER": 40.0 * firing() + noise(0.1), "tank (barg)": 48.0 * emptying() + noise(0.1, seed=4)}
    best = written(tmp_path, **{"time (s)": TIME}, **names).columns[0].best
    assert best is not None
    assert (best.channel, best.unit, best.gauge) == ("p_chamber", "bar", True)
