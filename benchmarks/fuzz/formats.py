"""A log written in each format that is read, and what its test.toml says of it."""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from benchmarks.fuzz.table import Log

from hfanalysis.record.formats import FORMATS


def _cell(value: float, decimal: str = ".") -> str:
    return "" if np.isnan(value) else f"{value:.7g}".replace(".", decimal)


def delimited(mark: str = ",", decimal: str = ".", end: str = "\n") -> Callable[[Log], bytes]:
    """Text with a header."""

    def write(log: Log) -> bytes:
        columns = log.columns
        rows = zip(*(numbers for _, numbers in columns), strict=True)
        lines = [mark.join(name for name, _ in columns)]
        lines += [mark.join(_cell(value, decimal) for value in row) for row in rows]
        return (end.join(lines) + end).encode()

    return write


def lvm(log: Log) -> bytes:
    """As LabVIEW writes it, one column of time."""
    names = "\t".join(["X_Value", *(name for name, _ in log.columns[1:]), "Comment"])
    head = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t.",
        "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative", "Date\t2022/04/03", "Time\t12:30:00.000000",
        "***End_of_Header***\t", "", f"Channels\t{len(log.channels)}", "Samples\t" + "1\t" * len(log.channels),
        "Date\t" + "2022/04/03\t" * len(log.channels), "Time\t" + "12:30:00.000000\t" * len(log.channels),
        "X0\t" + "0.0\t" * len(log.channels), "Delta_X\t" + "0.02\t" * len(log.channels), "***End_of_Header***\t",
        names,
    ]  # fmt: skip
    rows = zip(*(numbers for _, numbers in log.columns), strict=True)
    return ("\r\n".join([*head, *("\t".join(map(_cell, row)) for row in rows)]) + "\r\n").encode()


def mat5(log: Log) -> bytes:
    """As MATLAB saves it."""
    from scipy.io import savemat

    file = io.BytesIO()
    named = {name or f"unnamed_{i}": values for i, (name, values) in enumerate(log.columns)}  # the format has no others
    savemat(file, named, oned_as="column")
    return file.getvalue()


def mat73(log: Log) -> bytes:
    """As MATLAB saves it with -v7.3."""
    with tempfile.TemporaryDirectory() as folder:
        whole = _hdf5(Path(folder) / "x.mat", log, 512)
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + whole[512:]


def hdf5(log: Log) -> bytes:
    """A data set per column."""
    with tempfile.TemporaryDirectory() as folder:
        return _hdf5(Path(folder) / "x.h5", log, 0)


def _hdf5(path: Path, log: Log, block: int) -> bytes:
    import h5py

    with h5py.File(path, "w", userblock_size=block) as file:
        for name, numbers in log.columns:
            if name not in file:
                file[name.replace("/", "_") or "_"] = numbers[None, :] if block else numbers
    return path.read_bytes()


def tdms(log: Log) -> bytes:
    """One group, the time a channel of it."""
    from nptdms import ChannelObject, TdmsWriter

    file = io.BytesIO()
    with TdmsWriter(file) as writer:
        writer.write_segment([ChannelObject("Data", name or "_", numbers) for name, numbers in log.columns])
    return file.getvalue()


def json_records(log: Log) -> bytes:
    """A list of objects."""
    rows = zip(*(numbers.tolist() for _, numbers in log.columns), strict=True)
    names = [name for name, _ in log.columns]
    return json.dumps([dict(zip(names, row, strict=True)) for row in rows]).encode()


def parquet(log: Log) -> bytes:
    """As pandas writes it."""
    import pandas as pd

    file = io.BytesIO()
    pd.DataFrame(dict(log.columns)).to_parquet(file)
    return file.getvalue()


def xlsx(log: Log) -> bytes:
    """One sheet, with no more in it than a reader needs."""
    names = "".join(f'<c t="inlineStr"><is><t>{escape(name)}</t></is></c>' for name, _ in log.columns)
    rows = zip(*(numbers for _, numbers in log.columns), strict=True)
    cells = ["".join("<c/>" if np.isnan(value) else f"<c><v>{value:.7g}</v></c>" for value in row) for row in rows]
    sheet = "".join(f"<row>{row}</row>" for row in [names, *cells])
    links = f'<Relationships xmlns="{_PACKAGE}/relationships">'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{_PACKAGE}/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        f'<Override PartName="/xl/workbook.xml" ContentType="{_SHEETS}.sheet.main+xml"/>'
        f'<Override PartName="/xl/worksheets/sheet1.xml" ContentType="{_SHEETS}.worksheet+xml"/></Types>',
        "_rels/.rels": links + _relation("officeDocument", "xl/workbook.xml"),
        "xl/_rels/workbook.xml.rels": links + _relation("worksheet", "worksheets/sheet1.xml"),
        "xl/workbook.xml": f'<workbook xmlns="{_MAIN}" xmlns:r="{_OFFICE}/relationships">'
        '<sheets><sheet name="log" sheetId="1" r:id="r1"/></sheets></workbook>',
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{_MAIN}"><sheetData>{sheet}</sheetData></worksheet>',
    }
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(zipfile.ZipInfo(name), '<?xml version="1.0"?>' + content)
    return file.getvalue()


def _relation(kind: str, target: str) -> str:
    return f'<Relationship Id="r1" Type="{_OFFICE}/relationships/{kind}" Target="{target}"/></Relationships>'


_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006"
_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_SHEETS = "application/vnd.openxmlformats-officedocument.spreadsheetml"


WRITERS: dict[str, tuple[str, Callable[[Log], bytes]]] = {
    "csv": (".csv", delimited()),
    "semicolon": (".csv", delimited(";", ",", "\r\n")),
    "tab": (".txt", delimited("\t")),
    "lvm": (".lvm", lvm),
    "mat": (".mat", mat5),
    "mat73": (".mat", mat73),
    "tdms": (".tdms", tdms),
    "hdf5": (".h5", hdf5),
    "json": (".json", json_records),
    "parquet": (".parquet", parquet),
    "xlsx": (".xlsx", xlsx),
}
"""By name: the ending of its files, and what writes them."""

_TEXT = ("csv", "semicolon", "tab", "lvm")
_SUFFIXES = {one.suffix for one in FORMATS.values()}

NAMES = tuple(name for name, (suffix, _) in WRITERS.items() if name in _TEXT or suffix in _SUFFIXES)
"""The formats that are read here."""


def is_text(name: str) -> bool:
    """Whether a format is lines of text."""
    return name in (*_TEXT, "json")


def column(name: str, format: str) -> str:
    """How test.toml names a column."""
    if format == "lvm" and name == "time":
        return "X_Value"
    return f"Data.{name}" if format == "tdms" else name
