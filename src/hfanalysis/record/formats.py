"""The formats of logs: how each is recognized, and the module that reads it. A format more is a row here and a file."""

from __future__ import annotations

from typing import NamedTuple


class Format(NamedTuple):
    """``reader``: module of ``record.readers`` with ``open_source(path, spec) -> Source``, loaded when it is met.

    ``name`` is how people call it in a message, ``suffix`` that of its files, ``beginnings`` their first bytes, or
    ``pattern`` what their beginning looks like; ``text``: it is written in characters.
    """

    reader: str
    name: str
    suffix: str = ""
    beginnings: tuple[bytes, ...] = ()
    pattern: bytes = b""
    text: bool = False


TEXT = "csv"
"""What a log is taken for that nothing else recognizes."""

FORMATS: dict[str, Format] = {
    TEXT: Format("delimited", "delimited text", text=True),
    "mat": Format("matlab", ".mat", ".mat", (b"MATLAB 5.0", b"MATLAB 7.3")),
    "octave": Format("octave", "Octave text", pattern=rb"# Created by Octave|# name: ", text=True),
    "lvm": Format("labview", ".lvm", "", (b"LabVIEW Measurement",), text=True),
    "tdms": Format("tdms", ".tdms", ".tdms", (b"TDSm",)),
    "excel": Format("excel", ".xlsx", ".xlsx", (b"\xd0\xcf\x11\xe0", b"PK\x03\x04")),
    "hdf5": Format("hdf5", "HDF5", ".h5", (b"\x89HDF\r\n\x1a\n",)),
    "netcdf": Format("hdf5", "NetCDF", ".nc", (b"CDF\x01", b"CDF\x02", b"CDF\x05")),
    "parquet": Format("columnar", "Parquet", ".parquet", (b"PAR1",)),
    "arrow": Format("columnar", "Arrow", ".feather", (b"ARROW1",)),
    "json": Format("json_text", "JSON", ".json", pattern=rb"\[\s*[\[{]|\{\s*\"|\[\s*-?[\d.]+\s*,", text=True),
    "eng": Format("eng", "a RASP engine file", ".eng", text=True),
}
"""By the word that ``[log] format`` takes."""

AS_CSV = "expected the log itself, exported as CSV"

NO_LOGS: dict[bytes, str] = {
    b"version https://git-lfs": "a Git-LFS pointer in place of the file; expected the file (git lfs pull)",
    b"<!doctype html": "an HTML page in place of a log (a page that should have been a download?); expected the log",
    b"<html": "an HTML page in place of a log (a page that should have been a download?); expected the log",
    b"<?xml": f"XML; {AS_CSV}",
    b"\x89PNG": f"a picture; {AS_CSV}",
    b"\xff\xd8\xff": f"a picture; {AS_CSV}",
    b"GIF8": f"a picture; {AS_CSV}",
    b"RIFF": f"a sound or a video; {AS_CSV}",
    b"%PDF": f"PDF; {AS_CSV}",
    b"{\\rtf": f"a text document (RTF); {AS_CSV}",
    b"\x1f\x8b": "gzip; expected the log unpacked",
    b"BZh": "bzip2; expected the log unpacked",
    b"\xfd7zXZ": "xz; expected the log unpacked",
    b"7z\xbc\xaf": "a 7z archive; expected the log unpacked",
    b"Rar!": "a RAR archive; expected the log unpacked",
    b"MDF     ": "an MDF file of ASAM; expected it exported as CSV or .mat",
    b"UnFinMF ": "an unfinished MDF file of ASAM; expected it exported as CSV or .mat",
    b"SQLite format 3": "an SQLite database; expected its table exported as CSV",
    b"TDSh": "the index of a .tdms file; expected the .tdms file of the same name",
    b"DATAMAXP": "a file of a data logger of its own format; expected it exported as CSV",
}
"""Beginnings of files that are no log, and what is said of them."""

NO_LOGS_BY_SUFFIX: dict[str, str] = {
    ".wdq": "a WinDaq file; expected it exported as CSV by the WinDaq browser",
    ".wdh": "a WinDaq file; expected it exported as CSV by the WinDaq browser",
    ".tdms_index": "the index of a .tdms file; expected the .tdms file of the same name",
    ".mf4": "an MDF file of ASAM; expected it exported as CSV or .mat",
    ".dxd": "a Dewesoft file; expected it exported as CSV or .mat",
    ".d7d": "a Dewesoft file; expected it exported as CSV or .mat",
}
"""The same by the ends of their names, where their bytes are of no known format."""


def names() -> str:
    """The formats in words."""
    *first, last = (one.name for one in FORMATS.values())
    return f"{', '.join(first)} or {last}"
