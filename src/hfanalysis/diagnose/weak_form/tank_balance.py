"""Tank, injector and feed line of the base model, as balances between what channels measure.

Each equation is a rate and something stored whose change adds to it; the sum is zero where the base model holds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.weak_form.cells import Piece, by_phase
from hfanalysis.diagnose.weak_form.linear import LinearHistory, integral, through
from hfanalysis.diagnose.weak_form.tank_flow import TankFlow
from hfanalysis.engine.feed_line import line_loss
from hfanalysis.engine.injector import mass_flows
from hfanalysis.engine.tank import COLDEST_VAPOR, WARMEST_VAPOR, internal_energy, mass_along, polytropic
from hfanalysis.thermo.saturation import Property

BAR, LITER = 1e5, 1e-3
"""A bar [Pa] and a liter [m^3]. Source: definition."""


@dataclass(frozen=True)
class TankBalance(TankFlow):
    """The balances of an engine upstream of its chamber."""

    def tank_energy(self) -> list[Piece]:
        """Heat that the tank's content receives [W], the injector's flow taken as right.

        Liquid: dU/dt + mdot h_l (report, eq. 3.9, with a heat term). Vapor: (V dp/dt + k mdot p V/M)/G, the heat beside
        a polytropic exponent k, of which Grueneisen's G tells what it does to the pressure; p V = Z R M T.
        """
        source = self.engine.saturation
        energy = through(self._energy, self.constant("volume", self.wet), self.wet_mass, self.temperature)
        pieces = [Piece(self.wet, self._carried(), energy)]
        if self.dry is not None:
            mass, temperature = (h.spread(self.dry_mass.value.size) for h in self.vapor_start)
            stored = through(
                lambda p, p0, m, t: m * t * p / p0, self.channels["p_tank"][self.dry], self.dry_edge, mass,
                temperature,
            )  # fmt: skip
            inside = np.clip(self.dry_temperature.value, COLDEST_VAPOR, WARMEST_VAPOR)
            pieces.append(
                Piece(
                    self.dry,
                    self.exponent * self.dry_flow * self.dry_temperature,
                    stored,
                    self._compressible_constant / source.grueneisen(inside),
                )
            )
        return pieces

    @property
    def _compressible_constant(self) -> float:
        """Z R of the vapor that is left at the end of the liquid [J/(kg K)]."""
        source, temperature = self.engine.saturation, float(self.vapor_start[1].value[0])
        return float(source.pressure(temperature) * source.vapor_volume(temperature)[0]) / temperature

    def _carried(self) -> LinearHistory:
        """Enthalpy flow [W] of the liquid that leaves."""
        source = self.engine.saturation
        return through(
            lambda flow, t: flow * source.energy(Property.LIQUID_ENTHALPY, t)[0], self.wet_flow, self.temperature
        )

    def _energy(self, volume: Array, mass: Array, temperature: Array) -> Array:
        """Internal energy [J] of a saturated tank."""
        return internal_energy(self.engine.saturation, volume, mass, temperature)

    def _phases(self, temperature: Array) -> tuple[Array, Array, Array, Array]:
        """v_l, v_v [m^3/kg], u_l, u_v [J/kg]."""
        s = self.engine.saturation
        return (
            s.liquid_volume(temperature)[0],
            s.vapor_volume(temperature)[0],
            s.energy(Property.LIQUID_ENERGY, temperature)[0],
            s.energy(Property.VAPOR_ENERGY, temperature)[0],
        )

    def tank_volume(self) -> list[Piece]:
        """Volume of the tank that its content does not fill [L], mass and energy taken from the injector's flow.

        Liquid: m_l + m_v = M and m_l u_l + m_v u_v = U give V - m_l v_l - m_v v_v (report, eq. 3.5). Vapor: V (1 - p_k
        / p) with the polytropic p_k = p_v (M/M_v)^k (report, eq. 3.11).
        """
        start = through(
            self._energy, *(self.constants[name] for name in ("volume", "oxidizer_mass", "temperature"))
        ).spread(self.cells.wet)
        held = start - integral(self._carried(), self.cells.width[self.wet])

        def unfilled(volume: Array, mass: Array, energy: Array, temperature: Array) -> Array:
            v_l, v_v, u_l, u_v = self._phases(temperature)
            vapor = (energy - mass * u_l) / (u_v - u_l)
            return (volume - (mass - vapor) * v_l - vapor * v_v) / LITER

        wet = through(unfilled, self.constant("volume", self.wet), self.wet_mass, held, self.temperature)
        pieces = [Piece(self.wet, wet)]
        if self.dry is not None:
            start_mass = self.vapor_start[0].spread(self.dry_mass.value.size)
            empty = through(
                lambda v, k, p, p0, m, m0: v * (1.0 - polytropic(p0, m0, k, m) / p) / LITER,
                self.constant("volume", self.dry), self.exponent,
                self.channels["p_tank"][self.dry], self.dry_edge, self.dry_mass, start_mass,
            )  # fmt: skip
            pieces.append(Piece(self.dry, empty))
        return pieces

    def injector(self) -> list[Piece]:
        """Flow [kg/s] that the tank loses, by its pressure alone and without heat, less what the injector passes."""
        table = self.engine.saturation.kernel_table

        def held(volume: Array, start: Array, warm: Array, t: Array) -> Array:
            return mass_along(table, volume[0], start[0], warm[0], t)

        names = ("volume", "oxidizer_mass", "temperature")
        mass = through(held, *(self.constant(name, self.wet) for name in names), self.temperature)
        pieces = [Piece(self.wet, self.wet_flow.times(-1.0), mass.times(-1.0))]
        if self.dry is not None:
            start_mass = self.vapor_start[0].spread(self.dry_mass.value.size)
            left = through(
                lambda k, p, p0, m0: m0 * (np.maximum(p, 1.0) / p0) ** (1.0 / k),
                self.exponent, self.channels["p_tank"][self.dry], self.dry_edge,
                start_mass,
            )  # fmt: skip
            pieces.append(Piece(self.dry, self.dry_flow.times(-1.0), left.times(-1.0)))
        return pieces

    def feed(self) -> list[Piece]:
        """p_tank - p_run less the line's loss K mdot^2 / rho [bar]."""
        constant = self.constant_loss

        def unexplained(tank: Array, run: Array, chamber: Array, area: Array, factor: Array) -> Array:
            loss = line_loss(factor, mass_flows(area, 1.0, run - chamber), 1.0)  # of the flow of any density
            if self.engine.feed.constant_losses is not None:
                return (tank - run - constant) / BAR
            return np.asarray((tank - run - loss) / BAR)

        pressures = (self.channels[name] for name in ("p_tank", "p_run", "p_chamber"))
        return by_phase(
            self.cells, through(unexplained, *pressures, self.constant("area"), self.constant("loss_factor"))
        )
