"""The heat that the model's simplifications imply: where its equations do not close in energy, how much is missing.

A polytropic vapor. What leaves takes its own entropy with it, so that V dp = k_s p V d ln rho + G Qdot dt, with the
isentropic exponent k_s and Grueneisen's G of the vapor with which it begins. A polytropic exponent k, dp = k p d ln
rho, takes Qdot = mdot (k_s - k) p V/(m G): none for k = k_s. Nitrogen in it, an ideal gas, adds its part to (dp/dT)_V,
to (dp/d ln rho)_T, and to the heat capacity, which give both G and k_s of the mixture.

A chamber in quasi-steady equilibrium. Its gas burns at constant pressure: m h is exactly what oxidizer and fuel bring
in less what leaves. The energy that is stored is U = m h - p V, the solid fuel's enthalpy being that of formation at
any pressure, and dU/dt = sum mdot h + Qdot leaves Qdot = -d(p V)/dt: over a run p V at its start less that at its end.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.chamber import chamber_volume
from hfanalysis.engine.tank import COLDEST_VAPOR, NITROGEN_CV, SPECIFIC_GAS_CONSTANT, SPECIFIC_NITROGEN, WARMEST_VAPOR
from hfanalysis.engine.unsteady import Burn
from hfanalysis.thermo.saturation import Saturation


def vapor_heat(burn: Burn) -> Array:
    """Heat flow into the tank's vapor [W], (n,) over ``burn.time``; 0 while there is liquid."""
    dry = burn.time > burn.liquid_out if burn.liquid_out is not None else np.zeros(burn.time.size, dtype=bool)
    if not dry.any():
        return np.zeros(burn.time.size)
    temperature, share = burn.state("tank_temperature"), burn.output("nitrogen_share")
    source, first = burn.steps.engine.saturation, float(np.clip(temperature[dry][0], COLDEST_VAPOR, WARMEST_VAPOR))
    cv, cp = source.heat_capacities(first)
    compressible = burn.state("vapor_compressibility") * SPECIFIC_GAS_CONSTANT

    def mixed(vapor: Array, nitrogen: float) -> Array:
        return (1.0 - share) * vapor + share * nitrogen

    constant, capacity = mixed(compressible, SPECIFIC_NITROGEN), mixed(cv, NITROGEN_CV)
    by_temperature = mixed(source.grueneisen(first) * cv, SPECIFIC_NITROGEN)
    by_density = mixed(compressible * source.isentropic_exponent(first) * cv / cp, SPECIFIC_NITROGEN)
    isentropic = (by_density + by_temperature**2 / capacity) / constant
    by_flow = temperature * constant * (isentropic - burn.state("vapor_exponent")) * capacity / by_temperature
    return np.where(dry, burn.output("tank_outflow") * by_flow, 0.0)


def vapor_heat_total(burn: Burn) -> float:
    """Integral of :func:`vapor_heat` [J]."""
    return float(np.trapezoid(vapor_heat(burn), burn.time))


def chamber_energy(burn: Burn) -> Array:
    """p V of the chamber [J], (n,) over ``burn.time``; its fall is the heat flow that the quasi-steady chamber
    implies."""
    engine = burn.steps.engine
    volume = chamber_volume(engine.dead_volume, burn.state("port_radius"), engine.grain_length)
    return np.asarray(burn.output("chamber_pressure") * volume)


def implied_heat(
    saturation: Saturation, exponent: float, mass_start: float, mass_end: float, temperature: float, z: float
) -> float:
    """Heat [J] that a polytropic vapor blowdown needs from outside (negative: must give away).

    From ``mass_start`` to ``mass_end`` [kg], beginning with saturated vapor at ``temperature`` [K]: the integral of
    (m_s - m) p V/G over -d ln M, p V = Z R T_v M_v (M/M_v)^m, with that vapor's isentropic exponent m_s and
    Grueneisen's G. The polytropic law itself does not conserve energy.
    """
    held = z * SPECIFIC_GAS_CONSTANT * temperature * mass_start
    too_small = float(saturation.isentropic_exponent(temperature)) - exponent
    less = float(np.log(mass_end / mass_start))
    leaves = -less * (float(np.expm1(exponent * less)) / (exponent * less) if exponent * less else 1.0)
    return float(held * too_small / float(saturation.grueneisen(temperature)) * leaves)
