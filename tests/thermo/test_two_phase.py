"""Flashing nitrous oxide against CoolProp: the state after a throttle, and the largest flux in equilibrium."""

from __future__ import annotations

import numpy as np
import pytest
from CoolProp import CoolProp

from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.two_phase import (
    blended_flux,
    equilibrium_flux,
    incompressible_flux,
    non_equilibrium,
    throttled,
)

TANK = np.array([54.7, 48.0, 40.7, 33.7, 25.0]) * 1e5
RUN = np.array([40.3, 36.8, 31.7, 28.6, 24.0]) * 1e5
CHAMBER = np.array([13.0, 11.8, 11.3, 8.8, 22.0]) * 1e5
"""[Pa]: from a lossy line to a wide one with little behind it, which does not choke."""


def exact(tank: float, run: float, chamber: float) -> tuple[float, float, float]:
    """Quality, density and largest flux between the pressures by steps of 0.1 % through CoolProp."""
    state = CoolProp.AbstractState("HEOS", "NitrousOxide")
    state.update(CoolProp.PQ_INPUTS, tank, 0.0)
    enthalpy = state.hmass()
    state.update(CoolProp.HmassP_INPUTS, enthalpy, run)
    entropy, quality, density, flux = state.smass(), state.Q(), state.rhomass(), 0.0
    for pressure in np.linspace(chamber, run, 1000):
        state.update(CoolProp.PSmass_INPUTS, pressure, entropy)
        flux = max(flux, state.rhomass() * np.sqrt(max(2.0 * (enthalpy - state.hmass()), 0.0)))
    return quality, density, flux


def test_the_inlet_and_the_flux_are_those_of_the_equation_of_state() -> None:
    fluid = saturation()
    inlet = throttled(fluid, fluid.temperature(TANK), RUN)
    quality, density, flux = np.array([exact(*row) for row in zip(TANK, RUN, CHAMBER, strict=True)]).T
    np.testing.assert_allclose(inlet.quality, quality, rtol=1e-4)
    np.testing.assert_allclose(inlet.density, density, rtol=1e-4)
    np.testing.assert_allclose(equilibrium_flux(fluid, inlet, CHAMBER), flux, rtol=1e-3)


def test_a_choked_flux_does_not_know_what_is_behind_it() -> None:
    fluid = saturation()
    inlet = throttled(fluid, fluid.temperature(TANK[:1]), RUN[:1])
    found = [equilibrium_flux(fluid, inlet, np.array([p]))[0] for p in (5e5, 15e5, 25e5, 35e5)]
    assert found[0] == pytest.approx(found[1], rel=2e-3)
    assert found[2] == pytest.approx(found[0], rel=2e-3)  # it chokes at 27 bar
    assert found[3] < 0.9 * found[0]


def test_liquid_that_is_kept_from_boiling_does_not_change() -> None:
    """Above saturation the inlet is the tank's liquid, and what does not flash on the way flows as it does."""
    fluid = saturation()
    warm = np.array([280.0])
    p = fluid.pressure(warm)
    inlet = throttled(fluid, warm, 1.3 * p)
    assert inlet.quality[0] == 0.0
    assert inlet.subcooling[0] > 0.0
    assert inlet.density == pytest.approx(fluid.liquid_density(warm))
    plain = incompressible_flux(inlet.density, inlet.pressure, 1.1 * p)
    assert equilibrium_flux(fluid, inlet, 1.1 * p) == pytest.approx(plain, rel=1e-3)
    assert blended_flux(non_equilibrium(inlet, p, 1.1 * p), plain, 0.0 * plain) == pytest.approx(plain)


def test_kappa_is_one_where_the_inlet_is_saturated_and_more_where_it_is_not() -> None:
    fluid = saturation()
    warm = np.full(2, 285.0)
    p = fluid.pressure(warm)
    inlet = throttled(fluid, warm, p * np.array([0.8, 1.25]))
    kappa = non_equilibrium(inlet, p, np.full(2, 10e5))
    assert kappa[0] == pytest.approx(1.0)
    assert kappa[1] == pytest.approx(np.sqrt((1.25 * p[1] - 10e5) / (p[1] - 10e5)))
    assert blended_flux(np.ones(1), np.full(1, 2.0), np.full(1, 4.0)) == pytest.approx(3.0)
