"""MATLAB's .mat: arrays and (nested) structs of arrays, by names such as ``PT1``, ``CF1.mass`` or ``data.PTRAN_1``.

An array of two columns the first of which rises, but for a few steps back, is taken as [time, value]. Text, cells,
single numbers and MATLAB's own classes are left out; of other matrices the columns are ``NAME.1``, ``NAME.2``, ...
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.table import LogSeries, Table

WIDEST = 256
"""Columns of a matrix beyond which it is no set of channels."""
BACK = 0.02
"""Share of steps back that a logger's clock may have."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's arrays; raises :class:`InputError` where it cannot be read."""
    with path.open("rb") as file:
        is_hdf5 = file.read(10) == b"MATLAB 7.3"
    try:
        found = list(_from_hdf5(path) if is_hdf5 else _from_mat5(path))
    except InputError:
        raise
    except Exception as error:  # damaged files fail in every way that there is
        raise InputError(f"{path}: cannot be read as a MATLAB file: {error or type(error).__name__}") from None
    return Table(path, found)


def _from_mat5(path: Path) -> Iterator[LogSeries]:
    from scipy.io import loadmat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about variables of MATLAB's own classes, which are left out
        content: Mapping[str, Any] = loadmat(path)
    for name, value in content.items():
        if not name.startswith("__"):
            yield from _series(name, value)


def _from_hdf5(path: Path) -> Iterator[LogSeries]:
    """MATLAB 7.3 is HDF5 with groups for structs, and arrays transposed."""
    import h5py

    from hfanalysis.record.readers.hdf5_inside import Stored, datasets

    with h5py.File(path, "r") as file:
        for names, item in datasets(path, file):
            own = names[0].startswith("#") or item.attrs.get("MATLAB_class", b"double") == b"char"
            if own or item.attrs.get("MATLAB_empty", 0) or item.dtype.kind not in "fiub" or item.ndim != 2:
                continue
            if 1 in item.shape and item.size > 1:
                yield LogSeries(".".join(names), cast(Array, Stored(path, item.name, item.shape)))
            elif item.shape[0] <= WIDEST:
                yield from _series(".".join(names), np.asarray(item).T)


def _series(name: str, value: Any) -> Iterator[LogSeries]:
    """The series of a variable or a field."""
    if type(value) is not np.ndarray:  # MATLAB's own classes come as arrays of a kind
        return
    if value.dtype.names and value.size == 1:
        for field in value.dtype.names:
            yield from _series(f"{name}.{field}", value[field].item())
    elif value.dtype.kind in "fiub" and value.ndim == 2 and value.size > 1:
        yield from _columns(name, np.asarray(value, dtype=np.float64))


def _columns(name: str, array: NDArray[np.float64]) -> Iterator[LogSeries]:
    if 1 in array.shape:
        yield LogSeries(name, array.ravel())
    elif array.shape[1] == 2 and _is_time(array[:, 0]):
        yield LogSeries(name, array[:, 1], time=array[:, 0])
    elif array.shape[1] <= WIDEST:
        for i, column in enumerate(array.T, start=1):
            yield LogSeries(f"{name}.{i}", column)


def _is_time(numbers: NDArray[np.float64]) -> bool:
    steps = np.diff(numbers)
    rises = len(steps) > 1 and numbers[-1] > numbers[0]
    return bool(rises and np.count_nonzero(steps < 0.0) <= BACK * len(steps))
