"""What the tank holds and what passes the injector, from measured pressures and the injector's constants.

The flow is the injector's (report, eq. 3.2); without p_run the feed line's quadratic loss is
added to the injector's. The tank's mass is not measured: it is integrated from the flow. With the vapor's density M/V
that gives sqrt(M) = sqrt(M_v) - int mdot / (2 sqrt(M)) dt, in which mdot / sqrt(M) does not depend on M.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.weak_form.cells import Cells
from hfanalysis.diagnose.weak_form.linear import LinearHistory, integral, joined, through, total
from hfanalysis.engine.injector import flow_resistance, mass_flows
from hfanalysis.engine.tank import COLDEST_VAPOR, WARMEST_VAPOR
from hfanalysis.engine.unsteady import Engine
from hfanalysis.thermo.combustion import FORMATION_OFFSET
from hfanalysis.thermo.saturation import Property


@dataclass(frozen=True)
class TankFlow:
    """What an engine's tank holds and passes, from ``channels`` (cells,) [SI] on cells.

    ``constants``: the engine's numbers [SI] by name, each a single value; ``edge``: the tank's pressure [Pa] at the end
    of the liquid, where there is one.
    """

    engine: Engine
    cells: Cells
    channels: Mapping[str, LinearHistory]
    constants: Mapping[str, LinearHistory]
    edge: LinearHistory | None

    @property
    def wet(self) -> slice:
        """Cells before the end of the liquid."""
        return self.cells.phases[0]

    @property
    def dry(self) -> slice | None:
        """Cells behind it."""
        return self.cells.phases[1] if len(self.cells.phases) > 1 else None

    def constant(self, name: str, part: slice | None = None) -> LinearHistory:
        """One of the constants [SI], held over a phase (default: all cells); (cells,)."""
        part = part or slice(0, self.cells.time.size)
        return self.constants[name].spread(part.stop - part.start)

    @cached_property
    def _resistance(self) -> LinearHistory:
        """Effective area [m^2] of what lies between the two pressures that are measured."""
        feed = self.engine.feed
        if "p_run" in self.channels or feed.constant_losses is not None:
            return self.constants["area"]
        return through(
            lambda a, k: (2.0 * flow_resistance(a, k)) ** -0.5, self.constants["area"], self.constants["loss_factor"]
        )

    @cached_property
    def _drop(self) -> LinearHistory:
        """Pressure drop across it [Pa]."""
        upstream = self.channels.get("p_run", self.channels["p_tank"])
        lost = self.constant_loss if "p_run" not in self.channels else 0.0
        return through(lambda p, c: p - c - lost, upstream, self.channels["p_chamber"])

    @property
    def constant_loss(self) -> Array | float:
        """The report's constant feed losses by phase (cells,) [Pa]; 0 where the loss is quadratic."""
        losses = self.engine.feed.constant_losses
        if losses is None:
            return 0.0
        return np.where(np.arange(self.cells.time.size) < self.cells.wet, *losses)

    @cached_property
    def temperature(self) -> LinearHistory:
        """Of the saturated tank (wet cells,) [K], while there is liquid, from its pressure."""
        return through(self.engine.saturation.temperature, self.channels["p_tank"][self.wet])

    @cached_property
    def wet_flow(self) -> LinearHistory:
        """Oxidizer flow (wet cells,) [kg/s] while there is liquid (report, eq. 3.2)."""
        area = self._resistance.spread(self.cells.wet)
        density = self.engine.saturation.liquid_density
        return through(lambda a, t, x: mass_flows(a, density(t), x), area, self.temperature, self._drop[self.wet])

    @cached_property
    def wet_mass(self) -> LinearHistory:
        """What the tank holds (wet cells,) [kg] while there is liquid: the load less the integral of the flow."""
        return self.constant("oxidizer_mass", self.wet) - integral(self.wet_flow, self.cells.width[self.wet])

    @cached_property
    def vapor_start(self) -> tuple[LinearHistory, LinearHistory]:
        """Mass [kg] and temperature [K] of the vapor that is left at the end of the liquid, each a single value."""
        assert self.edge is not None
        source = self.engine.saturation
        temperature = through(source.temperature, self.edge)
        return through(lambda v, t: v * source.vapor_density(t), self.constants["volume"], temperature), temperature

    @cached_property
    def dry_mass(self) -> LinearHistory:
        """What the tank holds (dry cells,) [kg] after the end of the liquid.

        sqrt(M) = sqrt(M_v) - int mdot / (2 sqrt(M)) dt, for the flow at the density M/V is sqrt(M) times that at 1/V.
        """
        assert self.dry is not None
        count = self.dry.stop - self.dry.start
        area, volume = self._resistance.spread(count), self.constant("volume", self.dry)
        # the flow at the density M/V is sqrt(M) times that at 1/V
        pace = through(lambda a, v, x: 0.5 * mass_flows(a, 1.0 / v, x), area, volume, self._drop[self.dry])

        def left(start: Array, x: Array) -> Array:
            return np.asarray(np.maximum(np.sqrt(start) - x, 1e-3) ** 2)

        return through(left, self.vapor_start[0].spread(count), integral(pace, self.cells.width[self.dry]))

    @cached_property
    def exponent(self) -> LinearHistory:
        """Polytropic exponent of the vapor (dry cells,) [-]; c_p/c_v at the end of the liquid where the engine states
        none."""
        count = self.dry_mass.value.size
        if self.engine.polytropic_exponent is not None:
            return self.constants["polytropic_exponent"].spread(count)

        def ratio(temperature: Array) -> Array:
            cv, cp = self.engine.saturation.heat_capacities(temperature)
            return np.asarray(cp / cv)

        return through(ratio, self.vapor_start[1]).spread(count)

    @cached_property
    def dry_flow(self) -> LinearHistory:
        """Oxidizer flow (dry cells,) [kg/s] after the end of the liquid."""
        assert self.dry is not None
        area = self._resistance.spread(self.dry_mass.value.size)
        return through(
            lambda a, m, v, x: mass_flows(a, m / v, x),
            area,
            self.dry_mass,
            self.constant("volume", self.dry),
            self._drop[self.dry],
        )

    @cached_property
    def flow(self) -> LinearHistory:
        """Oxidizer flow through the injector (cells,) [kg/s]."""
        return joined([self.wet_flow, self.dry_flow]) if self.dry is not None else self.wet_flow

    @cached_property
    def dry_temperature(self) -> LinearHistory:
        """Of the vapor (dry cells,) [K], from pressure and mass."""
        assert self.dry is not None
        count = self.dry_mass.value.size
        mass, temperature = (h.spread(count) for h in self.vapor_start)
        return through(
            lambda p, m, p0, m0, t0: t0 * p * m0 / (p0 * m),
            self.channels["p_tank"][self.dry],
            self.dry_mass,
            self.dry_edge,
            mass,
            temperature,
        )

    @property
    def dry_edge(self) -> LinearHistory:
        """The tank's pressure at the end of the liquid [Pa], held over the cells behind it (dry cells,)."""
        assert self.edge is not None
        return self.edge.spread(self.dry_mass.value.size)

    def closing_mass(self) -> LinearHistory | None:
        """What the injector's flow leaves in the tank at the end of the liquid, less the vapor that fits it [kg], a
        single value.

        None where there is no end of the liquid.
        """
        if self.dry is None:
            return None
        passed = total(self.wet_flow, self.cells.width[self.wet])
        return self.constants["oxidizer_mass"] - passed - self.vapor_start[0]

    @cached_property
    def enthalpy(self) -> Array:
        """Of the oxidizer entering (cells,) [J/kg], on the formation scale."""
        e = self.engine
        if e.oxidizer_enthalpy is not None:
            return np.full(self.cells.time.size, e.oxidizer_enthalpy)
        liquid = e.saturation.energy(Property.LIQUID_ENTHALPY, self.temperature.value)[0]
        if self.dry is None:
            return FORMATION_OFFSET + liquid
        inside = np.clip(self.dry_temperature.value, COLDEST_VAPOR, WARMEST_VAPOR)
        vapor = e.saturation.energy(Property.VAPOR_ENTHALPY, inside)[0]
        return FORMATION_OFFSET + np.concatenate([liquid, vapor])
