"""A rocket as the flight models take it, and the forces on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.thermo.air import air, air_of_day

EARTH_RADIUS = 6_371_000.0
"""Mean radius of the Earth [m]. Source: IUGG, 6371.0 km."""

STANDARD_GRAVITY = 9.80665
"""g at sea level [m/s^2]. Source: standard gravity, by definition."""


@dataclass(frozen=True)
class Vehicle:
    """Mass without propellant [kg], drag coefficient on the frontal area [m^2], angle from vertical [rad], site [m].

    ``drag_mach`` and ``drag_values``: the coefficient against Mach number, where one number for all is not enough; it
    then takes the place of ``drag_coefficient``. The day of the launch: how much ``warmer`` [K] the air is than the
    standard one, and its pressure at the site over the standard's [-].
    """

    dry_mass: float
    drag_coefficient: float
    frontal_area: float
    launch_angle: float
    launch_altitude: float
    drag_mach: tuple[float, ...] | None = None
    drag_values: tuple[float, ...] | None = None
    warmer: float = 0.0
    pressure_share: float = 1.0

    @property
    def drag_table(self) -> Array:
        """What :func:`drag_coefficient` reads, (2, n): Mach numbers and coefficients [-]; one column for a constant."""
        if self.drag_mach is None or self.drag_values is None:
            return np.array([[0.0], [self.drag_coefficient]])
        return np.array([self.drag_mach, self.drag_values])


@compiled
def drag_coefficient(mach: float, table: Array) -> float:
    """C_d [-] at a Mach number: linear between the columns of ``table`` (2, n) (Mach numbers, coefficients), its ends
    held.

    >>> round(drag_coefficient(0.4, np.array([[0.3, 0.5], [0.40, 0.42]])), 6)
    0.41
    """
    last = table.shape[1] - 1
    if last == 0 or mach <= table[0, 0]:
        return float(table[1, 0])
    if mach >= table[0, last]:
        return float(table[1, last])
    i = 0
    while i < last - 1 and table[0, i + 1] < mach:  # numba's np.searchsorted loads all of scipy.linalg
        i += 1
    share = (mach - table[0, i]) / (table[0, i + 1] - table[0, i])
    return float(table[1, i] + share * (table[1, i + 1] - table[1, i]))


@compiled
def drag_in(rho: float, sound: float, speed: float, area: float, table: Array) -> float:
    """D = 1/2 C_d A rho v |v| [N] (report, eq. 2.19), against the ``speed`` [m/s].

    ``rho`` of the air [kg/m^3] and its speed of ``sound`` [m/s], frontal ``area`` [m^2], ``table`` (2, n) of
    :func:`drag_coefficient`.
    """
    return 0.5 * drag_coefficient(abs(speed) / sound, table) * area * rho * speed * abs(speed)


@compiled
def drag(altitude: float, speed: float, area: float, table: Array) -> float:
    """D [N] of :func:`drag_in` the standard air at an ``altitude`` above sea level [m]."""
    _, rho, sound = air(altitude)
    return drag_in(rho, sound, speed, area, table)


def air_about(vehicle: Vehicle, altitude: float) -> tuple[float, float, float]:
    """Pressure [Pa], density [kg/m^3] and speed of sound [m/s] at an altitude above sea level [m] on the launch's
    day."""
    found = air_of_day(altitude, vehicle.launch_altitude, vehicle.warmer, vehicle.pressure_share)
    return float(found[0]), float(found[1]), float(found[2])


def gravity(altitude: float) -> float:
    """g = (r_E / (r_E + z))^2 g_SL [m/s^2] at an altitude above sea level [m] (report, eq. 2.21).

    >>> round(gravity(10000.0), 4)
    9.7759
    """
    return STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + altitude)) ** 2
