"""How an archive is laid out: a netCDF-4 file that xarray opens lazily, however many tests it holds.

``/`` has the tests and what they state, one after the other along ``test``. What the tests' HDF5 products hold stands
end to end, in a group of the product's own name and path below ``series``: CF's contiguous ragged arrays, of which
``AXIS_count`` says how much is of which test. ``quantities`` has every number of the JSON products, sorted by its name;
``files`` the files themselves, each compressed by itself, with its hash.
"""

from __future__ import annotations

from pathlib import PurePosixPath

from hfanalysis.errors import InputError
from hfanalysis.record.schema import unsafe

TITLE = "archive of hfanalysis"
VERSION = 1
"""Of this layout."""

SERIES, QUANTITIES, FILES = "series", "quantities", "files"
RAW, MADE = "raw", "processed"
"""Where a file of a test lies in the archive, before its own name: beside its test.toml, and among its products."""

CHUNK = 32768
"""Samples of a piece that is read, and compressed, at once: a quarter of a megabyte."""

NO_VERDICT = "-"
"""What stands for the verdict of a quantity that has none."""

LEFT_OUT = (".html", ".pdf", ".png", ".lock", ".log")
"""Endings of products that an archive leaves out: pages and pictures are drawn anew from the others."""


def checked(name: str) -> PurePosixPath:
    """The place of a file below a root's folders, by its name in an archive; raises InputError where it leads out of
    them: an archive may come from anyone."""
    place = PurePosixPath(name)
    parts = place.parts
    odd = place.is_absolute() or len(parts) < 2 or parts[0] not in (RAW, MADE)
    if odd or any(part in ("..", ".") or "\\" in part or ":" in part or "\0" in part for part in parts):
        raise InputError(f"{name!r} in the archive: expected a file below {RAW}/ or {MADE}/")
    return place


def checked_test(name: str) -> str:
    """The name of a test of an archive; raises InputError where it is none of a folder."""
    if not name or unsafe(name):
        raise InputError(f"test {name!r} in the archive: expected the name of a folder, without path separators")
    return name
