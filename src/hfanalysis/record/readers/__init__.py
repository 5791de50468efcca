"""One reader per log format behind one :func:`open_log`."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.formats import FORMATS, NO_LOGS, TEXT, names
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.base import Chunk, Progress, Source, Text, find_column

__all__ = ["Chunk", "Progress", "Source", "Text", "find_column", "open_log"]


def open_log(path: Path, spec: FileSpec) -> Source:
    """The log file opened by the reader of its format (as forced, else by content, else by suffix).

    Raises :class:`InputError` where the file is empty or of a format nobody here reads.
    """
    with path.open("rb") as file:
        head = file.read(64)
    if not head.strip(b"\0\r\n\t ,;"):
        raise InputError(f"{path}: found an empty file; expected a log")
    name = spec.format or _detect(path, head)
    open_source: Callable[[Path, FileSpec], Source] = import_module(f"{__name__}.{FORMATS[name].reader}").open_source
    return open_source(path, spec)


def _detect(path: Path, head: bytes) -> str:
    for beginning, what in NO_LOGS.items():
        if head.startswith(beginning):
            raise InputError(f"{path}: found {what}; expected {names()}")
    begun = [word for word, one in FORMATS.items() if head.startswith(one.beginnings)]
    named = [word for word, one in FORMATS.items() if one.suffix == path.suffix.lower()]
    return next(iter([*begun, *named]), TEXT)
