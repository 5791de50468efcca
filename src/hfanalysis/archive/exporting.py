"""One series of an archive for other programs: CSV, Parquet, MATLAB."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.archive.reading import Archive
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import atomic

if TYPE_CHECKING:
    import pyarrow as pa

ENDINGS = (".csv", ".parquet", ".mat")

LONGEST = 31
"""Letters of a name in a MATLAB file. Source: scipy.io.savemat, without ``long_field_names``."""


def export(archive: Archive, series: str, tests: Sequence[str], path: Path) -> list[str]:
    """A series of these tests as ``.csv`` or ``.parquet`` (a row per sample, ``test`` first, SI units) or ``.mat`` (a
    struct per test), by the ending of ``path``; the tests that have it.

    Raises InputError for another ending, AbsentError where none of them has it.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: expected a name that ends with {', '.join(ENDINGS)}")
    found, missing = dict[str, Any](), None
    for test in tests:
        try:
            found[test] = archive.read(series, test)
        except AbsentError as error:
            missing = error
    if not found:
        raise missing or AbsentError(f"{archive.path}: no tests")
    with atomic(path) as scratch:
        if path.suffix.lower() == ".mat":
            _write_matlab(scratch, found)
        elif path.suffix.lower() == ".csv":
            from pyarrow import csv

            csv.write_csv(_table(found), scratch)
        else:
            from pyarrow import parquet

            parquet.write_table(_table(found), scratch)
    return list(found)


def _table(found: dict[str, Any]) -> pa.Table:
    import pyarrow as pa

    parts = []
    for test, data in found.items():
        axes = list(data.dims)
        if len(axes) > 1:
            raise InputError(f"{test}: variables over {', '.join(axes)}; expected one axis: a .mat file takes them")
        columns = {name: pa.array(np.asarray(data[name])) for name in [*axes, *data.data_vars]}
        names = pa.array([test]).take(pa.array(np.zeros(data.sizes[axes[0]], dtype=np.int64)))
        parts.append(pa.table({"test": names, **columns}))
    return pa.concat_tables(parts, promote_options="default")


def _write_matlab(path: Path, found: dict[str, Any]) -> None:
    from scipy.io import savemat

    def struct(data: Any) -> dict[str, Any]:
        return {str(name)[:LONGEST]: np.asarray(data[name]) for name in data.variables}

    tests = np.empty(len(found), dtype=object)
    tests[:] = [{"test": test, **struct(data)} for test, data in found.items()]
    with path.open("wb") as file:
        savemat(file, {"tests": tests}, do_compression=True)
