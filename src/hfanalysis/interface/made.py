"""A firing made of arrays: written down as a test, and opened as any other."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.errors import InputError
from hfanalysis.interface.firing import Firing
from hfanalysis.products.disk import atomic, make_folder
from hfanalysis.record.written import table_lines

if TYPE_CHECKING:
    import pyarrow as pa

TIME = "time"
"""The column with the time stamps."""

LOG = "log.parquet"


def firing(
    columns: Mapping[str, ArrayLike],
    units: Mapping[str, str] | None = None,
    about: Mapping[str, Any] | None = None,
    *,
    name: str = "firing",
    root: str | Path | None = None,
    kind: str = "hot_fire",
) -> Firing:
    """A test of columns that are at hand: of a dict of arrays, a DataFrame or a Dataset.

    Args:
        columns: by channel (``p_tank``, ``thrust`` …; docs/test-toml.md), (n,) each, and ``time``.
        units: of each column; what a Dataset's variable has as ``units`` need not be said again.
        about: what else test.toml states, by section: ``{"tank": {"volume": "16.5 L"}}``; a channel's ``accuracy`` and
            the like under ``channels``.
        name: of the test.
        root: the folder to write ``raw_tests/NAME/`` to; else a new one among the temporary files, which stays.
        kind: hot_fire, cold_flow or water_flow.

    Raises:
        InputError: a column without a unit or of another length, a test of that name that is there already, or what
            ``about`` states is at fault.
    """
    place = Path(tempfile.mkdtemp(prefix="hfanalysis-")) if root is None else Path(root)
    folder = place / "raw_tests" / name
    if (folder / "test.toml").exists():
        raise InputError(f"{folder}: there is a test of that name already; expected another name or root")
    make_folder(folder)
    known = _units(columns, units or {})
    table = _table(columns)
    document = "\n".join(_document(name, kind, known, about or {}))
    with atomic(folder / LOG) as scratch:
        from pyarrow import parquet

        parquet.write_table(table, scratch)
    with atomic(folder / "test.toml") as scratch:
        scratch.write_text(document, encoding="utf-8")
    return Firing(name, place)


def _units(columns: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, str]:
    """Of each column: as given, else as the column itself has it; the time's is the second."""
    own = {str(name): getattr(columns[name], "attrs", {}).get("units") for name in _names(columns)}
    found = {TIME: "s"} | {name: unit for name, unit in own.items() if unit} | dict(units)
    missing = [name for name in own if name not in found]
    if missing:
        raise InputError(f"column {missing[0]!r}: found no unit; expected one in units, as {{{missing[0]!r}: 'bar'}}")
    return {name: found[name] for name in own}


def _names(columns: Mapping[str, Any]) -> list[str]:
    names = [str(name) for name in getattr(columns, "variables", columns)]
    if TIME not in names:
        raise InputError(f"found columns {', '.join(names) or 'of no name'}; expected one named {TIME!r} among them")
    return names


def _table(columns: Mapping[str, Any]) -> pa.Table:
    import pyarrow as pa

    arrays = {name: np.asarray(columns[name], dtype=np.float64) for name in _names(columns)}
    for name, values in arrays.items():
        if values.shape != arrays[TIME].shape or values.ndim != 1:
            raise InputError(
                f"column {name!r}: found an array of shape {values.shape}; expected {arrays[TIME].shape}, as {TIME!r}"
            )
    return pa.table(arrays)


def _document(name: str, kind: str, units: Mapping[str, str], about: Mapping[str, Any]) -> Iterator[str]:
    """A test.toml."""
    channels = {key: {"column": key, "unit": unit} for key, unit in units.items() if key != TIME}
    for key, more in about.get("channels", {}).items():
        channels[key] = {**channels.get(key, {}), **more}
    log = {"files": [LOG], "time": {"column": TIME, "unit": units[TIME]}} | dict(about.get("log", {}))
    test = {"id": name, "kind": kind} | dict(about.get("test", {}))
    rest = {key: part for key, part in about.items() if key not in ("test", "log", "channels")}
    yield "schema = 1"
    for key, part in {"test": test, "log": log, "channels": channels, **rest}.items():
        yield from table_lines(part, key, inline=(TIME,))
