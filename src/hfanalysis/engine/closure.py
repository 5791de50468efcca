"""The heat that the model's simplifications imply: where its equations do not close in energy, how much is missing.

A polytropic vapour. With u of the vapour, dU = m c_v dT - u mdot dt, and what leaves takes h = u + Z R T with it, so
that dU/dt = -mdot h + Qdot gives Qdot = m c_v dT/dt + mdot Z R T. With the polytropic dT/dt = -T (k - 1) mdot / m of an
exponent k that is Qdot = mdot T (Z R - c_v (k - 1)): none for k = 1 + Z R / c_v.

A chamber in quasi-steady equilibrium. Its gas burns at constant pressure: m h is exactly what oxidizer and fuel bring
in less what leaves. The energy that is stored is U = m h - p V, the solid fuel's enthalpy being that of formation at
any pressure, and dU/dt = sum mdot h + Qdot leaves Qdot = -d(p V)/dt: over a run p V at its start less that at its end.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.model import COLDEST_VAPOR, NITROGEN_CV, SPECIFIC_NITROGEN, WARMEST_VAPOR
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT
from hfanalysis.engine.unsteady import Burn

Array = NDArray[np.float64]


def vapor_heat(burn: Burn) -> Array:
    """Heat flow into the tank's vapour [W] over ``burn.time``; 0 while there is liquid."""
    dry = burn.time > burn.liquid_out if burn.liquid_out is not None else np.zeros(burn.time.size, dtype=bool)
    temperature, share = burn.state("tank_temperature"), burn.output("nitrogen_share")
    inside = np.clip(temperature, COLDEST_VAPOR, WARMEST_VAPOR)
    cv = (1.0 - share) * burn.steps.engine.saturation.heat_capacities(inside)[0] + share * NITROGEN_CV
    compressible = burn.state("vapor_compressibility") * SPECIFIC_GAS_CONSTANT
    constant = (1.0 - share) * compressible + share * SPECIFIC_NITROGEN
    by_flow = temperature * (constant - cv * (burn.state("vapor_exponent") - 1.0))
    return np.where(dry, burn.output("tank_outflow") * by_flow, 0.0)


def vapor_heat_total(burn: Burn) -> float:
    """Integral of :func:`vapor_heat` [J]."""
    return float(np.trapezoid(vapor_heat(burn), burn.time))


def chamber_energy(burn: Burn) -> Array:
    """p V of the chamber [J] over ``burn.time``; its fall is the heat flow that the quasi-steady chamber implies."""
    engine = burn.steps.engine
    volume = engine.dead_volume + pi * burn.state("port_radius") ** 2 * engine.grain_length
    return np.asarray(burn.output("chamber_pressure") * volume)
