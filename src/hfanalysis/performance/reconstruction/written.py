"""The group ``reconstructed`` of performance.h5."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hfanalysis.performance.reconstruction.reconstruct import Reconstructed
from hfanalysis.products.reconstruction import AXIS

if TYPE_CHECKING:
    import h5py

UNITS = {
    "of_ratio": ("1", "oxidizer to fuel flow ratio"),
    "fuel_flow": ("kg/s", "fuel mass flow"),
    "regression_rate": ("m/s", "regression rate of the fuel"),
    "port_radius": ("m", "radius of the port"),
    "oxidizer_flux": ("kg/(m^2 s)", "oxidizer mass flux in the port"),
    "c_star": ("m/s", "characteristic velocity"),
    "c_star_efficiency": ("1", "characteristic velocity over that of shifting equilibrium"),
    "throat_radius": ("m", "radius of the throat"),
}
"""Unit and long name of each history."""

PARTS = "", ", lower end of its 95 % interval", ", upper end of its 95 % interval"
"""Of a history."""


def write_reconstructed(file: h5py.File, found: Reconstructed) -> None:
    """The group ``reconstructed`` of performance.h5; nothing where there is no reconstruction."""
    from hfanalysis.products import netcdf

    if not found.histories:
        return
    group = file.create_group("reconstructed")
    group.attrs["variant"] = str(found.product.variant)
    group.attrs["assumption"] = str(found.product.assumption)
    netcdf.axis(group, AXIS, found.time)
    for name, parts in found.histories.items():
        unit, words = UNITS[name]
        for suffix, said, values in zip(("", "_low95", "_high95"), PARTS, parts, strict=True):
            netcdf.variable(group, name + suffix, values, (unit, f"{words}{said}"), AXIS)
    about = ("1", "1 where O/F does not hang on the last per cent of the pressure")
    netcdf.variable(group, "told", found.told, about, AXIS)
