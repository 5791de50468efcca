"""A flight from its pad to the ground over time: up, down under parachutes, down without, and its margin in winds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hfanalysis.arrays import Array
from hfanalysis.flight.ascent import TRACE, Ascent
from hfanalysis.flight.descent import Leg, descend, fall
from hfanalysis.flight.stability import Launch, StabilityRuns
from hfanalysis.products import netcdf
from hfanalysis.rocket.parachute import Parachute

ABOUT: dict[str, netcdf.About] = {
    "time": ("s", "time after ignition"),
    "altitude": ("m", "altitude above sea level"),
    "height": ("m", "height above the launch site"),
    "speed": ("m/s", "speed along the path; falling, downwards is negative"),
    "acceleration": ("m/s^2", "acceleration along the path"),
    "thrust": ("N", "thrust"),
    "drag": ("N", "drag"),
    "mass": ("kg", "mass of the rocket"),
    "mach": ("1", "Mach number"),
    "oxidizer_mass": ("kg", "oxidizer left"),
    "fuel_mass": ("kg", "fuel left"),
    "center_of_gravity": ("m", "center of gravity from the nose's tip"),
    "pitch_inertia": ("kg m^2", "moment of inertia in pitch, about the center of gravity"),
    "margin_mean": ("1", "static margin in calibers: mean over the gusts"),
    "margin_std": ("1", "static margin in calibers: standard deviation over the gusts"),
    "angle_of_attack": ("rad", "angle of attack"),
}
"""Unit and name in words of each variable of flight.h5."""

BAND = {"low": "lower end of its band", "median": "median", "high": "upper end of its band"}


@dataclass(frozen=True)
class Flown:
    """A flight that took place; ``canopies`` and ``stable`` or why there are none."""

    launch: Launch
    ascent: Ascent
    canopies: tuple[Parachute, Parachute] | str
    stable: StabilityRuns | str

    @property
    def height(self) -> Array:
        """Above the launch site on the way up [m], (n,)."""
        return self.ascent.column("altitude") - self.launch.vehicle.launch_altitude

    def legs(self) -> dict[str, Leg]:
        """The ways down; each downwards negative in speed."""
        vehicle, (time, altitude, _) = self.launch.vehicle, self.ascent.end
        legs = {"ballistic": fall(vehicle, 0.0, (time, altitude, 0.0), vehicle.launch_altitude)}
        if isinstance(self.canopies, str):
            return legs
        down = descend(vehicle, self.ascent.end, *self.canopies)
        return {"drogue": down.legs[0], "main": down.legs[1], **legs}


def groups(
    flown: Flown, beside: Mapping[str, Array], bands: Mapping[str, Array] | None = None
) -> dict[str, dict[str, Array]]:
    """``ascent``, ``bands``, the ways down, ``balance`` and ``stability/N`` for every wind: columns (n,) in SI.

    ``beside``: more columns (n,) on the times of the ascent; ``bands``: of flights that differ in what is uncertain.
    """
    level = flown.launch.vehicle.launch_altitude
    found = {"ascent": {name: flown.ascent.column(name) for name in TRACE} | {"height": flown.height} | dict(beside)}
    if bands is not None:
        found["bands"] = dict(bands)
    for name, leg in flown.legs().items():
        found[name] = {"time": leg.time, "height": leg.altitude - level, "speed": leg.speed}
    if isinstance(flown.stable, str):
        return found
    weighed = flown.stable.balance
    columns = {"mass": weighed.mass, "center_of_gravity": weighed.center, "pitch_inertia": weighed.inertia}
    found["balance"] = {"time": flown.launch.curve.time, **columns}
    for i, margin in enumerate(flown.stable.margins):
        series = {"time": margin.time, "margin_mean": margin.mean, "margin_std": margin.std}
        found[f"stability/{i}"] = {**series, "angle_of_attack": margin.attack}
    return found


def write(
    path: Path,
    title: str,
    provenance: Mapping[str, Any],
    flown: Flown,
    beside: Mapping[str, Array],
    bands: Mapping[str, Array] | None = None,
) -> None:
    """flight.h5: the groups of :func:`groups`, whose arguments the last three are."""
    about = {"launch_altitude": flown.launch.vehicle.launch_altitude, "launch_altitude_units": "m"}
    with netcdf.product(path, title, provenance, **about) as file:
        for name, columns in groups(flown, beside, bands).items():
            _write(file, name, columns)
        for i, margin in enumerate(() if isinstance(flown.stable, str) else flown.stable.margins):
            file[f"stability/{i}"].attrs.update(wind=margin.wind, wind_units="m/s")


def _write(file: Any, name: str, columns: Mapping[str, Array]) -> None:
    netcdf.table(file.create_group(name), columns, ABOUT | _banded(columns))


def _banded(columns: Mapping[str, Array]) -> dict[str, netcdf.About]:
    """What the three parts of a band are."""
    parts = {key: key.rpartition("_") for key in columns if key.rpartition("_")[2] in BAND}
    return {key: (ABOUT[name][0], f"{ABOUT[name][1]}: {BAND[part]}") for key, (name, _, part) in parts.items()}
