"""Ascent under constant thrust and mass flow along a constant angle (report, section 2.1.4)."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from hfanalysis.thermo.air import air
from hfanalysis.thermo.atmosphere import HIGHEST

Array = NDArray[np.float64]

EARTH_RADIUS = 6_371_000.0
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Vehicle:
    """Mass without propellant [kg], drag coefficient on the frontal area [m^2], angle from vertical [rad], site [m].

    ``drag_mach`` and ``drag_values``: the coefficient against Mach number, where one number for all is not enough; it
    then takes the place of ``drag_coefficient``.
    """

    dry_mass: float
    drag_coefficient: float
    frontal_area: float
    launch_angle: float
    launch_altitude: float
    drag_mach: tuple[float, ...] | None = None
    drag_values: tuple[float, ...] | None = None

    @property
    def drag_table(self) -> Array:
        """What :func:`drag_coefficient` reads: rows of Mach numbers and of coefficients; one column for a constant."""
        if self.drag_mach is None or self.drag_values is None:
            return np.array([[0.0], [self.drag_coefficient]])
        return np.array([self.drag_mach, self.drag_values])


@njit(cache=True)
def drag_coefficient(mach: float, table: Array) -> float:
    """C_d at a Mach number: linear between the table's columns (Mach numbers, coefficients), its ends held.

    >>> drag_coefficient(0.4, np.array([[0.3, 0.5], [0.40, 0.42]]))
    0.41
    """
    last = table.shape[1] - 1
    if mach <= table[0, 0]:
        return float(table[1, 0])
    if mach >= table[0, last]:
        return float(table[1, last])
    i = int(np.searchsorted(table[0], mach)) - 1
    share = (mach - table[0, i]) / (table[0, i + 1] - table[0, i])
    return float(table[1, i] + share * (table[1, i + 1] - table[1, i]))


@njit(cache=True)
def drag(altitude: float, speed: float, area: float, table: Array) -> float:
    """D = 1/2 C_d A rho v |v| [N] on the frontal area [m^2], against the speed [m/s]."""
    _, rho, sound = air(altitude)
    return 0.5 * drag_coefficient(abs(speed) / sound, table) * area * rho * speed * abs(speed)


def gravity(altitude: float) -> float:
    """g = (r_E / (r_E + z))^2 g_SL [m/s^2] at an altitude above sea level [m]."""
    return STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + altitude)) ** 2


def apogee(vehicle: Vehicle, thrust: float, mass_flow: float, burn_time: float) -> float:
    """Highest point above the launch site [m] with ``thrust`` [N] and ``mass_flow`` [kg/s] over ``burn_time`` [s].

    Returns 0 for a rocket that does not leave the pad; raises ValueError where it leaves the atmosphere model (30 km).
    """
    start = vehicle.dry_mass + mass_flow * burn_time
    if thrust <= start * gravity(vehicle.launch_altitude) * cos(vehicle.launch_angle):
        return 0.0

    table, climb = vehicle.drag_table, cos(vehicle.launch_angle)

    def rates(t: float, state: Array) -> list[float]:
        altitude, speed = float(state[0]), float(state[1])
        burning = t < burn_time
        mass = start - mass_flow * t if burning else vehicle.dry_mass
        push = thrust if burning else 0.0
        push -= drag(altitude, speed, vehicle.frontal_area, table)
        return [speed * climb, push / mass - gravity(altitude) * climb]

    def stops(t: float, state: Array) -> float:
        return float(state[1]) if t > 1e-6 else 1.0

    stops.terminal = True  # type: ignore[attr-defined]
    burn = solve_ivp(rates, (0.0, burn_time * (1.0 - 1e-12)), [vehicle.launch_altitude, 0.0], rtol=1e-9, atol=1e-6)
    coast = solve_ivp(rates, (burn_time, burn_time + 600.0), burn.y[:, -1], events=stops, rtol=1e-9, atol=1e-6)
    top = float(coast.y[0, -1])
    if top >= HIGHEST:
        raise ValueError(f"the rocket leaves the atmosphere model: above {HIGHEST:.0f} m")
    return top - vehicle.launch_altitude
