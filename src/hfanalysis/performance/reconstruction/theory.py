"""What the gas can give, in a small table: characteristic velocity and thrust coefficient over mixture and pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.burnt_gas import combustion_of
from hfanalysis.engine.nozzle import characteristic_velocity, expand_along
from hfanalysis.thermo.fuels import PARAFFIN, Fuel
from hfanalysis.thermo.shifting import shifting

MIXTURES = np.geomspace(0.8, 60.0, 160)
"""Oxidizer over fuel [-] of the table."""

PRESSURES = np.geomspace(1e5, 100e5, 7)
"""[Pa] of the table; it hardly depends on them."""


@dataclass(frozen=True)
class Theory:
    """Of shifting equilibrium, (pressures, mixtures) each: c* [m/s], R T [J/kg], gamma and C_F into vacuum [-]."""

    c_star: Array
    heat: Array
    gamma: Array
    vacuum: Array

    @classmethod
    def of(cls, enthalpy: float, throat_area: float, exit_area: float, fuel: Fuel = PARAFFIN) -> Theory:
        """For nitrous oxide that enters with this ``enthalpy`` [J/kg], and a nozzle [m^2].

        Raises AbsentError where CEA is not installed.
        """
        pressure, mixture = (x.ravel() for x in np.meshgrid(PRESSURES, MIXTURES, indexing="ij"))
        frozen = expand_along(combustion_of(fuel).kernel, pressure, mixture, enthalpy, throat_area, exit_area, 1e5)
        gain, vacuum = shifting(pressure, mixture, enthalpy, exit_area / throat_area, fuel)
        shape = (PRESSURES.size, MIXTURES.size)
        c_star = gain * characteristic_velocity(frozen[2], frozen[3])
        return cls(c_star.reshape(shape), frozen[2].reshape(shape), frozen[3].reshape(shape), vacuum.reshape(shape))

    def at(self, values: Array, pressure: Array, mixture: Array) -> Array:
        """One of its tables at ``pressure`` [Pa] and ``mixture`` [-], of one shape."""
        rows, columns = _place(np.log(PRESSURES), pressure), _place(np.log(MIXTURES), mixture)
        (i, a), (j, b) = rows, columns
        low = (1.0 - b) * values[i, j] + b * values[i, j + 1]
        high = (1.0 - b) * values[i + 1, j] + b * values[i + 1, j + 1]
        return np.asarray((1.0 - a) * low + a * high)

    def rows(self, pressure: Array) -> Array:
        """c* [m/s] over MIXTURES at each ``pressure`` [Pa], (n, mixtures)."""
        i, a = _place(np.log(PRESSURES), pressure)
        return np.asarray((1.0 - a)[:, None] * self.c_star[i] + a[:, None] * self.c_star[i + 1])


def _place(nodes: Array, value: Array) -> tuple[np.ndarray, Array]:
    """Index of the node before, and part of the way to the next; the nearest is held beyond the ends."""
    x = np.clip((np.log(value) - nodes[0]) / (nodes[1] - nodes[0]), 0.0, nodes.size - 1.000001)
    i = x.astype(np.int64)
    return i, x - i
