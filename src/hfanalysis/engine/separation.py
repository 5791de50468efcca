"""A nozzle whose flow leaves the wall where the pressure outside pushes it off.

An overexpanded jet does not follow the wall until a normal shock: its boundary layer separates as soon as the wall's
pressure has fallen to some part of the ambient one (Summerfield, Foster and Swan, Flow separation in overexpanded
supersonic exhaust nozzles, Jet Propulsion 24, 1954: 0.4; Schmucker, Flow processes in overexpanded chemical rocket
nozzles, NASA TM-77396, 1984: by the Mach number). Behind that place the wall is at ambient pressure, so that the
nozzle thrusts as one that ends there. Both criteria were measured at p_c/p_a from about 10 on.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled, law
from hfanalysis.engine.nozzle import SUPERSONIC, area_ratio, ejected, expand, mach_at_area, pressure_ratio

ONE_DIMENSIONAL, SEPARATED = 0, 1
"""Indices of LAWS."""

Law = Literal["one-dimensional", "separated"]
LAWS: tuple[Law, ...] = ("one-dimensional", "separated")
"""Laws of the nozzle: a normal shock in the diverging part, or a flow that separates."""

SLOPE, POWER = 1.88, 0.64
"""Of p_sep / p_a = (1.88 M - 1)^-0.64 [-]. Source: Schmucker, NASA TM-77396, 1984."""

NEAR_THROAT = 1.1
"""Mach number [-] below which the flow leaves the wall at the throat. Evidence: Schmucker's pressure falls as fast as
the flow's own there, the area is within 1 % of the throat's, and the thrust within 0.1 %."""

HALVINGS = 24
"""Halvings of the Mach number's range: to 1e-7 [-]. Source: by choice."""


@law
def separation_pressure(mach: float) -> float:
    """p_sep / p_a [-]: of the wall where a flow of this Mach number separates (Schmucker).

    >>> round(separation_pressure(2.3), 3), round(separation_pressure(2.75), 2)
    (0.464, 0.4)
    """
    return float((SLOPE * mach - 1.0) ** -POWER)


@compiled
def expand_by(
    law: int, gamma: float, specific_temperature: float, pressure: float, ambient: float, throat: float, leave: float
) -> tuple[float, float, float, float, int]:
    """As :func:`hfanalysis.engine.nozzle.expand`, by one of LAWS: Mach number and pressure are those where the flow
    leaves the wall.

    R T of the chamber gas [J/kg], pressures [Pa], areas of throat and exit [m^2].
    """
    if law == ONE_DIMENSIONAL or not pressure > ambient:
        return expand(gamma, specific_temperature, pressure, ambient, throat, leave)
    full = mach_at_area(leave / throat, gamma, True)
    if full <= 1.0 or pressure * pressure_ratio(full, gamma) >= ambient * (SLOPE * full - 1.0) ** -POWER:
        return expand(gamma, specific_temperature, pressure, ambient, throat, leave)
    if pressure * pressure_ratio(NEAR_THROAT, gamma) <= ambient * (SLOPE * NEAR_THROAT - 1.0) ** -POWER:
        return expand(gamma, specific_temperature, pressure, ambient, throat, throat)
    attached, off = NEAR_THROAT, full
    for _ in range(HALVINGS):
        mach = 0.5 * (attached + off)
        if pressure * pressure_ratio(mach, gamma) > ambient * (SLOPE * mach - 1.0) ** -POWER:
            attached = mach
        else:
            off = mach
    mach = 0.5 * (attached + off)
    area = throat * area_ratio(mach, gamma)
    wall = pressure * pressure_ratio(mach, gamma)
    return ejected(gamma, specific_temperature, pressure, ambient, area, mach, wall, SUPERSONIC)


@compiled
def thrusts(law: int, gamma: Array, pressure: Array, ambient: float, throat: float, leave: float) -> Array:
    """Thrust [N] at every chamber ``pressure`` [Pa] and heat capacity ratio [-], (n,) each, by one of LAWS.

    ``ambient`` [Pa], areas [m^2]. It does not depend on the gas's temperature.
    """
    out = np.empty(pressure.size)
    for i in range(pressure.size):
        out[i] = expand_by(law, gamma[i], 1e6, pressure[i], ambient, throat, leave)[1]
    return out


def onset(gamma: float, ambient: float, throat: float, leave: float) -> float:
    """Chamber pressure [Pa] below which the flow separates from a nozzle of these areas [m^2].

    >>> round(onset(1.25, 101325.0, 1.0, 2.674) / 1e5, 1)
    6.4
    """
    full = float(mach_at_area(leave / throat, gamma, True))
    return ambient * separation_pressure(full) / float(pressure_ratio(full, gamma))
