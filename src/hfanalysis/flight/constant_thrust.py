"""Ascent under constant thrust and mass flow along a constant angle (report, section 2.1.4)."""

from __future__ import annotations

import numpy as np

from hfanalysis.flight.ascent import NOT_FROM_PAD, RAIL, ascend
from hfanalysis.flight.curve import Curve
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, Vehicle, drag_coefficient, gravity

__all__ = ["EARTH_RADIUS", "STANDARD_GRAVITY", "Vehicle", "apogee", "drag_coefficient", "gravity", "rail_speed"]

STEPS = 400
"""Steps of the burn."""


def apogee(vehicle: Vehicle, thrust: float, mass_flow: float, burn_time: float) -> float:
    """Highest point above the launch site [m] with ``thrust`` [N] and ``mass_flow`` [kg/s] over ``burn_time`` [s].

    Returns 0 for a rocket that does not leave the pad; raises ValueError where it leaves the atmosphere model (30 km).
    """
    try:
        return ascend(_curve(vehicle, thrust, mass_flow, burn_time), vehicle).height
    except ValueError as error:
        if str(error) == NOT_FROM_PAD:
            return 0.0
        raise


def rail_speed(vehicle: Vehicle, thrust: float, mass_flow: float, burn_time: float, rail_length: float) -> float:
    """Speed [m/s] at the end of a rail of ``rail_length`` [m], other arguments as of :func:`apogee`.

    NaN where its end is not reached; raises ValueError for a rocket that does not leave its pad or the atmosphere.
    """
    return float(ascend(_curve(vehicle, thrust, mass_flow, burn_time), vehicle, rail_length).results[RAIL])


def _curve(vehicle: Vehicle, thrust: float, mass_flow: float, burn_time: float) -> Curve:
    left = np.linspace(mass_flow * burn_time, 0.0, STEPS + 1)
    return Curve(burn_time / STEPS, np.full(STEPS + 1, thrust), vehicle.dry_mass + left, vehicle.dry_mass)
