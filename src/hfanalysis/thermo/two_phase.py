"""Saturated nitrous oxide that flashes: its state after a throttle, and its flux through an orifice in equilibrium.

Entropies follow from the table itself: T ds = dh - v dp along the liquid, and h_v - h_l = T (s_v - s_l) across.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.thermo.saturation import Property, Saturation

EXPANSION_STEPS = 80
"""Steps in temperature of an expansion from inlet to outlet. Evidence: test_two_phase.py: the largest flux is within
0.1 % of that by CoolProp."""

ENTROPY_NODES = 2000
"""Temperatures between which the liquid's entropy is taken as linear. Evidence: test_two_phase.py."""


@dataclass(frozen=True)
class Throttled:
    """Liquid that was saturated in the tank, at the pressure before an orifice, with its enthalpy kept; each (n,).

    ``pressure`` [Pa] there; ``liquid`` [K]: of the liquid that left the tank; ``saturated`` [K]: of saturation at the
    pressure; ``quality`` [-]: vapor by mass, 0 where it is subcooled; ``density`` [kg/m^3] of the mixture.
    """

    pressure: Array
    liquid: Array
    saturated: Array
    quality: Array
    density: Array

    @property
    def subcooling(self) -> Array:
        """[K]; negative where the pressure is below saturation of what left the tank: it flashes."""
        return self.saturated - self.liquid


def throttled(saturation: Saturation, liquid: Array, pressure: Array) -> Throttled:
    """Liquid saturated at ``liquid`` (n,) [K], brought to a ``pressure`` (n,) [Pa] at constant enthalpy: h_l(T) =
    h_l + x (h_v - h_l) at that pressure."""
    warm, at = np.asarray(liquid, dtype=np.float64), saturation.temperature(pressure)
    h_l, h_v = (saturation.energy(p, at)[0] for p in (Property.LIQUID_ENTHALPY, Property.VAPOR_ENTHALPY))
    flashed = at < warm
    excess = saturation.energy(Property.LIQUID_ENTHALPY, warm)[0] - h_l
    quality = np.where(flashed, excess / (h_v - h_l), 0.0)
    v_l = np.where(flashed, saturation.liquid_volume(at)[0], saturation.liquid_volume(warm)[0])
    volume = (1.0 - quality) * v_l + quality * saturation.vapor_volume(at)[0]
    return Throttled(np.asarray(pressure, dtype=np.float64), warm, at, quality, 1.0 / volume)


def incompressible_flux(density: Array, inlet: Array, outlet: Array) -> Array:
    """sqrt(2 rho (p_1 - p_2)) [kg/(m^2 s)], (n,); 0 where nothing drives it. [kg/m^3], [Pa], [Pa]."""
    return np.asarray(np.sqrt(2.0 * density * np.maximum(inlet - outlet, 0.0)))


def equilibrium_flux(saturation: Saturation, inlet: Throttled, outlet: Array) -> Array:
    """Largest flux [kg/(m^2 s)], (n,), of homogeneous equilibrium flow from ``inlet`` to ``outlet`` (n,) [Pa].

    Isentropic, both phases at one speed: G = sqrt(2 int v dp) / v, at the pressure between inlet and outlet where it is
    largest (chokes), or at the outlet. Subcooled liquid does not change its volume until it is saturated.
    """
    first = np.minimum(inlet.liquid, inlet.saturated)
    last = np.minimum(saturation.temperature(np.maximum(outlet, saturation.pressure_range[0])), first)
    t = first + (last - first) * np.linspace(0.0, 1.0, EXPANSION_STEPS + 1)[:, None]
    liquid, across = _entropies(saturation, t)
    p, quality = saturation.pressure(t), (liquid[0] + inlet.quality * across[0] - liquid) / across
    volume = (1.0 - quality) * saturation.liquid_volume(t)[0] + quality * saturation.vapor_volume(t)[0]
    end = np.maximum(p[0], outlet)  # of the liquid, before it flashes
    by_liquid = np.maximum(inlet.pressure - end, 0.0) * volume[0]
    work = by_liquid + _integrals(volume, -p)
    return np.asarray((np.sqrt(2.0 * np.maximum(work, 0.0)) / volume).max(axis=0))


def non_equilibrium(inlet: Throttled, liquid_pressure: Array, outlet: Array) -> Array:
    """kappa [-], (n,), of Dyer et al., AIAA 2007-5702: sqrt((p_1 - p_2) / (p_sat - p_2)), 1 for a saturated inlet.

    ``liquid_pressure``: of saturation of what left the tank [Pa]. Liquid that does not flash before the outlet has no
    equilibrium flow to take part: infinite.
    """
    room = np.minimum(liquid_pressure, inlet.pressure) - outlet
    drop = np.maximum(inlet.pressure - outlet, 0.0)
    return np.asarray(np.sqrt(np.divide(drop, room, out=np.full(drop.shape, np.inf), where=room > 0.0)))


def blended_flux(kappa: Array, incompressible: Array, equilibrium: Array) -> Array:
    """(kappa G_spi + G_hem) / (1 + kappa) [kg/(m^2 s)], (n,)."""
    share = 1.0 / (1.0 + kappa)
    return np.asarray((1.0 - share) * incompressible + share * equilibrium)


def _entropies(saturation: Saturation, temperature: Array) -> tuple[Array, Array]:
    """s_l, from an origin of its own, and s_v - s_l [J/(kg K)], of the shape of ``temperature`` [K]."""
    nodes = np.linspace(saturation.t_min, saturation.t_max, ENTROPY_NODES)
    by_enthalpy = saturation.energy(Property.LIQUID_ENTHALPY, nodes)[1]
    slope = (by_enthalpy - saturation.liquid_volume(nodes)[0] * saturation.pressure_slope(nodes)) / nodes
    liquid = np.interp(temperature, nodes, _integrals(slope, nodes))
    h_l, h_v = (saturation.energy(p, temperature)[0] for p in (Property.LIQUID_ENTHALPY, Property.VAPOR_ENTHALPY))
    return liquid, (h_v - h_l) / temperature


def _integrals(value: Array, over: Array) -> Array:
    """From the first on to each, along the first axis, by the trapezoidal rule; of the shape of both."""
    parts = 0.5 * (value[1:] + value[:-1]) * np.diff(over, axis=0)
    return np.concatenate([np.zeros_like(parts[:1]), np.cumsum(parts, axis=0)])
