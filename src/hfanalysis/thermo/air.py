"""The atmosphere of :mod:`hfanalysis.thermo.atmosphere` for compiled code, held at its upper end above 30 km."""

from __future__ import annotations

import numpy as np

from hfanalysis.compiled import compiled
from hfanalysis.thermo.atmosphere import HIGHEST
from hfanalysis.thermo.constants import AIR_MOLAR_MASS, GAS_CONSTANT

AIR_GAMMA = 1.4
"""Heat capacity ratio of air [-]. Source: a diatomic ideal gas has 7/5."""


@compiled
def air(altitude: float) -> tuple[float, float, float]:
    """Pressure [Pa], density [kg/m^3] and speed of sound [m/s] at an altitude above sea level [m].

    >>> round(air(1402.0)[2], 1)
    334.9
    """
    z = min(altitude, HIGHEST)
    if z < 11_000.0:
        t = -0.00649 * z + 288.19
        p = 101_290.0 * (t / 288.08) ** 5.256
    elif z < 25_000.0:
        t = 216.69
        p = 22_650.0 * np.exp(1.73 - 0.000157 * z)
    else:
        t = 0.00299 * z + 141.94
        p = 2488.0 * (t / 216.6) ** -11.388
    specific = GAS_CONSTANT / AIR_MOLAR_MASS * t
    return p, p / specific, np.sqrt(AIR_GAMMA * specific)


TROPOPAUSE, LAPSE, AT_SEA, POWER = 11_000.0, 0.00649, 288.19, 5.256
"""Height [m], lapse rate [K/m], temperature at sea level [K] and the pressure's power [-] of the lowest layer. Source:
the atmosphere's own."""


@compiled
def air_of_day(altitude: float, ground: float, warmer: float, share: float) -> tuple[float, float, float]:
    """As :func:`air`, on a day that is ``warmer`` [K] at all altitudes, with ``share`` [-] of the usual pressure at the
    ``ground`` [m above sea level].

    Warm air is thinner and loses its pressure more slowly with height: in the lowest layer p goes with T^5.256.

    >>> air_of_day(3000.0, 1402.0, 0.0, 1.0) == air(3000.0)
    True
    >>> round(air_of_day(1402.0, 1402.0, 15.0, 1.0)[1] / air(1402.0)[1], 4) == round(279.09 / 294.09, 4)
    True
    """
    p, rho, sound = air(altitude)
    if warmer == 0.0 and share == 1.0:
        return p, rho, sound
    here, there = AT_SEA - LAPSE * min(altitude, TROPOPAUSE), AT_SEA - LAPSE * min(ground, TROPOPAUSE)
    factor = share * ((here + warmer) / here * there / (there + warmer)) ** POWER
    usual = sound * sound * AIR_MOLAR_MASS / (AIR_GAMMA * GAS_CONSTANT)
    heat = (usual + warmer) / usual
    return p * factor, rho * factor / heat, sound * np.sqrt(heat)
