"""The chamber: gas of the masses that are stored, in equilibrium (report, section 3.1.3)."""

from __future__ import annotations

from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import Real, inlined, law
from hfanalysis.engine import equations as eq
from hfanalysis.engine import sites as at
from hfanalysis.engine.equations import Equations, asked, keep
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, SPECIFIC_NITROGEN
from hfanalysis.thermo.combustion import FORMATION_OFFSET
from hfanalysis.thermo.combustion_table import Grid, chamber_pressure

LEAST_GAS = 1e-9
"""Mass [kg] of burnt gas below which its mixture is no longer asked for."""

TYPICAL_RT = 0.9e6
"""R T [J/kg] of burnt gas, where the search for its pressure begins. Evidence: CEA gives 1.02e6 J/kg at 27.6 bar and
O/F 4.29, with the oxidizer's enthalpy as in PROPEP."""

COLD_GAMMA = 1.3
"""Heat capacity ratio of unburnt gas [-]. Source: ideal gases at 298 K: nitrous oxide has 1.27, nitrogen 1.40."""


@law
def chamber_volume(dead: Real, radius: Real, length: Real) -> Real:
    """Of the chamber with its port [m^3]: ``dead`` [m^3] before and behind the grain, the port's ``radius`` and
    ``length`` [m]."""
    return dead + pi * radius * radius * length


@inlined
def chamber(y: Array, m: Equations) -> None:
    """Pressure [Pa] and gas of the chamber into ENVIRONMENT, from the states ``y`` (states,) [SI]."""
    env = m.env
    volume = chamber_volume(m.c[eq.DEAD_VOLUME], y[eq.RADIUS], m.c[eq.GRAIN_LENGTH])
    h = m.c[eq.OXIDIZER_ENTHALPY]
    if np.isnan(h):
        h = y[eq.ENTHALPY] / max(y[eq.OXIDIZER], LEAST_GAS)
    p, rt, gamma, mass, ratio = gas_of(
        m, y[eq.OXIDIZER], y[eq.FUEL], y[eq.CHAMBER_NITROGEN], y[eq.COLD], y[eq.COLD_ENERGY], h, volume
    )
    env[at.P_CHAMBER], env[at.RT_CHAMBER], env[at.GAMMA_CHAMBER], env[at.OF_RATIO] = p, rt, gamma, ratio
    env[at.M_CHAMBER], env[at.H_CHAMBER], env[at.HOT_SHARE] = mass, h, 1.0 - max(y[eq.COLD], 0.0) / mass


@inlined
def gas_of(m: Equations, *question: float) -> tuple[float, float, float, float, float]:
    """:func:`chamber_gas` of the same numbers [SI], or what is kept of it."""
    kept, at = m.kept, eq.KEPT_CHAMBER + 7
    if asked(kept, eq.KEPT_CHAMBER, question):
        return kept[at], kept[at + 1], kept[at + 2], kept[at + 3], kept[at + 4]
    answer = chamber_gas(m.gas, *question)
    keep(kept, eq.KEPT_CHAMBER, question, answer)
    return answer


@inlined
def chamber_gas(
    gas: Grid, oxidizer: float, fuel: float, nitrogen: float, cold: float, cold_energy: float, h: float, volume: float
) -> tuple[float, float, float, float, float]:
    """p [Pa], R T [J/kg], gamma [-], mass [kg] and O/F [-] of what the chamber holds: burnt gas, later cold gas too.

    ``oxidizer``, ``fuel``, ``nitrogen`` and unburnt ``cold`` gas [kg]; ``cold_energy``: m R T of the latter [J]; ``h``:
    enthalpy of the nitrous oxide on the formation scale [J/kg]; ``volume`` [m^3]. p V = m R T (report, eq. 3.26).
    """
    entered = oxidizer + nitrogen
    hot = max(entered + fuel, LEAST_GAS)
    ratio = min(max(entered, LEAST_GAS) / max(fuel, LEAST_GAS), 1e4)
    share = nitrogen / max(entered, LEAST_GAS) if nitrogen > 0.0 else 0.0
    guess = hot * TYPICAL_RT / volume
    p, rt, gamma = chamber_pressure(gas, hot, volume, np.log(ratio), h, min(share, 1.0), guess)
    unburnt = max(cold, 0.0)
    mass = hot + unburnt
    if unburnt > 0.0:
        p += max(cold_energy, 0.0) / volume
        rt, gamma = p * volume / mass, (hot * gamma + unburnt * COLD_GAMMA) / mass
    return p, rt, gamma, mass, ratio


@inlined
def chamber_rates(y: Array, burning: bool, ejected: float, m: Equations, dy: Array) -> None:
    """Rates of what the chamber holds [SI/s] into ``dy`` (states,), of the nozzle's flow ``ejected`` [kg/s].

    What enters burns, or after burn-out stays cold; all leaves in the same proportion (report, eq. 3.24 and 3.25).
    """
    env, leaving = m.env, ejected / m.env[at.M_CHAMBER]
    into, share = m.site[at.OXIDIZER_SOURCE], env[at.NITROGEN_SHARE]
    for i in (eq.OXIDIZER, eq.CHAMBER_NITROGEN, eq.ENTHALPY, eq.COLD, eq.COLD_ENERGY, eq.FUEL):
        dy[i] = -leaving * y[i]
    if burning:
        into += env[at.OXIDIZER_FLOW] * (1.0 - share)
        dy[eq.CHAMBER_NITROGEN] += env[at.OXIDIZER_FLOW] * share
    else:
        constant = share * SPECIFIC_NITROGEN + (1.0 - share) * SPECIFIC_GAS_CONSTANT
        dy[eq.COLD] += env[at.OXIDIZER_FLOW]
        dy[eq.COLD_ENERGY] += env[at.OXIDIZER_FLOW] * constant * y[eq.TEMPERATURE]
    dy[eq.OXIDIZER] += into
    dy[eq.ENTHALPY] += into * (FORMATION_OFFSET + env[at.H_LEAVING])
    dy[eq.FUEL] += env[at.FUEL_FLOW]
