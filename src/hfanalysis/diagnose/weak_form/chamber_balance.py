"""Chamber and nozzle of the base model as balances between what channels measure (report, sections 3.1.3 and 3.1.4).

The port is integrated from r = a G^n with the oxidizer's flow that is handed in: with G = mdot / (pi r^2) the equation
separates. The gas is in equilibrium at the measured pressure and at the O/F that enters; what is stored at another O/F
is gone within milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.diagnose.weak_form.cells import Cells, Piece, by_phase
from hfanalysis.diagnose.weak_form.linear import LinearHistory, integral, through, through_all
from hfanalysis.engine.chamber import chamber_volume
from hfanalysis.engine.grain import flux_power, opened, oxidizer_flux
from hfanalysis.engine.nozzle import expand_along
from hfanalysis.engine.unsteady import Engine

LEAST_PRESSURE = 1e3
"""Chamber pressure [Pa] below which the gas is that at this one."""

LEAST_FLOW = 1e-9
"""Flow [kg/s] of oxidizer or fuel below which their ratio is no longer asked for."""


@dataclass(frozen=True)
class ChamberBalance:
    """Balances behind the injector: ``flow`` of oxidizer (cells,) [kg/s] and its ``enthalpy`` (cells,) on the formation
    scale [J/kg].

    ``channels`` (cells,) [SI] on cells; ``constants``: the engine's numbers [SI] by name, each a single value.
    """

    engine: Engine
    cells: Cells
    channels: Mapping[str, LinearHistory]
    constants: Mapping[str, LinearHistory]
    flow: LinearHistory
    enthalpy: Array

    def _constant(self, name: str) -> LinearHistory:
        return self.constants[name].spread(self.cells.time.size)

    @cached_property
    def _regression(self) -> tuple[LinearHistory, LinearHistory]:
        """Port radius [m] and fuel flow [kg/s]."""
        e, n = self.engine, self._constant("n")
        pace = integral(through(lambda m, n: _powers(m / pi, n), self.flow, n), self.cells.width)
        radius = through(lambda a, n, x: opened(e.port_radius, a, n, x), self._constant("a"), n, pace)
        fuel = through(
            lambda a, n, m, r: e.grain.ring(r) * a * _powers(oxidizer_flux(m, r), n),
            self._constant("a"), n, self.flow, radius,
        )  # fmt: skip
        return radius, fuel

    @cached_property
    def _expansion(self) -> tuple[LinearHistory, LinearHistory, LinearHistory]:
        """Stored gas [kg], flow [kg/s] and thrust [N] of the nozzle at the measured chamber pressure."""
        e, enthalpy, (radius, fuel) = self.engine, self.enthalpy, self._regression

        def expanded(p: Array, oxidizer: Array, fuel: Array, r: Array, throat: Array) -> tuple[Array, ...]:
            volume = chamber_volume(e.dead_volume, r, e.grain_length)
            ratio = np.maximum(oxidizer, LEAST_FLOW) / np.maximum(fuel, LEAST_FLOW)
            p = np.maximum(p, LEAST_PRESSURE)
            gas = e.combustion.kernel
            flow, thrust, rt, _ = expand_along(gas, p, ratio, enthalpy, throat, e.exit_area, e.ambient)
            return p * volume / rt, flow, thrust

        stored, flow, thrust = through_all(
            expanded, self.channels["p_chamber"], self.flow, fuel, radius, self._constant("throat_area")
        )
        return stored, flow, thrust

    def chamber_mass(self) -> list[Piece]:
        """Gas [kg/s] that the chamber stores and ejects at its pressure, less oxidizer and fuel that enter it."""
        stored, ejected, _ = self._expansion
        return by_phase(self.cells, ejected - self.flow - self._regression[1], stored)

    def nozzle(self) -> list[Piece]:
        """Measured thrust less that of the nozzle at the measured chamber pressure [N]."""
        return by_phase(self.cells, self.channels["thrust"] - self._expansion[2])


@compiled
def _powers(flux: Array, n: Array) -> Array:
    out = np.empty_like(flux)
    for i in range(flux.size):
        out[i] = flux_power(flux[i], n[i])
    return out
