"""One reader per log format behind one :func:`open_log`."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.formats import FORMATS, NO_LOGS, NO_LOGS_BY_SUFFIX, TEXT, Format, names
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.base import Chunk, Progress, Source, Text, find_column

__all__ = ["Chunk", "Progress", "Source", "Text", "find_column", "open_log"]

LOOKED_AT = 4096
"""Bytes by which a format is recognized [B]. Evidence: test_more_formats.py: damage of some bytes does not decide."""
LARGEST = 1 << 30
"""Bytes of a spreadsheet unpacked [B]. Evidence: a sheet has at most 2^20 rows; one of 20 columns full of numbers has a
third."""
NOT_TEXT = 0.05
"""Share of control characters from which bytes are no text. Evidence: test_more_formats.py: text has none but for
damage; of bytes of any kind one in twelve is one."""
_CONTROL = bytes(set(range(1, 32)) - {7, 8, 9, 10, 11, 12, 13, 26, 27})


def open_log(path: Path, spec: FileSpec) -> Source:
    """The log file opened by the reader of its format (as forced, else by content, else by suffix).

    Raises :class:`InputError` where the file is empty or of a format nobody here reads.
    """
    with path.open("rb") as file:
        head = file.read(LOOKED_AT)
    if not head.strip(b"\0\r\n\t ,;") and path.stat().st_size <= LOOKED_AT:
        raise InputError(f"{path}: found an empty file; expected a log")
    name = spec.format or _detect(path, head)
    open_source: Callable[[Path, FileSpec], Source] = import_module(f"{__name__}.{FORMATS[name].reader}").open_source
    return open_source(path, spec)


def _detect(path: Path, head: bytes) -> str:
    bare = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    for beginning, what in NO_LOGS.items():
        if head.startswith(beginning) or bare.lower().startswith(beginning.lower()):
            raise InputError(f"{path}: found {what}")
    begun = [word for word, one in FORMATS.items() if _begins(one, head, bare)]
    if begun:
        return _not_another_zip(path, begun[0])
    if _is_binary(head):
        unknown = f"bytes of a format that is not known here; expected {names()}"
        raise InputError(f"{path}: found {NO_LOGS_BY_SUFFIX.get(path.suffix.lower(), unknown)}")
    return next((word for word, one in FORMATS.items() if one.text and one.suffix == path.suffix.lower() != ""), TEXT)


def _begins(one: Format, head: bytes, bare: bytes) -> bool:
    return head.startswith(one.beginnings) or bool(one.pattern and re.match(one.pattern, bare))


def _not_another_zip(path: Path, word: str) -> str:
    """The format of a spreadsheet; a zip archive of anything else is refused."""
    if not zipfile.is_zipfile(path) or word != "excel":
        return word
    try:
        with zipfile.ZipFile(path) as archive:
            inside, size = archive.namelist(), sum(one.file_size for one in archive.infolist())
    except (zipfile.BadZipFile, OSError, ValueError) as error:
        raise InputError(f"{path}: found a damaged zip archive or spreadsheet ({error}); expected a log") from None
    if size > LARGEST:
        raise InputError(f"{path}: found a spreadsheet of {size / 1e9:.1f} GB unpacked; expected it exported as CSV")
    if not any(name.startswith("xl/") or name == "content.xml" for name in inside):
        shown = ", ".join(inside[:3]) + (", ..." if len(inside) > 3 else "")
        raise InputError(f"{path}: found a zip archive ({shown}); expected the log unpacked")
    return word


def _is_binary(head: bytes) -> bool:
    return len(head.translate(None, _CONTROL)) < (1.0 - NOT_TEXT) * len(head)
