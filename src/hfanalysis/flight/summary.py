"""The quantities of flight.json: a flight from its pad to the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.flight.ascent import ACCELERATION, APOGEE, MACH, RAIL, SPEED, TIME, Ascent
from hfanalysis.flight.descent import Descent, descend, fall
from hfanalysis.quantity import Quantity
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY, Vehicle

ASCENT = {
    "apogee": (APOGEE, "m"),
    "time_to_apogee": (TIME, "s"),
    "rail_departure_velocity": (RAIL, "m/s"),
    "peak_velocity": (SPEED, "m/s"),
    "peak_mach": (MACH, ""),
    "peak_acceleration": (ACCELERATION, "m/s^2"),
}
"""What the ascent gives: which of its results, and the unit."""

PARACHUTES = {
    "terminal_velocity_drogue": "m/s",
    "terminal_velocity_main": "m/s",
    "time_to_main": "s",
    "main_deployment_acceleration": "m/s^2",
    "landing_time": "s",
}
"""What the descent under parachutes gives, with units."""

NO_RAIL = "rocket.rail_length is not given"
RAIL_TOO_LONG = "the rocket does not reach the end of its rail"


@dataclass(frozen=True)
class FlightSpread:
    """What drawn flights say of one quantity: standard deviation and 95 % interval."""

    std: float
    ci95: tuple[float, float]

    def about(self, value: float, unit: str) -> Quantity:
        """A ``value`` [``unit``] with it; an interval that the value does not lie in, since what it may be is drawn
        around others too, reaches out to it."""
        low, high = self.ci95
        return Quantity(value, unit, self.std, (min(low, value), max(high, value)))


def quantities(
    vehicle: Vehicle,
    flown: Ascent,
    rail_length: float | None,
    canopies: tuple[Parachute, Parachute] | str,
    spreads: dict[str, FlightSpread] | None = None,
) -> dict[str, Quantity]:
    """Every quantity of a flight that took place, each with its unit [m, s, m/s, m/s^2]; what cannot be had says why.

    ``rail_length`` [m] (None: not known), ``canopies`` or why there are none, ``spreads`` of the ascent's quantities.
    """
    known = spreads or {}
    found = {name: _of_ascent(flown, name, known.get(name)) for name in ASCENT}
    if rail_length is None:
        found["rail_departure_velocity"] = Quantity.absent(NO_RAIL)
    down = None if isinstance(canopies, str) else descend(vehicle, flown.end, *canopies)
    return {**found, **(absent_descent(canopies) if down is None else _of_descent(down)), **_ballistic(vehicle, flown)}


def absent(reason: str) -> dict[str, Quantity]:
    """The quantities of a flight that does not take place."""
    return {name: Quantity.absent(reason) for name in (*ASCENT, *PARACHUTES, "impact_velocity_ballistic")}


def absent_descent(reason: object) -> dict[str, Quantity]:
    """The quantities of a descent without parachutes."""
    return {name: Quantity.absent(str(reason)) for name in PARACHUTES}


def _of_ascent(flown: Ascent, name: str, spread: FlightSpread | None) -> Quantity:
    index, unit = ASCENT[name]
    value = float(flown.results[index])
    if np.isnan(value):
        return Quantity.absent(RAIL_TOO_LONG)
    return Quantity(value, unit) if spread is None else spread.about(value, unit)


def _of_descent(down: Descent) -> dict[str, Quantity]:
    values = {
        "terminal_velocity_drogue": down.drogue_speed,
        "terminal_velocity_main": down.landing_speed,
        "time_to_main": down.time_of_main,
        "main_deployment_acceleration": down.main_load * STANDARD_GRAVITY,
        "landing_time": down.landing_time,
    }
    return {name: Quantity(float(value), PARACHUTES[name]) for name, value in values.items()}


def _ballistic(vehicle: Vehicle, flown: Ascent) -> dict[str, Quantity]:
    time, top, _ = flown.end
    speed = -fall(vehicle, 0.0, (time, top, 0.0), vehicle.launch_altitude).end[2]
    return {"impact_velocity_ballistic": Quantity(speed, "m/s")}
