"""LabVIEW's text measurement files (.lvm): a header that says how the table below it is written.

``X_Columns``: ``One`` column of time for all channels, ``Multi``, one beside each, or ``No``; then a channel holds the
time, or the sample rate has to be stated (Delta_X in the header is known to be wrong in real files).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.delimited import Delimited
from hfanalysis.record.readers.dialect import Dialect
from hfanalysis.record.readers.encodings import SAMPLE, encoding_of

_MARKS = {"Tab": "\t", "Comma": ",", "Semicolon": ";"}
_NAMES = "X_Value"
"""With this begins the row of names."""


def open_source(path: Path, spec: FileSpec) -> Delimited:
    """The text log below its header; raises :class:`InputError` where there is none."""
    with path.open("rb") as file:
        sample = file.read(SAMPLE)
    encoding = spec.encoding or encoding_of(sample)
    lines = sample.decode(encoding, errors="replace").splitlines()
    row = next((i for i, line in enumerate(lines) if line.startswith(_NAMES)), None)
    if row is None or row + 1 >= len(lines):
        raise InputError(f"{path}: found no row that begins with {_NAMES!r} and data below it; expected a LabVIEW log")
    above, names = lines[:row], lines[row]
    mark = spec.delimiter or _MARKS.get(_stated(above, "Separator").strip(), "\t")
    columns = tuple(name.strip() for name in names.split(mark))
    decimal = spec.decimal or _stated(above, "Decimal_Separator")[:1] or "."
    dialect = Dialect(encoding, mark, decimal, row + 1, len(columns), columns, _units(above, mark, columns))
    return Delimited(path, dialect, _clocks(columns, _stated(above, "X_Columns").strip()))


def _stated(lines: Sequence[str], key: str) -> str:
    """What the header states behind a key and the separator."""
    return next((line[len(key) + 1 :] for line in lines if line.startswith(key)), "")


def _units(lines: Sequence[str], mark: str, names: Sequence[str]) -> tuple[str, ...]:
    """The units of the channels, in their order; columns of time are in seconds."""
    stated = next((line.split(mark)[1:] for line in lines if line.startswith("Y_Unit_Label")), [])
    units = iter(stated)
    return tuple("s" if name == _NAMES else next(units, "").strip() for name in names)


def _clocks(names: Sequence[str], kind: str) -> dict[int, int]:
    """Column -> column of its time stamps."""
    if kind not in ("One", "Multi"):
        return {}
    stamps = [i for i, name in enumerate(names) if name == _NAMES]
    return {i: max(k for k in stamps if k < i) for i in range(len(names)) if i not in stamps}
