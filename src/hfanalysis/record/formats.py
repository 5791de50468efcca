"""The formats of logs: how each is recognized, and the module that reads it. A format more is a row here and a file."""

from __future__ import annotations

from typing import NamedTuple


class Format(NamedTuple):
    """``reader``: module of ``record.readers`` with ``open_source(path, spec) -> Source``, loaded when it is met.

    ``name`` is how people call it in a message, ``suffix`` that of its files, ``beginnings`` their first bytes.
    """

    reader: str
    name: str
    suffix: str = ""
    beginnings: tuple[bytes, ...] = ()


TEXT = "csv"
"""What a log is taken for that nothing else recognizes."""

FORMATS: dict[str, Format] = {
    TEXT: Format("delimited", "delimited text"),
    "mat": Format("matlab", ".mat", ".mat", (b"MATLAB 5.0", b"MATLAB 7.3")),
    "lvm": Format("labview", ".lvm", ".lvm", (b"LabVIEW Measurement",)),
    "tdms": Format("tdms", ".tdms", ".tdms", (b"TDSm",)),
}
"""By the word that ``[log] format`` takes."""

NO_LOGS = {b"\x89HDF\r\n": "HDF5", b"PK\x03\x04": "a zip archive or spreadsheet", b"\x1f\x8b": "gzip", b"%PDF": "PDF"}
"""Beginnings of files that are no log."""


def names() -> str:
    """The formats in words."""
    *first, last = (one.name for one in FORMATS.values())
    return f"{', '.join(first)} or {last}"
