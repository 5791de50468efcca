"""Ascent under constant thrust and mass flow along a constant angle (report, section 2.1.4)."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos

import numpy as np
from scipy.integrate import solve_ivp

from hfanalysis.thermo.atmosphere import HIGHEST, density

EARTH_RADIUS = 6_371_000.0
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Vehicle:
    """Mass without propellant [kg], drag coefficient on the frontal area [m^2], angle from vertical [rad], site [m]."""

    dry_mass: float
    drag_coefficient: float
    frontal_area: float
    launch_angle: float
    launch_altitude: float


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

    def rates(t: float, state: np.ndarray) -> list[float]:
        altitude, speed = min(float(state[0]), HIGHEST), float(state[1])
        burning = t < burn_time
        mass = start - mass_flow * t if burning else vehicle.dry_mass
        drag = 0.5 * vehicle.drag_coefficient * vehicle.frontal_area * density(altitude) * speed * abs(speed)
        push = thrust if burning else 0.0
        climb = cos(vehicle.launch_angle)
        return [speed * climb, (push - drag) / mass - gravity(altitude) * climb]

    def stops(t: float, state: np.ndarray) -> float:
        return float(state[1]) if t > 1e-6 else 1.0

    stops.terminal = True  # type: ignore[attr-defined]
    burn = solve_ivp(rates, (0.0, burn_time * (1.0 - 1e-12)), [vehicle.launch_altitude, 0.0], rtol=1e-9, atol=1e-6)
    coast = solve_ivp(rates, (burn_time, burn_time + 600.0), burn.y[:, -1], events=stops, rtol=1e-9, atol=1e-6)
    top = float(coast.y[0, -1])
    if top >= HIGHEST:
        raise ValueError(f"the rocket leaves the atmosphere model: above {HIGHEST:.0f} m")
    return top - vehicle.launch_altitude
