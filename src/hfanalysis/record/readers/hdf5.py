"""HDF5 and NetCDF: data sets by ``GROUP.NAME``, of matrices the columns ``NAME.1``, ``NAME.2``, ...; of compound types
the fields.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.series import series
from hfanalysis.record.readers.stamps import StampParser
from hfanalysis.record.readers.table import WIDEST, LogSeries, Table

_SINCE = re.compile(r"^\s*(?P<unit>\w+)\s+since\s+(?P<date>.+?)\s*$")
"""How NetCDF's conventions write the unit of a time."""
_SECONDS = {"second": 1.0, "sec": 1.0, "s": 1.0, "millisecond": 1e-3, "msec": 1e-3, "ms": 1e-3, "microsecond": 1e-6,
            "us": 1e-6, "nanosecond": 1e-9, "ns": 1e-9, "minute": 60.0, "min": 60.0, "hour": 3600.0, "h": 3600.0,
            "hr": 3600.0, "day": 86400.0, "d": 86400.0}  # fmt: skip
"""Seconds in a unit of time [s]. Source: CF conventions for NetCDF, 4.4."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's data sets of numbers; raises :class:`InputError` where it cannot be read."""
    with path.open("rb") as file:
        classic = file.read(3) == b"CDF"
    try:
        return Table(path, list(_from_netcdf3(path) if classic else _from_hdf5(path)))
    except InputError:
        raise
    except Exception as error:  # damaged files fail in every way that there is
        raise InputError(f"{path}: cannot be read as HDF5 or NetCDF: {error or type(error).__name__}") from None


def _from_netcdf3(path: Path) -> Iterator[LogSeries]:
    from scipy.io import netcdf_file

    with netcdf_file(path, "r", mmap=False) as file:
        for name, variable in file.variables.items():
            yield from _columns(name, np.array(variable[:]), dict(variable._attributes))


def _from_hdf5(path: Path) -> Iterator[LogSeries]:
    import h5py

    from hfanalysis.record.readers.hdf5_inside import Stored, datasets

    with h5py.File(path, "r") as file:
        for names, item in datasets(path, file):
            name, about = ".".join(names), dict(item.attrs)
            unit = _word(about.get("units", ""))
            if not (item.shape and item.size > 1 and item.ndim <= 2 and item.dtype.kind in "fiubVSO"):
                continue
            if item.dtype.kind in "fiub" and max(item.shape) == item.size and not _SINCE.match(unit):
                stored = Stored(path, item.name, partial(_scaled, about=about))
                yield LogSeries(name, cast(Array, stored), unit)
            else:
                yield from _columns(name, np.asarray(item), about)


def _columns(name: str, array: Any, about: dict[str, Any]) -> Iterator[LogSeries]:
    """The series of an array, in the unit that its attributes state; missing values are none."""
    if array.dtype.names:
        for field in array.dtype.names:
            yield from _columns(f"{name}.{field}", array[field], {})
    elif array.dtype.kind in "SO" and array.ndim == 1:
        found = series(name, [one.decode(errors="replace") if isinstance(one, bytes) else str(one) for one in array])
        yield from [found] if found is not None else []
    elif array.dtype.kind in "fiub" and array.ndim in (1, 2) and array.size > 1:
        numbers = _scaled(np.asarray(array, dtype=np.float64), about)
        if numbers.ndim == 1 or 1 in numbers.shape:
            yield _timed(name, numbers.ravel(), _word(about.get("units", "")))
            return
        numbers = numbers if numbers.shape[0] >= numbers.shape[1] else numbers.T
        for i, column in enumerate(numbers.T[:WIDEST], start=1):
            yield LogSeries(f"{name}.{i}", column.copy(), _word(about.get("units", "")))


def _scaled(numbers: Any, about: dict[str, Any]) -> Any:
    """Numbers by the conventions of NetCDF: fill values are none; scale and offset are applied."""
    for key in ("_FillValue", "missing_value"):
        if key in about:
            numbers[np.isin(numbers, np.asarray(about[key], dtype=np.float64))] = np.nan
    scale, offset = (np.ravel(about.get(key, default))[0] for key, default in (("scale_factor", 1), ("add_offset", 0)))
    return numbers * float(scale) + float(offset)


def _word(value: Any) -> str:
    found = np.ravel(value)[0] if np.size(value) else ""
    return found.decode(errors="replace") if isinstance(found, bytes) else str(found)


def _timed(name: str, numbers: Any, unit: str) -> LogSeries:
    """A series; a time "... since DATE" is in seconds since midnight of that date."""
    since = _SINCE.match(unit)
    scale = _SECONDS.get(since["unit"].lower().rstrip("s") or "s") if since else None
    if since is None or scale is None:
        return LogSeries(name, numbers, unit)
    import pyarrow as pa

    parser = StampParser()
    date = since["date"] if ":" in since["date"] else f"{since['date']} 00:00:00"
    start = float(parser.seconds(pa.array([date], pa.string()))[0])
    if not np.isfinite(start) or parser.epoch is None:
        return LogSeries(name, numbers * scale, "s")
    first = np.nan_to_num(numbers[0] * scale + start)
    days = float(first // 86400.0) * 86400.0
    return LogSeries(name, numbers * scale + start - days, "s", epoch=parser.epoch + days, written=True)
