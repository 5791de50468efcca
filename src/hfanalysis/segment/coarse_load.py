"""Whether a t_v fits the stated load and injector: what would have to flow for it, coarsely."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.nitrous import saturation

LARGEST_COEFFICIENT = 1.2
"""C_i [-] above which a t_v is impossible: no orifice passes more than its area; a fifth is for what is coarse."""

SMALLEST_LIQUID = 0.5
"""Least part of a load that leaves as liquid, for a tank that is filled by a fifth or more."""


@dataclass(frozen=True)
class CoarseLoad:
    """Least ``mass`` [kg] that leaves as liquid, the injector's ``area`` [m^2], the liquid's ``density`` [kg/m^3], and
    the pressures [Pa] that drive it."""

    mass: float
    area: float
    density: float
    signals: Mapping[str, Signal]

    def contradicts(self, t_v: float) -> bool:
        """Whether so short a liquid phase [s] needs an injector that cannot be."""
        before = self.signals["p_run" if "p_run" in self.signals else "p_tank"].mean(0.3 * t_v, t_v)
        drop = before - self.signals["p_chamber"].mean(0.3 * t_v, t_v)
        if not drop > 0.0:
            return False
        flow = self.area * float(np.sqrt(2.0 * self.density * drop))
        return self.mass > LARGEST_COEFFICIENT * flow * t_v


def coarse_load(definition: TestDefinition, signals: Mapping[str, Signal]) -> CoarseLoad | None:
    """From what test.toml states; None where load, injector or chamber pressure are not known."""
    tank, area = definition.tank, definition.injector.area if definition.injector is not None else None
    if tank is None or tank.oxidizer_mass is None or area is None or "p_chamber" not in signals:
        return None
    mass = tank.oxidizer_mass
    source = saturation(definition.model.properties)
    start = min(signals["p_tank"].mean(-2.0, -0.05), 0.95 * source.pressure_range[1])
    if not np.isfinite(start) or start < source.pressure_range[0]:
        return None
    density = float(source.liquid_density(float(source.temperature(start))))
    least = SMALLEST_LIQUID * max(mass.value - 2.0 * (mass.std or 0.0), 0.0)
    return CoarseLoad(least, area.value, density, signals)
