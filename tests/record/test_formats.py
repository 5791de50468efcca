"""Logs in MATLAB's, LabVIEW's and National Instruments' formats, made here as those programs write them."""

from __future__ import annotations

import io
from pathlib import Path

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat
from tests.record import make

from hfanalysis.errors import InputError
from hfanalysis.record.log import Flag, TestLog

T = np.arange(300) / 100.0
P = 50.0 + np.random.default_rng(5).normal(scale=0.1, size=T.size)
MASS = np.linspace(8.0, 7.0, 60)
SLOW = 0.5 + np.arange(60) / 20.0


def log_of(name: str, *more: str) -> str:
    return f'[log]\nfiles = ["{name}"]\n' + "".join(f"{line}\n" for line in more)


def table(channel: str, column: str, unit: str, *more: str) -> str:
    return "\n".join([f"[channels.{channel}]", f'column = "{column}"', f'unit = "{unit}"', *more]) + "\n"


def mat(**content: object) -> bytes:
    file = io.BytesIO()
    savemat(file, content, oned_as="column")
    return file.getvalue()


def mat73(path: Path, **content: object) -> bytes:
    """As MATLAB writes it: arrays transposed, 512 bytes in front that say what it is."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            file[name] = np.atleast_2d(np.asarray(value)).T if np.ndim(value) == 2 else np.atleast_2d(value)
        file["remark"] = np.frombuffer("text".encode("utf-16-le"), dtype=np.uint16)[:, None]
        file["remark"].attrs["MATLAB_class"] = np.bytes_(b"char")
    whole = path.read_bytes()
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + whole[512:]


def assert_tank(log: TestLog) -> None:
    np.testing.assert_allclose(log["p_tank"].time, T, atol=1e-9)
    np.testing.assert_allclose(log["p_tank"].values, P * 1e5, rtol=1e-6)


@pytest.mark.parametrize("newer", [False, True])
def test_matlab_arrays_and_structs_go_by_their_names(tmp_path: Path, newer: bool) -> None:
    toml = log_of("t.mat", 'time = { column = "run.time" }') + table("p_tank", "run.tank.PT1", "bar")
    toml += table("m_tank", "run.mass", "kg")
    fields = {"time": T, "tank": {"PT1": P}, "mass": np.arange(300) / 100.0, "note": "cold"}
    if newer:
        flat = {"run/time": T, "run/tank/PT1": P, "run/mass": np.arange(300) / 100.0}
        content = mat73(tmp_path / "x.mat", **flat)
    else:
        content = mat(run=fields, scalar=1.0, remark="text", cells=np.array([1, "a"], dtype=object))
    log = make.read(tmp_path, toml, {"t.mat": content})
    assert_tank(log)
    assert log["m_tank"].values[-1] == pytest.approx(2.99)


@pytest.mark.parametrize("newer", [False, True])
def test_arrays_of_time_and_value_keep_their_own_clocks(tmp_path: Path, newer: bool) -> None:
    toml = log_of("t.mat") + table("p_tank", "PT1", "bar") + table("m_tank", "weight", "kg")
    arrays = {"PT1": np.column_stack([T, P]), "weight": np.column_stack([SLOW, MASS])}
    log = make.read(tmp_path, toml, {"t.mat": mat73(tmp_path / "x.mat", **arrays) if newer else mat(**arrays)})
    assert_tank(log)
    np.testing.assert_allclose(log["m_tank"].time, SLOW)
    np.testing.assert_allclose(log["m_tank"].values, MASS)


def test_a_clock_that_once_steps_back_is_still_a_clock(tmp_path: Path) -> None:
    stamps = T.copy()
    stamps[100] -= 0.08
    toml = log_of("t.mat") + table("p_tank", "PT1", "bar")
    log = make.read(tmp_path, toml, {"t.mat": mat(PT1=np.column_stack([stamps, P]))})
    assert np.flatnonzero(log["p_tank"].flags & Flag.TIME).tolist() == [100]


def test_two_columns_of_readings_are_no_clock(tmp_path: Path) -> None:
    toml = log_of("t.mat", 'time = { column = "t" }') + table("p_tank", "both.2", "bar")
    log = make.read(tmp_path, toml, {"t.mat": mat(t=T, both=np.column_stack([np.sin(9 * T), P]))})
    assert_tank(log)


def test_readings_and_stamps_of_different_length_are_refused(tmp_path: Path) -> None:
    toml = log_of("t.mat", 'time = { column = "t" }') + table("p_tank", "PT1", "bar") + table("m_tank", "m", "kg")
    with pytest.raises(InputError, match=r"'m' \(m_tank\): 60 readings on 300 time stamps"):
        make.read(tmp_path, toml, {"t.mat": mat(t=T, PT1=P, m=MASS)})


def test_a_missing_name_gets_its_near_misses(tmp_path: Path) -> None:
    toml = log_of("t.mat", 'time = { column = "CF1.time" }') + table("p_tank", "CF1.PT2", "bar")
    with pytest.raises(InputError, match=r"CF1\.PT1"):
        make.read(tmp_path, toml, {"t.mat": mat(CF1={"time": T, "PT1": P})})


LVM = """LabVIEW Measurement\t
Separator\tTab
Decimal_Separator\t{mark}
X_Columns\t{columns}
***End_of_Header***\t
\t
Channels\t2\t
Y_Unit_Label\tpsi\tkg
Delta_X\t10.0\t10.0
***End_of_Header***\t
"""


def lvm(columns: str, mark: str = ".") -> str:
    """The table below the header, with time as ``X_Columns`` says."""
    pairs = zip(T, P, np.linspace(8, 7, T.size), strict=True)
    names = {
        "One": "X_Value\tPT\tLC\tComment",
        "Multi": "X_Value\tPT\tX_Value\tLC\tComment",
        "No": "X_Value\tPT\tLC\tt\tComment",
    }
    forms = {
        "One": "{t:.6f}\t{p:.6f}\t{m:.6f}",
        "Multi": "{t:.6f}\t{p:.6f}\t{late:.6f}\t{m:.6f}",
        "No": "\t{p:.6f}\t{m:.6f}\t{t:.6f}",
    }
    rows = [forms[columns].format(t=t, p=p, m=m, late=t + 0.25) for t, p, m in pairs]
    text = LVM.format(mark=mark, columns=columns) + names[columns] + "\n"
    return text + "\n".join(rows).replace(".", mark) + "\n"


@pytest.mark.parametrize("mark", [".", ","])
@pytest.mark.parametrize(("columns", "late"), [("One", 0.0), ("Multi", 0.25)])
def test_labview_says_where_the_time_is(tmp_path: Path, columns: str, late: float, mark: str) -> None:
    toml = log_of("t.lvm") + table("p_tank", "PT", "bar") + table("m_tank", "LC", "kg")
    log = make.read(tmp_path, toml, {"t.lvm": lvm(columns, mark)})
    assert_tank(log)
    np.testing.assert_allclose(log["m_tank"].time, T + late, atol=1e-9)


def test_labview_without_time_takes_the_column_that_is_stated(tmp_path: Path) -> None:
    toml = log_of("t.lvm", 'time = { column = "t" }') + table("p_tank", "PT", "bar")
    assert_tank(make.read(tmp_path, toml, {"t.lvm": lvm("No")}))
    with pytest.raises(InputError, match=r"log\.time: missing"):
        make.read(tmp_path, log_of("t.lvm") + table("p_tank", "PT", "bar"), {"t.lvm": lvm("No")})


def tdms(**properties: object) -> bytes:
    file = io.BytesIO()
    start = np.datetime64("2024-04-06T18:28:28")
    late = properties | ({"wf_start_time": start + np.timedelta64(500, "ms")} if properties else {})
    with TdmsWriter(file) as writer:
        writer.write_segment(
            [
                ChannelObject("Data", "pt", P, properties | ({"wf_start_time": start} if properties else {})),
                ChannelObject("Data", "lc", np.arange(300, dtype=np.int16), late | {"unit_string": "kg"}),
                ChannelObject("Data", "stamps", start + (T * 1e6).astype("m8[us]")),
                ChannelObject("Data", "remarks", ["a", "b"]),
            ]
        )
    return file.getvalue()


def test_a_tdms_waveform_has_its_clock(tmp_path: Path) -> None:
    toml = log_of("t.tdms") + table("p_tank", "Data.pt", "bar") + table("m_tank", "Data.lc", "kg")
    log = make.read(tmp_path, toml, {"t.tdms": tdms(wf_increment=0.01, wf_start_offset=0.0)})
    assert_tank(log)
    np.testing.assert_allclose(log["m_tank"].time, T + 0.5)
    np.testing.assert_allclose(log["m_tank"].values, np.arange(300))


@pytest.mark.parametrize("time", ['{ rate = "100 Hz" }', '{ column = "Data.stamps" }'])
def test_a_tdms_channel_without_clock_takes_the_stated_one(tmp_path: Path, time: str) -> None:
    log = make.read(
        tmp_path, log_of("t.tdms", f"time = {time}") + table("p_tank", "Data.pt", "bar"), {"t.tdms": tdms()}
    )
    np.testing.assert_allclose(np.diff(log["p_tank"].time), 0.01, atol=1e-5)
    np.testing.assert_allclose(log["p_tank"].values, P * 1e5)


WHOLE = {"t.mat": mat(t=T, p=P), "t.tdms": tdms(), "t.lvm": lvm("One").encode()}


@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("share", [0.02, 0.1])
def test_a_file_cut_short_is_refused_in_one_message(tmp_path: Path, name: str, share: float) -> None:
    content = WHOLE[name][: int(share * len(WHOLE[name]))]
    with pytest.raises(InputError, match=name):
        make.read(tmp_path, log_of(name, 'time = { column = "t" }') + table("p_tank", "p", "bar"), {name: content})
