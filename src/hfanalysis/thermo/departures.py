"""By how much another table of saturated nitrous oxide may differ from the one that is used.

Two independent sources, Lemmon and Span's equation of state and the correlations of ESDU 91022, differ from 245 to
300 K by 0.14 to 0.24 % in vapor pressure, 0.4 % to either side in the liquid's density, 0.4 to 1 % in the vapor's,
and 0.2 to 0.9 % in the latent heat (docs/properties.md). The truth is taken to lie between them: half their difference,
as a level and as what changes over 25 K, is one standard deviation here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from hfanalysis.thermo.saturation import Property, Saturation

MIDDLE, OVER = 275.0, 25.0
"""Temperature [K] about which a departure grows, and the kelvins over which it does by its size. Source:
docs/properties.md compares two tables from 245 to 300 K."""

LOWEST, HIGHEST = -2.0, 1.4
"""Between these multiples of OVER [-]: 225 to 310 K. Source: near the critical point (309.5 K) nobody asks."""


@dataclass(frozen=True)
class Departure:
    """A relative error of one property: ``level`` everywhere, ``slope`` more for every OVER kelvins above MIDDLE."""

    name: str
    of: Literal["pressure", "liquid", "vapor", "latent heat"]
    level: float = 0.0
    slope: float = 0.0


DEPARTURES = (
    Departure("pressure", "pressure", level=7.5e-4),
    Departure("pressure's slope", "pressure", slope=2.5e-4),
    Departure("liquid's volume", "liquid", level=5e-4),
    Departure("liquid's expansion", "liquid", slope=1.25e-3),
    Departure("vapour's volume", "vapor", level=1.5e-3),
    Departure("vapour's expansion", "vapor", slope=1.5e-3),
    Departure("latent heat", "latent heat", level=1.25e-3),
    Departure("latent heat's slope", "latent heat", slope=7.5e-4),
)
"""One standard deviation of each [-], independent of the others. Evidence: half of what ESDU 91022 and Lemmon and Span
differ by (docs/properties.md)."""


def departed(saturation: Saturation, by: Departure) -> Saturation:
    """The same nitrous oxide by a table that differs by one standard deviation."""
    theta, values = saturation.samples()
    temperature = saturation.critical_temperature * (1.0 - theta**3)
    relative = by.level + by.slope * np.clip((temperature - MIDDLE) / OVER, LOWEST, HIGHEST)
    if by.of == "pressure":
        changed = {Property.LN_PRESSURE: values[Property.LN_PRESSURE] + np.log1p(relative)}
    elif by.of == "liquid":
        changed = {Property.LIQUID_VOLUME: values[Property.LIQUID_VOLUME] * (1.0 + relative)}
    elif by.of == "vapor":
        changed = {Property.LN_VAPOR_VOLUME: values[Property.LN_VAPOR_VOLUME] + np.log1p(relative)}
    else:
        more = relative * (values[Property.VAPOR_ENTHALPY] - values[Property.LIQUID_ENTHALPY])
        changed = {p: values[p] + more for p in (Property.VAPOR_ENERGY, Property.VAPOR_ENTHALPY)}
    return Saturation.from_samples(saturation.source, theta, values | changed, saturation.critical_temperature)
