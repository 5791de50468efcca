"""NASA's model of the atmosphere up to 30 km (Hall 2021; report, appendix A.2)."""

from __future__ import annotations

import math

from hfanalysis.thermo.constants import AIR_MOLAR_MASS, GAS_CONSTANT

HIGHEST = 30_000.0
"""Upper end of the model [m]. Source: report, appendix A.2; above 25 km the model's temperature rises without end."""


def temperature(altitude: float) -> float:
    """Air temperature [K] at an altitude above sea level [m].

    Raises ValueError above 30 km.

    >>> round(temperature(1402.0), 2)
    279.09
    """
    _check(altitude)
    if altitude < 11_000.0:
        return -0.00649 * altitude + 288.19
    if altitude < 25_000.0:
        return 216.69
    return 0.00299 * altitude + 141.94


def pressure(altitude: float) -> float:
    """Air pressure [Pa] at an altitude above sea level [m].

    Raises ValueError above 30 km.

    >>> round(pressure(1402.0) / 101325.0, 4)
    0.8462
    """
    t = temperature(altitude)
    if altitude < 11_000.0:
        return float(101_290.0 * (t / 288.08) ** 5.256)
    if altitude < 25_000.0:
        return 22_650.0 * math.exp(1.73 - 0.000157 * altitude)
    return float(2488.0 * (t / 216.6) ** -11.388)


def density(altitude: float) -> float:
    """Air density [kg/m^3] at an altitude above sea level [m]: rho = p W_a / (R_u T)."""
    return pressure(altitude) * AIR_MOLAR_MASS / (GAS_CONSTANT * temperature(altitude))


def altitude_of(ambient: float) -> float:
    """Altitude [m] whose air has a pressure [Pa], from 2 km below sea level to 20 km above.

    >>> round(altitude_of(pressure(1402.0)))
    1402
    """
    from scipy.optimize import brentq

    return float(brentq(lambda z: pressure(z) - ambient, -2000.0, 20_000.0, xtol=1e-6))


def _check(altitude: float) -> None:
    if not altitude <= HIGHEST:
        raise ValueError(f"the atmosphere model ends at {HIGHEST:.0f} m; asked for {altitude} m")
