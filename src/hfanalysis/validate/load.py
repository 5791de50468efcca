"""The residuals of a test in one line, as an xarray tree."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hfanalysis.errors import InputError

if TYPE_CHECKING:
    import h5py
    import xarray as xr

NAME = "residuals.h5"


def find(test: str | Path, root: str | Path = ".") -> Path:
    """The residuals.h5 that is meant: the file itself, the folder it is in, or a test's name below ROOT/processed.

    Raises :class:`InputError` where it is in none of these places.
    """
    places = [Path(test), Path(test) / NAME, Path(root) / "processed" / str(test) / NAME]
    for place in places:
        if place.is_file():
            return place
    raise InputError(f"{test}: no {NAME}; expected {', '.join(str(p) for p in places)} (hfa validate writes it)")


def load(test: str | Path, root: str | Path = ".") -> xr.DataTree:
    """All modes and channels; a dataset at ``tree["full/p_chamber"]``, on its own ``time`` [s after the opening]."""
    import h5py
    import xarray as xr

    with h5py.File(find(test, root)) as file:
        sets = {f"/{mode}/{channel}": _dataset(file[mode][channel]) for mode in file for channel in file[mode]}
        return xr.DataTree.from_dict({"/": xr.Dataset(attrs=dict(file.attrs)), **sets})


def _dataset(group: h5py.Group) -> xr.Dataset:
    import xarray as xr

    found = {name: ("time", data[:], _attributes(data)) for name, data in group.items()}
    return xr.Dataset({n: v for n, v in found.items() if n != "time"}, coords={"time": found["time"]})


def _attributes(data: h5py.Dataset) -> dict[str, object]:
    """What people wrote, without HDF5's own bookkeeping of axes."""
    own = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME")
    return {name: value for name, value in data.attrs.items() if name not in own}
