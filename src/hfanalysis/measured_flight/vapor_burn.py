"""The last of a burn, on the vapor that is left in the tank: what it gives where no purge gas follows it.

The tank's polytropic vapor flows through line and injector into a chamber that is quasi-steady (its gas stays some
2 ms), burns with the fuel that its flux frees, and leaves by the nozzle: the equations of the unsteady engine without
what the chamber stores.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.engine.chamber import COLD_GAMMA
from hfanalysis.engine.grain import flux_power, oxidizer_flux, ring
from hfanalysis.engine.injector import mass_flow
from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.separation import expand_by
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, polytropic
from hfanalysis.thermo.combustion_table import Grid, gas_at

STEP = 0.05
"""Step [s]. Evidence: the unsteady engine's impulse comes out to 2 % (test_without_purge.py)."""

LONGEST = 60.0
"""Longest time on vapor [s]."""

OUT = 0.005
"""Chamber above ambient pressure, relative [-], at which the thrust counts as gone. Evidence: HF5's nozzle has 5 N
there; at 0.04 it has 36 N, and ten seconds later 0.6 % more of the impulse."""

VAPOR_GAMMA = 1.2
"""Isentropic exponent of the vapor in the injector [-]. Evidence: nitrous oxide from 250 K to 290 K has 1.28 to 1.30 at
low pressure and 1.22 to 1.24 when saturated (CoolProp); the choked flow changes by 3 % from 1.1 to 1.3."""

CLOSE, MOST = 1.0, 40
"""[Pa] to which the chamber pressure is found, and in how many steps at most. Source: by choice."""

RATIOS = (0.4, 200.0)
"""Oxidizer to fuel [-] between which the gas is asked for. Source: the combustion table's own range, nearly."""


@dataclass(frozen=True)
class VaporBurn:
    """Where it begins, and through what it flows; SI units.

    ``mass``, ``pressure``, ``temperature``: the tank's vapor; ``exponent`` of it [-]; ``area`` effective, of the
    injector; ``share`` of the pressure drop from tank to chamber that is the injector's [-]; ``choked``: 1 where the
    vapor expands in the injector and may choke, 0 where it flows as if incompressible; ``a``, ``n`` of the fuel;
    ``radius`` of the port (``outer_radius``: the fuel is gone); ``law`` of the nozzle, as LAWS; ``efficiency``: factor
    on R T of the burnt gas; ``enthalpy`` of the oxidizer on the formation scale [J/kg].
    """

    mass: float
    pressure: float
    temperature: float
    exponent: float
    area: float
    share: float
    choked: float
    a: float
    n: float
    radius: float
    outer_radius: float
    grain_length: float
    fuel_density: float
    volume: float
    throat: float
    leave: float
    ambient: float
    law: float
    enthalpy: float
    efficiency: float = 1.0

    def run(self, gas: Grid) -> Course:
        """To the end of its thrust, LONGEST at most."""
        numbers = np.array([getattr(self, field.name) for field in fields(self)])
        out = np.empty((round(LONGEST / STEP) + 1, len(COLUMNS)))
        steps = _march(gas, numbers, out)
        time: Array = STEP * np.arange(steps, dtype=np.float64)
        return Course(time, *out[:steps].T)

    def inflow(self, gas: Grid, chamber: float) -> tuple[float, float]:
        """What enters a chamber of that pressure [Pa] at the start, and what leaves it by the nozzle [kg/s]."""
        numbers = np.array([getattr(self, field.name) for field in fields(self)])
        found = _balance(gas, numbers, self.mass, self.radius, chamber)
        return found[0] + found[1], found[2]


@dataclass(frozen=True)
class Course:
    """Over ``time`` [s after its start], (n,) each [SI]: the tank's mass, the port's radius, flows of oxidizer and
    fuel, chamber pressure, thrust, and gamma [-] and R T [J/kg] of the chamber's gas."""

    time: Array
    mass: Array
    radius: Array
    flow: Array
    fuel_flow: Array
    chamber: Array
    thrust: Array
    gamma: Array
    rt: Array


COLUMNS = tuple(field.name for field in fields(Course))[1:]

(MASS, PRESSURE, TEMPERATURE, EXPONENT, AREA, SHARE, CHOKED, A, N, RADIUS, OUTER, LENGTH, DENSITY, VOLUME, THROAT,
 LEAVE, AMBIENT, LAW, ENTHALPY, EFFICIENCY) = range(20)  # fmt: skip
"""Numbers of a VaporBurn in their order."""


@compiled
def _balance(
    gas: Grid, c: Array, mass: float, radius: float, chamber: float
) -> tuple[float, float, float, float, float, float]:
    """Flows [kg/s] of oxidizer and fuel into a ``chamber`` [Pa] and out of it, its thrust [N], gamma [-] and R T
    [J/kg]."""
    pressure = polytropic(c[PRESSURE], c[MASS], c[EXPONENT], mass)
    flow = mass_flow(c[AREA], mass / c[VOLUME], c[SHARE] * (pressure - chamber))
    if c[CHOKED] > 0.0:
        flow *= expanding_flow(chamber / pressure, VAPOR_GAMMA)
    fuel = 0.0
    if radius < c[OUTER]:
        fuel = c[A] * flux_power(oxidizer_flux(flow, radius), c[N]) * ring(radius, c[LENGTH], c[DENSITY])
    if fuel > 0.0:
        ratio = min(max(flow / fuel, RATIOS[0]), RATIOS[1])
        rt, gamma = gas_at(gas, np.log(chamber), np.log(ratio), c[ENTHALPY], 0.0)
        rt *= c[EFFICIENCY]
    else:
        rt, gamma = SPECIFIC_GAS_CONSTANT * c[TEMPERATURE] * (mass / c[MASS]) ** (c[EXPONENT] - 1.0), COLD_GAMMA
    # where the flow leaves the wall is nothing to the throat, which chokes down to little above ambient pressure
    out = expand(gamma, rt, chamber, c[AMBIENT], c[THROAT], c[LEAVE])[0]
    thrust = expand_by(int(c[LAW]), gamma, rt, chamber, c[AMBIENT], c[THROAT], c[LEAVE])[1]
    return flow, fuel, out, thrust, gamma, rt


@compiled
def _chamber(gas: Grid, c: Array, mass: float, radius: float) -> float:
    """Pressure [Pa] at which as much leaves the chamber as enters it."""
    low, high = c[AMBIENT], max(polytropic(c[PRESSURE], c[MASS], c[EXPONENT], mass), c[AMBIENT])
    more, less = _excess(gas, c, mass, radius, low), _excess(gas, c, mass, radius, high)
    if more <= 0.0 or less >= 0.0:
        return float(low if more <= 0.0 else high)
    side, middle = 0, low
    for _ in range(MOST):  # the secant, kept from one end (Illinois)
        middle = (low * less - high * more) / (less - more)
        found = _excess(gas, c, mass, radius, middle)
        if found > 0.0:
            less *= 0.5 if side == 1 else 1.0
            done = middle - low < CLOSE
            low, more, side = middle, found, 1
        else:
            more *= 0.5 if side == -1 else 1.0
            done = high - middle < CLOSE
            high, less, side = middle, found, -1
        if done or high - low < CLOSE:
            break
    return float(middle)


@compiled
def _excess(gas: Grid, c: Array, mass: float, radius: float, chamber: float) -> float:
    """What enters a ``chamber`` [Pa] beyond what leaves it [kg/s]."""
    flow, fuel, out, _, _, _ = _balance(gas, c, mass, radius, chamber)
    return float(flow + fuel - out)


@compiled
def _march(gas: Grid, c: Array, out: Array) -> int:
    """Fill ``out`` (steps, COLUMNS) by the midpoint rule; returns the steps until the thrust is gone."""
    mass, radius = c[MASS], c[RADIUS]
    for i in range(out.shape[0]):
        chamber = _chamber(gas, c, mass, radius)
        flow, fuel, _, thrust, gamma, rt = _balance(gas, c, mass, radius, chamber)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = mass, radius, flow, fuel, chamber
        out[i, 5], out[i, 6], out[i, 7] = thrust, gamma, rt
        if chamber < (1.0 + OUT) * c[AMBIENT]:
            return i + 1
        half = max(mass - 0.5 * STEP * flow, 0.5 * mass)
        wide = min(radius + 0.5 * STEP * fuel / ring(radius, c[LENGTH], c[DENSITY]), c[OUTER])
        flow, fuel, _, _, _, _ = _balance(gas, c, half, wide, _chamber(gas, c, half, wide))
        mass = max(mass - STEP * flow, 0.1 * mass)
        radius = min(radius + STEP * fuel / ring(wide, c[LENGTH], c[DENSITY]), c[OUTER])
    return int(out.shape[0])
