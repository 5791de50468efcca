"""A parachute as the descent takes it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Parachute:
    """Drag coefficient on its area [m^2]; ``deploy_altitude`` above ground [m] (None: opens at apogee)."""

    drag_coefficient: float
    area: float
    deploy_altitude: float | None = None
