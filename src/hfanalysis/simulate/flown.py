"""The flight of a simulated engine's rocket, in the quantities of flight.json."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.unsteady import PAD, Burn, Engine
from hfanalysis.flight.coast import Leg, Parachute, coast, descend, fall, speed_of_sound
from hfanalysis.flight.constant_thrust import Vehicle, gravity
from hfanalysis.quantity import Quantity

Array = NDArray[np.float64]

ASCENT = {
    "apogee": "m",
    "time_to_apogee": "s",
    "rail_departure_velocity": "m/s",
    "peak_velocity": "m/s",
    "peak_mach": "",
    "peak_acceleration": "m/s^2",
}
"""What the ascent gives, with units."""

PARACHUTES = {
    "terminal_velocity_drogue": "m/s",
    "terminal_velocity_main": "m/s",
    "time_to_main": "s",
    "main_deployment_acceleration": "m/s^2",
    "landing_time": "s",
}
"""What the descent under parachutes gives, with units."""

NOT_FROM_PAD = "the rocket does not leave its pad"


@dataclass(frozen=True)
class Ascent:
    """Burn and coast together: time [s], altitude above the pad [m], speed along the flight path [m/s]."""

    time: Array
    height: Array
    speed: Array
    coasting: Leg


def ascend(engine: Engine, burnt: Burn) -> Ascent:
    """From ignition to apogee.

    Raises ValueError for a rocket that stays on its pad or leaves the atmosphere model.
    """
    altitude, speed = burnt.state("altitude"), burnt.state("speed")
    base = engine.vehicle.launch_altitude
    if not altitude.max() > base + PAD:
        raise ValueError(NOT_FROM_PAD)
    turned = np.flatnonzero((altitude > base + PAD) & (speed <= 0.0))
    if turned.size:
        return _until_turn(engine.vehicle, burnt, int(turned[0]))
    leg = coast(engine.vehicle, float(burnt.time[-1]), float(altitude[-1]), float(speed[-1]))
    joined = (
        np.concatenate([a, b[1:]]) for a, b in ((burnt.time, leg.time), (altitude, leg.altitude), (speed, leg.speed))
    )
    time, heights, speeds = joined
    return Ascent(time, heights - base, speeds, leg)


def _until_turn(vehicle: Vehicle, burnt: Burn, last: int) -> Ascent:
    """The ascent of a rocket that turns while its engine still runs; the speed is linear over the last step."""
    time, altitude, speed = (a[: last + 1].copy() for a in (burnt.time, burnt.state("altitude"), burnt.state("speed")))
    fall = speed[-2] - speed[-1]
    rest = (time[-1] - time[-2]) * speed[-2] / fall if fall > 0.0 else 0.0
    time[-1] = time[-2] + rest
    altitude[-1] = altitude[-2] + 0.5 * speed[-2] * rest * cos(vehicle.launch_angle)
    speed[-1] = 0.0
    leg = Leg(time[-2:], altitude[-2:], speed[-2:])
    return Ascent(time, altitude - vehicle.launch_altitude, speed, leg)


def flight(
    engine: Engine, burnt: Burn, rail_length: float | None, canopies: tuple[Parachute, Parachute] | str
) -> dict[str, Quantity]:
    """The quantities of a flight; each that cannot be had says why."""
    try:
        flown = ascend(engine, burnt)
    except ValueError as error:
        return absent(str(error))
    return {
        **_ascent(engine.vehicle, burnt, flown, rail_length),
        **_descent(engine.vehicle, flown.coasting, canopies),
        "impact_velocity_ballistic": _ballistic(engine.vehicle, flown.coasting),
    }


def absent(reason: str) -> dict[str, Quantity]:
    """The quantities of a flight that does not take place."""
    return {name: Quantity.absent(reason) for name in (*ASCENT, *PARACHUTES, "impact_velocity_ballistic")}


def _ascent(vehicle: Vehicle, burnt: Burn, flown: Ascent, rail_length: float | None) -> dict[str, Quantity]:
    mach = max(v / speed_of_sound(z + vehicle.launch_altitude) for v, z in zip(flown.speed, flown.height, strict=True))
    values = {
        "apogee": float(flown.height[-1]),
        "time_to_apogee": float(flown.time[-1]),
        "peak_velocity": float(flown.speed.max()),
        "peak_mach": float(mach),
        "peak_acceleration": float(burnt.output("acceleration").max()),
    }
    found = {name: Quantity(value, ASCENT[name]) for name, value in values.items()}
    found["rail_departure_velocity"] = rail_departure(vehicle, flown, rail_length)
    return {name: found[name] for name in ASCENT}


def rail_departure(vehicle: Vehicle, flown: Ascent, rail_length: float | None) -> Quantity:
    """Speed [m/s] at the end of the rail, v^2 taken linear in the way between the solver's steps."""
    if rail_length is None:
        return Quantity.absent("rocket.rail_length is not given")
    climb = cos(vehicle.launch_angle)
    rising = np.maximum.accumulate(flown.height)
    if not rising[-1] >= rail_length * climb:
        return Quantity.absent("the rocket does not reach the end of its rail")
    return Quantity(float(np.sqrt(np.interp(rail_length * climb, rising, flown.speed**2))), "m/s")


def _descent(vehicle: Vehicle, leg: Leg, canopies: tuple[Parachute, Parachute] | str) -> dict[str, Quantity]:
    if isinstance(canopies, str):
        return {name: Quantity.absent(canopies) for name in PARACHUTES}
    down = descend(vehicle, leg.end, *canopies)
    values = {
        "terminal_velocity_drogue": down.drogue_speed,
        "terminal_velocity_main": down.landing_speed,
        "time_to_main": down.time_of_main,
        "main_deployment_acceleration": down.main_load * gravity(0.0),
        "landing_time": down.landing_time,
    }
    return {name: Quantity(float(value), PARACHUTES[name]) for name, value in values.items()}


def _ballistic(vehicle: Vehicle, leg: Leg) -> Quantity:
    time, top, _ = leg.end
    return Quantity(-fall(vehicle, 0.0, (time, top, 0.0), vehicle.launch_altitude).end[2], "m/s")
