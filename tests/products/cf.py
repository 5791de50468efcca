"""What every HDF5 product must be for tools that know nothing of it: the one check, for tests of all of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import h5py
import pint
import xarray as xr

OF_ITS_OWN = {"a": "m/s (kg/m²/s)⁻ⁿ"}
"""Variables whose unit no library can read: that of the regression coefficient hangs on the fitted exponent."""

NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable"
"""What netCDF-4 names a dimension without coordinates: it is no variable, and has no unit."""


@cache
def _registry() -> Any:
    return pint.UnitRegistry()


def check(path: Path) -> None:
    """Fails with all that is wrong with a product, and opens it as a tree of xarray."""
    with h5py.File(path) as file:
        if faults := list(_faults(file)):
            raise AssertionError("; ".join(faults))
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        names = {dimension for node in tree.subtree for dimension in node.dims}
        assert not {name for name in names if str(name).startswith("phony")}
        assert all(node.sizes for node in tree.leaves) or not tree.children


def _faults(file: h5py.File) -> Iterator[str]:
    for name in ("Conventions", "title", "provenance"):
        if not file.attrs.get(name):
            yield f"the file says no {name}"
    if not str(file.attrs.get("Conventions", "")).startswith("CF-1."):
        yield "its Conventions are not CF's"
    found: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: found.append((name, item)))
    for name, item in found:
        if isinstance(item, h5py.Dataset) and str(item.attrs.get("NAME", b"")).lstrip("b'").startswith(NO_VARIABLE):
            continue
        if isinstance(item, h5py.Dataset):
            yield from _of_variable(name, item)
        else:
            yield from _of_group(name, item)


def _of_group(name: str, group: Any) -> Iterator[str]:
    above = group.parent
    while True:
        if same := set(_axes(group)) & set(_axes(above)):
            yield f"{name}: has an axis of the name of one above it, {same}"
        if above.name == "/":
            return
        above = above.parent


def _axes(group: Any) -> list[str]:
    return [name for name, item in group.items() if isinstance(item, h5py.Dataset) and item.is_scale]


def _of_variable(name: str, item: Any) -> Iterator[str]:
    last = name.rpartition("/")[2]
    if not item.attrs.get("long_name"):
        yield f"{name}: has no long_name"
    if not item.is_scale:
        yield from (f"{name}: axis {i} has no name" for i, axis in enumerate(item.dims) if not len(axis))
    yield from _of_unit(name, last, item.attrs.get("units"))
    flags = "flag_values" if "flag_values" in item.attrs else "flag_masks"
    if "flag_meanings" in item.attrs and len(item.attrs["flag_meanings"].split()) != len(item.attrs.get(flags, ())):
        yield f"{name}: as many flag_meanings as {flags} are needed"


def _of_unit(name: str, last: str, unit: object) -> Iterator[str]:
    if unit is None:
        yield f"{name}: has no units"
    elif unit != OF_ITS_OWN.get(last):
        try:
            _registry().Unit(str(unit))
        except Exception as error:  # pint raises a dozen kinds for text that is no unit
            yield f"{name}: pint cannot read its units {unit!r}: {error}"
