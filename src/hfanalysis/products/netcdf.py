"""What every HDF5 product has: axes as dimension scales, variables with a unit and a name in words, CF's attributes.

Such a file is netCDF-4 by its structure: xarray reads it with h5netcdf or netCDF4, MATLAB and ``h5dump`` by its paths.
No axis goes without a name, and no group has an axis of the name of one above it, which xarray's trees would align.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from hfanalysis.products.hdf5 import created

CONVENTIONS = "CF-1.11"
"""What the attributes follow. Source: NetCDF Climate and Forecast metadata conventions, version 1.11."""

FORMAT = ("v108", "v110")
"""HDF5 versions that MATLAB and older tools read."""

LAYOUT: dict[str, Any] = {"libver": FORMAT, "track_order": False, "rdcc_nbytes": 0}
"""How a product's file is opened. Without a cache of chunks each is written where it comes: from a cache it is written
when Python lets go of its variable, so that the same content lay elsewhere once in some hundred files."""

About = tuple[str, str]
"""The unit of a variable, and its name in words."""

TIME: About = ("s", "time after the valve opening")


@contextmanager
def product(path: Path, title: str, provenance: Mapping[str, Any], **more: Any) -> Iterator[h5py.File]:
    """A new product to put groups and variables into; ``more`` are attributes of the whole.

    Byte-identical for the same content. Raises OSError where the disk does not take it.
    """
    with created(path, **LAYOUT) as file:
        describe(file, title, provenance)
        file.attrs.update(more)
        yield file


def describe(file: h5py.File, title: str, provenance: Mapping[str, Any]) -> None:
    """What a whole file says of itself."""
    file.attrs["Conventions"] = CONVENTIONS
    file.attrs["title"] = title
    file.attrs["provenance"] = json.dumps(provenance, sort_keys=True)


def axis(group: h5py.Group, name: str, values: NDArray[Any], about: About = TIME) -> h5py.Dataset:
    """A dimension of ``group``: its ``values`` (n,) as a dimension scale of its own name."""
    made = data(group, name, values, about)
    made.make_scale(name)
    return made


def variable(
    group: h5py.Group, name: str, values: NDArray[Any], about: About, on: str = "time", **attributes: Any
) -> h5py.Dataset:
    """A variable (n,) along the axis ``on`` of its group."""
    made = data(group, name, values, about)
    made.dims[0].attach_scale(group[on])
    made.attrs.update(attributes)
    return made


def table(group: h5py.Group, columns: Mapping[str, NDArray[Any]], about: Mapping[str, About], on: str = "time") -> None:
    """Columns (n,) along the one of them that is named ``on``; what each is by ``about``."""
    axis(group, on, np.asarray(columns[on], dtype=np.float64), about[on])
    for name, values in columns.items():
        if name != on:
            variable(group, name, np.asarray(values, dtype=np.float64), about[name], on)


def data(group: h5py.Group, name: str, values: NDArray[Any], about: About) -> h5py.Dataset:
    """A data set with unit and name. Bytes are packed; where all of them are zero they are not written at all."""
    made = _made(group, name, values)
    made.attrs["units"], made.attrs["long_name"] = about
    return made


def _made(group: h5py.Group, name: str, values: NDArray[Any]) -> h5py.Dataset:
    if values.dtype != np.uint8 or not len(values):
        return group.create_dataset(name, data=values, track_times=False)
    packed: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "track_times": False}
    if values.any():
        return group.create_dataset(name, data=values, **packed)
    return group.create_dataset(name, values.shape, values.dtype, fillvalue=0, **packed)
