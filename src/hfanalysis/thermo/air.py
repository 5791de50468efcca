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
