"""One reader per log format behind one :func:`open_log`."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.base import Chunk, Progress, Source, Text, find_column

__all__ = ["READERS", "Chunk", "Progress", "Source", "Text", "find_column", "open_log"]

READERS: dict[str, str] = {
    "csv": "hfanalysis.record.readers.delimited",
    "lvm": "hfanalysis.record.readers.labview",
    "mat": "hfanalysis.record.readers.matlab",
    "tdms": "hfanalysis.record.readers.tdms",
}
"""Format -> module with ``open_source(path, spec) -> Source``; loaded when a log of that format is met."""

_SUFFIXES = {".mat": "mat", ".lvm": "lvm", ".tdms": "tdms"}
_BEGINNINGS = {b"MATLAB 5.0": "mat", b"MATLAB 7.3": "mat", b"LabVIEW Measurement": "lvm", b"TDSm": "tdms"}
_NO_TEXT = {b"\x89HDF\r\n": "HDF5", b"PK\x03\x04": "a zip archive or spreadsheet", b"\x1f\x8b": "gzip", b"%PDF": "PDF"}


def open_log(path: Path, spec: FileSpec) -> Source:
    """The log file opened by the reader of its format (as forced, else by content, else by suffix).

    Raises :class:`InputError` where the file is empty or of a format nobody here reads.
    """
    with path.open("rb") as file:
        head = file.read(64)
    if not head.strip(b"\0\r\n\t ,;"):
        raise InputError(f"{path}: found an empty file; expected a log")
    name = spec.format or _detect(path, head)
    if name not in READERS:
        raise InputError(f"{path}: format {name!r} cannot be read here; expected one of {', '.join(READERS)}")
    open_source: Callable[[Path, FileSpec], Source] = import_module(READERS[name]).open_source
    return open_source(path, spec)


def _detect(path: Path, head: bytes) -> str:
    for beginning, name in _BEGINNINGS.items():
        if head.startswith(beginning):
            return name
    for beginning, name in _NO_TEXT.items():
        if head.startswith(beginning):
            raise InputError(f"{path}: found {name}; expected delimited text, .mat, .lvm or .tdms")
    return _SUFFIXES.get(path.suffix.lower(), "csv")
