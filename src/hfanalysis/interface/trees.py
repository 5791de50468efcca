"""HDF5 products as xarray has them, in memory: the files are closed again, for a stage may write them anew."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


def tree(path: Path) -> xr.DataTree:
    """All groups of a product; every variable has ``units`` and ``long_name``. Raises OSError where it is not there."""
    import xarray as xr

    with xr.open_datatree(path, engine="h5netcdf", decode_times=False) as opened:
        return opened.load()


def dataset(path: Path) -> xr.Dataset:
    """The variables of a product without groups. Raises OSError where it is not there."""
    import xarray as xr

    with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as opened:
        return opened.load()
