"""From apogee to the ground: drogue, main parachute, ballistic case (report, section 3.1.5)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from scipy.integrate import solve_ivp

from hfanalysis.arrays import Array
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY, Vehicle, air_about, drag_in, gravity

Rates = Callable[[float, Array], list[float]]
LONGEST_FALL = 3600.0
"""Longest part of a descent [s]."""


@dataclass(frozen=True)
class Leg:
    """One part of a descent: time [s], altitude above sea level [m], speed [m/s] (upwards positive)."""

    time: Array
    altitude: Array
    speed: Array

    @property
    def end(self) -> tuple[float, float, float]:
        """Last time [s], altitude above sea level [m] and speed [m/s]."""
        return float(self.time[-1]), float(self.altitude[-1]), float(self.speed[-1])


def fall(vehicle: Vehicle, drag_area: float, start: tuple[float, float, float], floor: float) -> Leg:
    """Fall from (time [s], altitude [m], speed [m/s]) to an altitude ``floor`` [m] (report, eq. 3.48 to 3.50).

    ``drag_area``: C_d A [m^2] beside the rocket's own.
    """
    area, table = vehicle.frontal_area, vehicle.drag_table

    def rates(_t: float, y: Array) -> list[float]:
        _, rho, sound = air_about(vehicle, y[0])
        canopy = 0.5 * drag_area * rho * y[1] * abs(y[1])
        return [y[1], -gravity(y[0]) - (canopy + drag_in(rho, sound, y[1], area, table)) / vehicle.dry_mass]

    return _until(rates, start, lambda y: y[0] - floor)


def _until(rates: Rates, start: tuple[float, float, float], gone: Callable[[Array], float]) -> Leg:
    def event(_t: float, y: Array) -> float:
        return gone(y)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1  # type: ignore[attr-defined]
    span = (start[0], start[0] + LONGEST_FALL)
    out = solve_ivp(rates, span, list(start[1:]), method="LSODA", events=event, rtol=1e-9, atol=1e-7, max_step=1.0)
    return Leg(out.t, out.y[0], out.y[1])


@dataclass(frozen=True)
class Descent:
    """Under parachutes and without: speeds [m/s] downwards positive, times [s], the main's opening load in g."""

    time_of_main: float
    drogue_speed: float
    landing_speed: float
    landing_time: float
    main_load: float
    ballistic_speed: float
    legs: tuple[Leg, ...]


def descend(vehicle: Vehicle, apogee: tuple[float, float, float], drogue: Parachute, main: Parachute) -> Descent:
    """From apogee (time [s], altitude above sea level [m], speed [m/s]) to the ground (report, section 3.1.5).

    A main opens at its deploy altitude or below. One without a deploy altitude, or one that is above the apogee, opens
    at apogee; the drogue then does nothing.
    """
    ground = vehicle.launch_altitude
    top = (apogee[0], apogee[1], 0.0)
    deploy = apogee[1] if main.deploy_altitude is None else min(ground + main.deploy_altitude, apogee[1])
    first = fall(vehicle, drogue.drag_coefficient * drogue.area, top, deploy)
    second = fall(vehicle, main.drag_coefficient * main.area, first.end, ground)
    ballistic = fall(vehicle, 0.0, top, ground)
    _, rho, sound = air_about(vehicle, deploy)
    canopy = 0.5 * main.drag_coefficient * main.area * rho * first.end[2] ** 2
    own = drag_in(rho, sound, -first.end[2], vehicle.frontal_area, vehicle.drag_table)
    load = (canopy + own) / vehicle.dry_mass - gravity(deploy)
    return Descent(
        time_of_main=first.end[0],
        drogue_speed=-first.end[2],
        landing_speed=-second.end[2],
        landing_time=second.end[0],
        main_load=load / STANDARD_GRAVITY,
        ballistic_speed=-ballistic.end[2],
        legs=(first, second, ballistic),
    )
