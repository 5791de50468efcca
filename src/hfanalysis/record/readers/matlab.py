"""MATLAB's .mat: arrays and (nested) structs of arrays, by names such as ``PT1``, ``CF1.mass`` or ``data.PTRAN_1``.

An array of two columns the first of which rises, but for a few steps back, is taken as [time, value]. Of other matrices
the columns are ``NAME.1``, ``NAME.2``, ... (the longer axis is time). Arrays of structs with single numbers are series
by field; those that each hold a name and a series, channels by that name. Cells of single numbers are numbers. Text and
single numbers are left out, MATLAB's own classes (table, timetable, datetime) refused by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import mat5
from hfanalysis.record.readers.series import series
from hfanalysis.record.readers.table import WIDEST, LogSeries, Table

BACK = 0.02
"""Share of steps back that a logger's clock may have."""
_WITH_SERIES = ("table", "timetable", "datetime", "duration", "timeseries")
"""MATLAB's own classes that hold series. Source: MATLAB."""
_NAME_FIELDS = ("name", "label", "channel", "title", "id")
_TIME_FIELDS = ("t", "time", "x", "timestamp", "timestamps")
"""Fields of a channel's struct, by what they hold."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's arrays; raises :class:`InputError` where it cannot be read."""
    with path.open("rb") as file:
        is_hdf5 = file.read(10) == b"MATLAB 7.3"
    opaque: dict[str, str] = {}
    try:
        found = list(_from_hdf5(path, opaque) if is_hdf5 else _from_mat5(path, opaque))
    except InputError:
        raise
    except Exception as error:  # damaged files fail in every way that there is
        raise InputError(f"{path}: cannot be read as a MATLAB file: {error or type(error).__name__}") from None
    notes = [f"{path.name}: {_refused(name, kind)}" for name, kind in opaque.items() if kind in _WITH_SERIES]
    if not found and opaque:
        raise InputError(f"{path}: {_refused(*next(iter(opaque.items())))}")
    return Table(path, found, notes)


def _refused(name: str, kind: str) -> str:
    return (
        f"variable {name!r} is of MATLAB's own class {kind}, which only MATLAB reads; expected arrays or structs "
        "(table2struct(T, 'ToScalar', true), seconds(t - t(1)))"
    )


def _from_mat5(path: Path, opaque: dict[str, str]) -> Iterator[LogSeries]:
    for name, value in mat5.variables(path.read_bytes()):
        if isinstance(value, mat5.Opaque):
            opaque[name] = value.kind or "(unnamed)"
        else:
            yield from _series(name, value)


def _from_hdf5(path: Path, opaque: dict[str, str]) -> Iterator[LogSeries]:
    """MATLAB 7.3 is HDF5 with groups for structs, and arrays transposed."""
    import h5py

    from hfanalysis.record.readers.hdf5_inside import Stored, datasets

    with h5py.File(path, "r") as file:
        for names, item in datasets(path, file):
            kind = np.asarray(item.attrs.get("MATLAB_class", b"double")).item().decode(errors="replace")
            if names[0].startswith("#") or kind == "char" or item.attrs.get("MATLAB_empty", 0):
                continue
            if "MATLAB_object_decode" in item.attrs and kind not in ("function_handle",):
                opaque[".".join(names)] = kind
            elif kind == "cell" and item.dtype.kind == "O":
                yield from _series(".".join(names), _referred(file, item))
            elif item.dtype.kind == "O":
                yield from _records_of(file, item, names)
            elif item.dtype.kind in "fiub" and item.ndim == 2:
                if 1 in item.shape and item.size > 1:
                    yield LogSeries(".".join(names), cast(Array, Stored(path, item.name)))
                elif item.shape[0] <= WIDEST:
                    yield from _series(".".join(names), np.asarray(item).T)


def _referred(file: Any, item: Any) -> NDArray[Any]:
    """The single numbers that a cell array's references lead to; other contents are None."""
    found = np.empty(item.shape, dtype=object)
    for place, reference in np.ndenumerate(np.asarray(item)):
        inner = file[reference] if reference else None
        plain = inner is not None and hasattr(inner, "dtype") and inner.dtype.kind in "fiub" and inner.size == 1
        found[place] = np.asarray(inner).reshape(1, 1) if plain else None
    return found.T


def _records_of(file: Any, item: Any, names: tuple[str, ...]) -> Iterator[LogSeries]:
    """A field of an array of structs, where it holds single numbers."""
    yield from _series(".".join(names), _referred(file, item))


def _series(name: str, value: Any) -> Iterator[LogSeries]:
    """The series of a variable or a field."""
    if isinstance(value, mat5.Struct):
        if len(value.elements) == 1:
            for field, inner in value.elements[0].items():
                yield from _series(f"{name}.{field}", inner)
        elif value.elements and value.fields:
            yield from _of_structs(name, value)
    elif isinstance(value, np.ndarray) and value.ndim == 2 and value.size > 1:
        if value.dtype.kind == "O":
            yield from _of_cells(name, value)
        elif value.dtype.kind in "fiub":
            yield from columns(name, np.asarray(value, dtype=np.float64))


def _of_structs(name: str, array: mat5.Struct) -> Iterator[LogSeries]:
    """An array of structs: a channel in each, or a sample in each."""
    elements, fields = array.elements, array.fields
    if all(isinstance(one, str) or np.size(one) <= 1 for one in elements[0].values()):
        for field in fields:
            found = series(f"{name}.{field}", [_single(one[field]) for one in elements])
            if found is not None and np.isfinite(found.numbers).any():
                yield found
        return
    title = next((field for field in fields if field.lower() in _NAME_FIELDS), None)
    clock = next((field for field in fields if field.lower() in _TIME_FIELDS), None)
    if clock and all(np.array_equal(one[clock], elements[0][clock]) for one in elements):
        yield from _series(f"{name}.{clock}", elements[0][clock])
    for number, one in enumerate(elements, start=1):
        own = one[title] if title and isinstance(one[title], str) else str(number)
        rest = {field: one[field] for field in fields if field not in (title, clock)}
        yield from _of_channel(f"{name}.{own}", rest, one[clock] if clock else None)


def _of_channel(name: str, fields: Mapping[str, Any], clock: Any) -> Iterator[LogSeries]:
    """The series of a struct that is one channel, on its own clock where that is as long."""
    held = [(field, part) for field, value in fields.items() for part in _series("", value)]
    time = next((part.numbers for part in _series("", clock)), None)
    for field, part in held:
        label = name if len(held) == 1 else f"{name}.{field}"
        fits = time is not None and len(time) == len(part.numbers)
        yield LogSeries(f"{label}{part.name}", part.numbers, time=time if fits else part.time)


def _single(value: Any) -> Any:
    """The one number of an array, or text; None of an empty one."""
    if isinstance(value, str) or value is None:
        return value
    flat = np.ravel(value)
    return flat[0].item() if len(flat) == 1 and hasattr(flat[0], "item") else None


def _of_cells(name: str, cells: NDArray[Any]) -> Iterator[LogSeries]:
    """Cells of single numbers or text: rows or columns of a table, the longer axis being time."""
    table = cells if cells.shape[0] >= cells.shape[1] else cells.T
    single = (isinstance(one, str) or one is None or np.size(one) <= 1 for one in np.ravel(table[:2]))
    if table.shape[1] > WIDEST or not all(single):
        return
    for i, column in enumerate(table.T, start=1):
        title = column[0] if isinstance(column[0], str) else None
        values = [_single(one) for one in (column[1:] if title else column)]
        label = f"{name}.{title}" if title else name if table.shape[1] == 1 else f"{name}.{i}"
        found = series(label, values) if any(value is not None for value in values) else None
        if found is not None:
            yield found


def columns(name: str, array: NDArray[np.float64]) -> Iterator[LogSeries]:
    """The series of a matrix (n, k): its one row or column, [time, value], or one by one."""
    if 1 in array.shape:
        yield LogSeries(name, array.ravel())
        return
    table = array if array.shape[0] >= array.shape[1] else array.T
    if table.shape[1] == 2 and _is_time(table[:, 0]):
        yield LogSeries(name, table[:, 1], time=table[:, 0])
    elif table.shape[1] <= WIDEST:
        for i, column in enumerate(table.T, start=1):
            yield LogSeries(f"{name}.{i}", column)


def _is_time(numbers: NDArray[np.float64]) -> bool:
    steps = np.diff(numbers)
    rises = len(steps) > 1 and numbers[-1] > numbers[0]
    return bool(rises and np.count_nonzero(steps < 0.0) <= BACK * len(steps))
