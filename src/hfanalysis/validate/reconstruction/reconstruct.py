"""The reconstruction of a test: histories with their bands for performance.h5, and what validation.json says of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.errors import AbsentError
from hfanalysis.products.reconstruction import AXIS, Reconstruction
from hfanalysis.quantity import CONDITIONAL, NORMAL_95, Quantity
from hfanalysis.validate.efficiency import ideal
from hfanalysis.validate.reconstruction.closing import EITHER_WAY, Closed, band, close
from hfanalysis.validate.reconstruction.gathered import ASSUMED, Gathered, gather
from hfanalysis.validate.reconstruction.theory import Theory
from hfanalysis.validate.reduction import Test
from hfanalysis.validate.tap import tap_of

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

SPREAD = 1.25
"""Largest over smallest flux from which a and n are told. Source: over less, n is the slope of a point."""


@dataclass(frozen=True)
class Reconstructed:
    """``time`` (n,) [s after the opening]; histories (n,) by name, with 95 % bands; ``told`` (n,): 1 where O/F is."""

    product: Reconstruction
    time: Array = field(default_factory=lambda: np.zeros(0))
    histories: dict[str, tuple[Array, Array, Array]] = field(default_factory=dict)
    told: Array = field(default_factory=lambda: np.zeros(0))


def reconstruct(test: Test) -> Reconstructed:
    """Of a test with its chamber's pressure; where it cannot be had the product says why."""
    found = ideal(test.measured, test.flows, test.engine, test.ambient, test.fire, test.purge, tap_of(test.definition))
    try:
        if found is None:
            raise AbsentError(test.log.lacks("p_chamber"))
        if test.engine.oxidizer_enthalpy is None:
            raise AbsentError("the enthalpy of the oxidizer is not known")
        theory = Theory.of(test.engine.oxidizer_enthalpy, test.engine.throat_area, test.engine.exit_area)
        gathered = gather(test, found, theory)
        closed = close(gathered.inputs, theory, ASSUMED[0])
        if isinstance(closed, str):
            raise AbsentError(closed)
    except (AbsentError, ArithmeticError, ValueError) as missing:
        return Reconstructed(Reconstruction(variant=None, reason=str(missing)))
    return _told(test, gathered, closed)


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


def _told(test: Test, gathered: Gathered, closed: Closed) -> Reconstructed:
    inputs, histories = gathered.inputs, _histories(test, gathered, closed)
    noise = {"of_ratio": inputs.white * closed.stiffness, "fuel_flow": inputs.white * closed.stiffness}
    bands = {name: (lanes[:, 0], *band(lanes, noise.get(name, 0.0))) for name, lanes in histories.items()}
    mean = _total(closed, gathered)
    a, n = _law(histories, closed)
    change = histories["throat_radius"][-1] - histories["throat_radius"][0]
    nozzle = gathered.nozzle_efficiency
    product = Reconstruction(
        variant=gathered.variant,
        assumption=gathered.assumption,
        window=(float(inputs.time[0]), float(inputs.time[-1])),
        told=float(closed.told.mean()),
        of_ratio_mean=_quantity(mean, "", gathered),
        c_star_efficiency=_quantity(histories["c_star_efficiency"].mean(axis=0), "", gathered),
        throat_radius_change=_change(change, gathered),
        a=a,
        n=n,
        nozzle_efficiency=None if nozzle is None else Quantity(nozzle, ""),
        other=None if closed.other is None else _other(*closed.other),
    )
    return Reconstructed(product, inputs.time, bands, closed.told.astype(float))


def _histories(test: Test, gathered: Gathered, closed: Closed) -> dict[str, Array]:
    """By name, (n, paths)."""
    inputs, engine = gathered.inputs, test.engine
    pressure, oxidizer, area, drift = (
        inputs.along(what, closed.lane) for what in ("pressure", "oxidizer", "throat", "drift")
    )
    steps = np.diff(inputs.time, prepend=inputs.time[0])[:, None]
    before = closed.fuel[:1] * inputs.time[0] * 0.5  # the ignition: the flow rises from nothing
    burnt = before + np.cumsum(steps * closed.fuel, axis=0)
    port = np.sqrt(engine.port_radius**2 + burnt / (engine.fuel_density * pi * engine.grain_length))
    return {
        "of_ratio": closed.of_ratio,
        "fuel_flow": closed.fuel,
        "regression_rate": closed.fuel / (2.0 * pi * port * engine.grain_length * engine.fuel_density),
        "port_radius": port,
        "oxidizer_flux": np.asarray(oxidizer_flux(oxidizer, port)),
        "c_star": pressure * area / (oxidizer + closed.fuel),
        "c_star_efficiency": closed.efficiency[None] * (1.0 + drift),
        "throat_radius": np.sqrt(area / pi),
    }


def _total(closed: Closed, gathered: Gathered) -> Array:
    """O/F of all that passes in the window (paths,)."""
    inputs = gathered.inputs
    oxidizer = inputs.along("oxidizer", closed.lane)
    return np.asarray(np.trapezoid(oxidizer, inputs.time, axis=0) / np.trapezoid(closed.fuel, inputs.time, axis=0))


def _quantity(lanes: Array, unit: str, gathered: Gathered) -> Quantity:
    """A positive number and what its errors make of it."""
    value, (low, high) = float(lanes[0]), (float(end[0]) for end in band(lanes[None]))
    verdict = CONDITIONAL if gathered.variant == "a" else None
    std = 0.5 * (high - low) / NORMAL_95
    return Quantity(value, unit, std, (low, high), verdict=verdict, why=gathered.assumption)


def _change(lanes: Array, gathered: Gathered) -> Quantity:
    if "erosion+" in gathered.inputs.moved:
        return Quantity.absent("nobody measured the throat afterwards: taken as it was, or wider by what throats erode")
    std = _std(lanes)
    why = "by both measured radii, and thrust between" if gathered.variant == "d" else "evenly between measured radii"
    return Quantity(float(lanes[0]), "m", std, why=why)


def _law(histories: dict[str, Array], closed: Closed) -> tuple[Quantity, Quantity]:
    """a and n of r = a G^n along the path where O/F is told, with the errors that the whole path has in common."""
    part = closed.told
    flux, rate = histories["oxidizer_flux"][part], histories["regression_rate"][part]
    if part.sum() < 5 or flux[:, 0].max() < SPREAD * flux[:, 0].min():
        reason = "the flux hardly moves where O/F is told: one point has no slope"
        return Quantity.absent(reason), Quantity.absent(reason)
    fits = np.array([np.polyfit(np.log(flux[:, i]), np.log(rate[:, i]), 1) for i in range(flux.shape[1])])
    n, log_a = fits[:, 0], fits[:, 1]
    std_n, std_a = _std(n), _std(log_a)
    why = "along the path of one firing, its errors in common"
    a = float(np.exp(log_a[0]))
    unit = "m/s (kg/m^2/s)^-n"
    ends = a * float(np.exp(-NORMAL_95 * std_a)), a * float(np.exp(NORMAL_95 * std_a))
    return Quantity(a, unit, a * std_a, ends, why=why), Quantity(float(n[0]), "", std_n, why=why)


def _std(lanes: Array) -> float:
    """Standard deviation of a number with its errors moved by two deviations either way (paths,)."""
    return 0.5 * float(np.linalg.norm(np.abs(lanes[1:] - lanes[0]).reshape(-1, EITHER_WAY).max(axis=1)))


def _other(path: Array, efficiency: float) -> str:
    return f"O/F from {path[0]:.2g} to {path[-1]:.2g} at a c* efficiency of {efficiency:.3f} fits as well"
