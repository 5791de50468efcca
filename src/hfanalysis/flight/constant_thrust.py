"""Ascent under constant thrust and mass flow along a constant angle (report, section 2.1.4)."""

from __future__ import annotations

import numpy as np

from hfanalysis.flight.ascent import NOT_FROM_PAD, ascend
from hfanalysis.flight.curve import Curve
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, Vehicle, drag_coefficient, gravity

__all__ = ["EARTH_RADIUS", "STANDARD_GRAVITY", "Vehicle", "apogee", "drag_coefficient", "gravity"]

STEPS = 400
"""Steps of the burn."""


def apogee(vehicle: Vehicle, thrust: float, mass_flow: float, burn_time: float) -> float:
    """Highest point above the launch site [m] with ``thrust`` [N] and ``mass_flow`` [kg/s] over ``burn_time`` [s].

    Returns 0 for a rocket that does not leave the pad; raises ValueError where it leaves the atmosphere model (30 km).
    """
    left = np.linspace(mass_flow * burn_time, 0.0, STEPS + 1)
    curve = Curve(burn_time / STEPS, np.full(STEPS + 1, thrust), vehicle.dry_mass + left, vehicle.dry_mass)
    try:
        return ascend(curve, vehicle).height
    except ValueError as error:
        if str(error) == NOT_FROM_PAD:
            return 0.0
        raise
