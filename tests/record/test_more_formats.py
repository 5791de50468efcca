"""Spreadsheets, HDF5, NetCDF, Parquet, JSON, engine files; resumed files of LabVIEW; and what is no log."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest
from nptdms import ChannelObject, TdmsWriter
from pyarrow import feather, parquet
from scipy.io import netcdf_file
from tests.record import make
from tests.record.test_formats import MASS, SLOW, P, T, assert_tank, log_of, mat, table

from hfanalysis.errors import InputError
from hfanalysis.record.formats import NO_LOGS

TANK = table("p_tank", "PT", "bar")
START = np.datetime64("2024-05-01T23:59:58", "us")


def bytes_of(write: Callable[[io.BytesIO], None]) -> bytes:
    file = io.BytesIO()
    write(file)
    return file.getvalue()


def hdf5(**content: object) -> bytes:
    def write(file: io.BytesIO) -> None:
        with h5py.File(file, "w") as into:
            for name, value in content.items():
                into[name] = value

    return bytes_of(write)


def netcdf(units: str) -> bytes:
    file = io.BytesIO()
    into = netcdf_file(file, "w")
    into.createDimension("time", T.size)
    for name, values, unit in (("t", T, units), ("PT", P, "bar")):
        variable = into.createVariable(name, "d", ("time",))
        variable[:], variable.units = values, unit
    into.flush()
    return file.getvalue()


def columnar(write: Callable[[pa.Table, io.BytesIO], None], t: object = T) -> bytes:
    return bytes_of(lambda file: write(pa.table({"t": t, "PT": P, "mode": ["run"] * T.size}), file))


def xlsx(rows: list[list[object]], sheets: int = 1) -> bytes:
    """A workbook as spreadsheets write it, each sheet with these rows."""

    def cell(value: object) -> str:
        if isinstance(value, str):
            return f'<c t="inlineStr"><is><t>{value}</t></is></c>'
        return "<c/>" if value is None else f"<c><v>{value!r}</v></c>"

    body = "".join(f"<row>{''.join(map(cell, row))}</row>" for row in rows)
    names = [f"S{i}" for i in range(1, sheets + 1)]
    space = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    listed = "".join(f'<sheet name="{n}" sheetId="{i}" r:id="r{i}"/>' for i, n in enumerate(names, start=1))
    links = "".join(
        f'<Relationship Id="r{i}" Type="{office}/worksheet" Target="worksheets/{n}.xml"/>'
        for i, n in enumerate(names, start=1)
    )
    parts = {
        "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>',
        "_rels/.rels": f'<Relationships xmlns="{package}"><Relationship Id="r" Type="{office}/officeDocument" '
        'Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook {space} xmlns:r="{office}"><sheets>{listed}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}">{links}</Relationships>',
    }
    parts |= {f"xl/worksheets/{n}.xml": f"<worksheet {space}><sheetData>{body}</sheetData></worksheet>" for n in names}

    def write(file: io.BytesIO) -> None:
        with zipfile.ZipFile(file, "w") as archive:
            for name, content in parts.items():
                archive.writestr(name, content)

    return bytes_of(write)


PAIRS = np.column_stack([T, P]).tolist()
RECORDS = [{"t": t, "PT": p, "mode": "run"} for t, p in PAIRS]
FILES: dict[str, str | bytes] = {
    "one_line.json": json.dumps(RECORDS),
    "indented.json": json.dumps(RECORDS, indent=1),
    "nested.json": json.dumps({"test": "T", "data": [{"t": t, "tank": {"PT": p}} for t, p in PAIRS]}),
    "lines.csv": "\n".join(map(json.dumps, RECORDS)) + '\n{"t": 3.0, "PT"',
    "arrays.json": json.dumps({"t": T.tolist(), "PT": P.tolist(), "note": "cold"}),
    "rows.json": json.dumps([["t", "PT"], *PAIRS]),
    "hdf5.dat": hdf5(t=T, **{"stand/PT": P, "stand/picture": np.zeros((3, 3, 3))}),
    "compound.h5": hdf5(log=np.rec.fromarrays([T, P], names="t,PT")),
    "classic.nc": netcdf("s"),
    "log.parquet": columnar(parquet.write_table),
    "log.feather": columnar(feather.write_feather),
    "log.xlsx": xlsx([["Stand 1"], ["t", "PT"], ["s", "bar"], *PAIRS]),
    "two.xlsx": xlsx([["t", "PT"], *PAIRS], sheets=2),
    "octave.mat": "# Created by Octave 6.4.0\n"
    + "".join(
        f"# name: {name}\n# type: matrix\n# rows: {T.size}\n# columns: 1\n" + "".join(f" {x!r}\n" for x in v.tolist())
        for name, v in (("t", T), ("PT", P))
    ),
    "structs.mat": mat(ch=np.rec.fromarrays([T, P], names="t,PT")),
    "channels.mat": mat(ch=np.array([("PT", T, P), ("LC", T, 2.0 * P)], dtype=[("name", "O"), ("t", "O"), ("y", "O")])),
    "cells.mat": mat(t=T, data=np.array([["PT", "LC"], *[[p, 1.0] for p in P]], dtype=object)),
    "wide.mat": mat(t=T[None, :], PT=P[None, :]),
}


@pytest.mark.parametrize("name", FILES)
def test_a_log_is_read_whatever_its_format(tmp_path: Path, name: str) -> None:
    two = name == "two.xlsx"
    toml = log_of(name, f'time = {{ column = "{"S1.t" if two else "t"}" }}') + table("p_tank", "PT", "bar")
    assert_tank(make.read(tmp_path, toml.replace('"PT"', '"S1.PT"') if two else toml, {name: FILES[name]}))


def test_the_longer_axis_of_a_matrix_is_time(tmp_path: Path) -> None:
    toml = log_of("t.mat", 'time = { column = "M.1" }') + table("p_tank", "M.2", "bar")
    assert_tank(make.read(tmp_path, toml, {"t.mat": mat(M=np.vstack([T, P, P]))}))


@pytest.mark.parametrize("kind", ["parquet", "netcdf", "json", "hdf5 text"])
def test_dates_of_a_format_are_instants(tmp_path: Path, kind: str) -> None:
    stamps = START + np.round(T * 1e6).astype("m8[us]")
    words = [str(stamp) for stamp in stamps]
    content = {
        "parquet": lambda: columnar(parquet.write_table, pa.array(stamps)),
        "netcdf": lambda: netcdf("seconds since 2024-05-01 23:59:58"),
        "json": lambda: json.dumps([{"t": word, "PT": p} for word, p in zip(words, P.tolist(), strict=True)]),
        "hdf5 text": lambda: hdf5(t=np.array(words, dtype="S26"), PT=P),
    }[kind]()
    log = make.read(tmp_path, log_of("log.dat", 'time = "t"') + TANK, {"log.dat": content})
    np.testing.assert_allclose(log["p_tank"].time, 86398.0 + T, atol=2e-6)


def test_an_engine_file_is_a_thrust_curve(tmp_path: Path) -> None:
    text = "; made by hand\nE1 75 400 0 1.2 2.5 US\n0.0 10.0\n0.5 800.0\n1.0 700.0\n2.0 0.0\n"
    log = make.read(tmp_path, log_of("a.eng") + table("thrust", "thrust", "N"), {"a.eng": text})
    np.testing.assert_allclose(log["thrust"].time, [0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(log["thrust"].values, [10.0, 800.0, 700.0, 0.0])


def resumed(times: list[int], property_again: bool = True) -> bytes:
    """A .tdms written on in several sessions of 100 readings, each begun so many seconds after the first."""
    file = io.BytesIO()
    for i, later in enumerate(times):
        about = {"wf_increment": 0.01, "wf_start_offset": 0.0, "wf_start_time": START + np.timedelta64(later, "s")}
        stated = about if property_again or not i else {}
        with TdmsWriter(file) as writer:
            writer.write_segment(
                [
                    ChannelObject("G", "PT", P[100 * i : 100 * i + 100], stated),
                    ChannelObject("G", "LC", P[100 * i : 100 * i + 100].astype(np.int16), stated),
                ]
            )
    return file.getvalue()


@pytest.mark.parametrize("times", [[0, 61, 200], [0, 1, 2]])
def test_a_resumed_tdms_keeps_its_gaps(tmp_path: Path, times: list[int]) -> None:
    log = make.read(tmp_path, log_of("t.tdms") + table("p_tank", "G.PT", "bar"), {"t.tdms": resumed(times)})
    expected = np.concatenate([later + 0.01 * np.arange(100) for later in times])
    np.testing.assert_allclose(log["p_tank"].time, expected, atol=1e-9)


def test_a_tdms_that_goes_on_in_one_waveform_has_no_gap(tmp_path: Path) -> None:
    content = resumed([0, 61, 200], property_again=False)
    assert_tank(make.read(tmp_path, log_of("t.tdms") + table("p_tank", "G.PT", "bar"), {"t.tdms": content}))


@pytest.mark.parametrize("cut", [1, 700, 1500])
def test_an_interrupted_tdms_gives_what_is_whole(tmp_path: Path, cut: int) -> None:
    content = resumed([0, 61, 200])
    log = make.read(tmp_path, log_of("t.tdms") + table("p_tank", "G.PT", "bar"), {"t.tdms": content[:-cut]})
    kept = log["p_tank"].values
    assert len(kept) >= 200
    np.testing.assert_allclose(kept, 1e5 * P[: len(kept)])
    np.testing.assert_allclose(log["p_tank"].time[:200], [*T[:100], *(61.0 + T[:100])], atol=1e-9)


def lvm(parts: list[tuple[float, int, int]]) -> str:
    """Segments of rows from ``a`` to ``b``, each begun so many seconds after the first, with time from zero."""
    text = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\tOne\n"
    text += "Date\t2024/05/01\nTime\t10:00:00.0\n***End_of_Header***\t\n\t\n"
    for later, a, b in parts:
        stamp = f"10:{int(later) // 60:02d}:{later % 60:09.6f}"
        text += f"Channels\t2\t\nSamples\t{b - a}\t{b - a}\nDate\t2024/05/01\t2024/05/01\nTime\t{stamp}\t{stamp}\n"
        text += "Y_Unit_Label\tbar\tkg\nX0\t0.0\t0.0\nDelta_X\t0.01\t0.01\n***End_of_Header***\t\n"
        text += "X_Value\tPT\tLC\tComment\n"
        text += "".join(f"{t - T[a]:.6f}\t{p:.6f}\t{p:.3f}\n" for t, p in zip(T[a:b], P[a:b], strict=True))
        text += "\n"
    return text


@pytest.mark.parametrize("gap", [0.0, 75.5])
def test_each_segment_of_labview_has_its_own_beginning(tmp_path: Path, gap: float) -> None:
    parts = [(0.0, 0, 100), (1.0 + gap, 100, 130), (1.3 + 2 * gap, 130, 300)]
    log = make.read(tmp_path, log_of("t.lvm") + TANK, {"t.lvm": lvm(parts)})
    expected = T + gap * (np.arange(300) >= 100) + gap * (np.arange(300) >= 130)
    np.testing.assert_allclose(log["p_tank"].time - 36000.0, expected, atol=1e-5)
    np.testing.assert_allclose(log["p_tank"].values, 1e5 * P, rtol=1e-6)


def test_a_labview_file_without_its_header_is_text(tmp_path: Path) -> None:
    text = "".join(f"{t:.6f}\t{p:.9f}\n" for t, p in PAIRS)
    toml = '[log]\nfiles = ["t.lvm"]\ntime = 1\n[channels.p_tank]\ncolumn = 2\nunit = "bar"\n'
    assert_tank(make.read(tmp_path, toml, {"t.lvm": text}))


@pytest.mark.parametrize("beginning", NO_LOGS)
def test_what_is_no_log_is_named(tmp_path: Path, beginning: bytes) -> None:
    with pytest.raises(InputError, match=r"log.csv: found .*expected"):
        make.read(tmp_path, make.LOG + TANK, {"log.csv": beginning + b" and more\n1,2\n3,4\n"})


@pytest.mark.parametrize(
    ("name", "content", "what"),
    [
        ("a.wdq", np.arange(4000, dtype=np.uint16).tobytes(), "WinDaq"),
        ("a.bin", np.random.default_rng(1).integers(0, 255, 9000, dtype=np.uint8).tobytes(), "not known here"),
        ("a.zip", bytes_of(lambda file: zipfile.ZipFile(file, "w").writestr("log.csv", "1,2")), "zip archive"),
        ("a.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\x07" * 4000, "spreadsheet"),
        ("a.parquet", b"PAR1" + b"\x07" * 4000, "Parquet"),
        ("a.h5", b"\x89HDF\r\n\x1a\n" + b"\x07" * 4000, "HDF5"),
        ("a.json", '[{"t": 0, "PT": 1', "JSON"),
        ("a.json", "[" * 100000, "JSON|nested"),
    ],
)
def test_a_damaged_or_foreign_file_is_refused_in_one_message(
    tmp_path: Path, name: str, content: str | bytes, what: str
) -> None:
    with pytest.raises(InputError, match=what):
        make.read(tmp_path, log_of(name, 'time = "t"') + TANK, {name: content})


def test_matlabs_own_classes_are_refused_by_name(tmp_path: Path) -> None:
    def write(file: io.BytesIO) -> None:
        with h5py.File(file, "w", userblock_size=512) as into:
            into["T"] = np.zeros((1, 6), dtype=np.uint32)
            into["T"].attrs["MATLAB_class"], into["T"].attrs["MATLAB_object_decode"] = np.bytes_(b"table"), 3

    whole = bytes_of(write)
    content = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + whole[512:]
    with pytest.raises(InputError, match="variable 'T' is of MATLAB's own class table"):
        make.read(tmp_path, log_of("t.mat", 'time = "t"') + TANK, {"t.mat": content})


def test_one_file_per_sensor(tmp_path: Path) -> None:
    files: dict[str, str | bytes] = {
        "pt.csv": make.csv(t=T, PT=P),
        "lc.json": json.dumps([{"t": t, "kg": m} for t, m in zip(SLOW.tolist(), MASS.tolist(), strict=True)]),
    }
    toml = '[log]\nfiles = ["pt.csv", "lc.json"]\ntime = "t"\n' + TANK + table("m_tank", "kg", "kg")
    log = make.read(tmp_path, toml, files)
    np.testing.assert_allclose(log["p_tank"].values, 1e5 * P, rtol=1e-5)
    np.testing.assert_allclose(log["m_tank"].time, SLOW)
    np.testing.assert_allclose(log["m_tank"].values, MASS)
