"""A nozzle in which the composition shifts: equilibrium at every pressure, where the engine's gas is frozen.

Frozen flow is the least that a nozzle gets out of a gas, shifting equilibrium the most: what was dissociated in the
chamber recombines as it cools. Efficiencies are told against the latter, as is usual in the field.

An expansion is followed along its isentrope, without any search by area. With ``*`` for the throat:

    u^2 = 2 (h_0 - h),   c* = p_0 / (rho u)*,   eps = (rho u)* / (rho u),   C_F,vac = u / c* + eps p / p_0

The flow is largest at the throat, so that a state near it gives it to second order; behind it dF = p dA gives the slope
of C_F,vac: p / p_0 along eps. Both numbers are kept in a small table, c* as its ratio to that of the frozen gas.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from math import log, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline, CubicSpline, RectBivariateSpline

from hfanalysis.arrays import Array
from hfanalysis.thermo import combustion
from hfanalysis.thermo.cache import cached
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, State
from hfanalysis.thermo.combustion_table import made_by, quietly
from hfanalysis.thermo.fuels import PARAFFIN, Fuel

BEHIND = (0.7, 0.45, 0.25, 0.12, 0.05, 0.02, 0.007)
"""Pressures behind the throat, over the throat's [-], at which the isentrope is taken: to an area ratio of 12 or more.
Evidence: test_shifting.py: with them C_F is that of NASA's CEA to 0.01 %."""

PRESSURES = (0.5e5, 100e5)
"""Range of the table in p [Pa]; beyond it the nearest is held. Source: below 0.5 bar no nozzle flows full."""

MIXTURES = (0.8, 60.0)
"""Range in oxidizer over fuel [-]; beyond it the nearest is held. Evidence: as for the mixtures of a burn in
docs/combustion.md."""

ENTHALPIES = (1.45e6, PROPEP_OXIDIZER_ENTHALPY)
"""Levels of the entering nitrous oxide on the formation scale [J/kg], linear between: liquid in the cold, to PROPEP's
gas."""

AREAS = (1.0, 12.0)
"""Range in exit over throat area [-]; beyond it the nearest is held. Source: nozzles for 10 to 60 bar at sea level."""

NODES = (7, 73, 7)
"""Of pressure, mixture and area ratio, each evenly in its logarithm. Evidence: test_shifting.py: 0.1 % at most from
direct expansions, as a rule 0.01 %."""


@dataclass(frozen=True)
class Expansion:
    """Shifting flow from a chamber: c* [m/s] over that of the frozen gas, and C_F into vacuum along the area ratio."""

    c_star: float
    frozen: float
    _along: CubicHermiteSpline

    def vacuum_coefficient(self, area_ratio: ArrayLike) -> Array:
        """C_F,vac [-] at exit over throat areas >= 1."""
        return np.asarray(self._along(np.sqrt(np.log(area_ratio))))


def expand(
    pressure: float, of_ratio: float, enthalpy: float = PROPEP_OXIDIZER_ENTHALPY, fuel: Fuel = PARAFFIN
) -> Expansion:
    """Shifting expansion from a chamber at ``pressure`` [Pa]; ``enthalpy`` of the nitrous oxide entering [J/kg].

    Raises ArithmeticError where there is no equilibrium, ValueError for no mixture.

    >>> found = expand(12e5, 10.5)
    >>> round(found.c_star), round(found.frozen), round(float(found.vacuum_coefficient(2.67)), 3)
    (1553, 1503, 1.541)
    """
    gas, chamber, at = combustion.isentrope(pressure, of_ratio, enthalpy, fuel)

    def flux(state: State) -> tuple[float, float]:
        speed = sqrt(2.0 * max(chamber.enthalpy - state.enthalpy, 0.0))
        return speed, state.density * speed

    throat = at(pressure * _critical(chamber.exponent))
    for _ in range(2):
        g, mach = throat.exponent, flux(throat)[0] / sqrt(throat.exponent * throat.pressure / throat.density)
        throat = at(throat.pressure * mach ** (2.0 * g / (g + 1.0)))
    most = flux(throat)[1]
    c_star, nodes = pressure / most, [(0.0, *_force(flux(throat), throat, most, pressure))]
    for part in BEHIND:
        with suppress(ArithmeticError):
            state = at(part * throat.pressure)
            speed, here = flux(state)
            nodes.append((sqrt(log(max(most / here, 1.0))), *_force((speed, here), state, most, pressure)))
    return Expansion(c_star, gas.characteristic_velocity, CubicHermiteSpline(*np.array(nodes).T))


def _force(flow: tuple[float, float], state: State, most: float, pressure: float) -> tuple[float, float]:
    """C_F,vac at a state, and its slope along sqrt(ln eps)."""
    speed, here = flow
    area, share = most / here, state.pressure / pressure
    return speed * most / pressure + area * share, 2.0 * area * share * sqrt(log(max(area, 1.0)))


def _critical(g: float) -> float:
    """p/p_0 at the throat of a gas with this isentropic exponent."""
    return float((2.0 / (g + 1.0)) ** (g / (g - 1.0)))


def shifting(
    pressure: Array, of_ratio: Array, enthalpy: float, area_ratio: float, fuel: Fuel = PARAFFIN
) -> tuple[Array, Array]:
    """c* over that of the frozen gas [-], and C_F into vacuum [-], (n,) each; NaN where there is no mixture.

    ``pressure`` [Pa] and ``of_ratio`` (n,), ``enthalpy`` of the nitrous oxide entering [J/kg]. Raises AbsentError where
    CEA is not installed.
    """
    there = np.isfinite(of_ratio) & (of_ratio > 0.0) & (pressure > 0.0)
    share = float(np.clip((enthalpy - ENTHALPIES[0]) / (ENTHALPIES[1] - ENTHALPIES[0]), 0.0, 1.0))
    table = (1.0 - share) * _table(fuel)[0] + share * _table(fuel)[1]
    force = CubicSpline(np.log(_grid(AREAS, NODES[2])), table[:, :, 1:], axis=2)(log(np.clip(area_ratio, *AREAS)))
    p = np.log(np.clip(np.where(there, pressure, 1.0), *PRESSURES))
    x = np.log(np.clip(np.where(there, of_ratio, 1.0), *MIXTURES))
    axes = np.log(_grid(PRESSURES, NODES[0])), np.log(_grid(MIXTURES, NODES[1]))
    gain, found = (RectBivariateSpline(*axes, values)(p, x, grid=False) for values in (table[:, :, 0], force))
    return np.where(there, gain, np.nan), np.where(there, found, np.nan)


def _grid(limits: tuple[float, float], count: int) -> Array:
    return np.geomspace(*limits, count)


@lru_cache(maxsize=4)
def _table(fuel: Fuel) -> Array:
    """(enthalpies, pressures, mixtures, 1 + area ratios), from the cache or, once, from CEA in some seconds."""
    shape = (len(ENTHALPIES), *NODES[:2], 1 + NODES[2])
    name = f"shifting-cea-{made_by()}-{fuel.key}-{'-'.join(map(str, NODES))}"
    return cached(name, shape, lambda: sampled(fuel))


def sampled(fuel: Fuel = PARAFFIN) -> Array:
    """The table straight from CEA; a mixture that does not converge takes the values of the last one that did."""
    combustion.restart()
    with quietly():
        rows = [[_along_mixtures(float(p), h, fuel) for p in _grid(PRESSURES, NODES[0])] for h in ENTHALPIES]
    combustion.restart()
    return np.array(rows)


def _along_mixtures(pressure: float, enthalpy: float, fuel: Fuel) -> Array:
    areas, rows = _grid(AREAS, NODES[2]), []
    for ratio in _grid(MIXTURES, NODES[1]):
        with suppress(ArithmeticError):
            rows.append(_row(expand(pressure, float(ratio), enthalpy, fuel), areas))
            continue
        rows.append(rows[-1])
    return np.array(rows)


def _row(found: Expansion, areas: Sequence[float] | Array) -> Array:
    return np.concatenate(([found.c_star / found.frozen], found.vacuum_coefficient(areas)))
