"""Flow through injector and feed line."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.engine.feed_line import line_flow, line_loss
from hfanalysis.engine.injector import (
    SMALL_DROP,
    bent_root,
    flow_resistance,
    mass_flow,
    mass_flow_with_feed,
    mass_flows,
)

areas = st.floats(1e-6, 1e-4)
densities = st.floats(10.0, 1200.0)
drops = st.floats(1e4, 60e5)
losses = st.floats(0.0, 1e10)


def test_the_design_point_passes_its_2_5_kg_per_second() -> None:
    """C_i N_i A_i = 3.786e-5 m^2 at 25 degC, 57.29 bar in the tank, 0.345 bar lost, 27.579 bar in the chamber."""
    assert mass_flow(3.786e-5, 742.5, 57.29e5 - 0.345e5 - 27.579e5) == pytest.approx(2.5, rel=2e-4)


@pytest.mark.parametrize("drop", [0.0, -1e-9, -1e5, -60e5])
def test_flow_reverses_for_nobody(drop: float) -> None:
    assert mass_flow(4e-5, 750.0, drop) == 0.0
    assert mass_flow_with_feed(4e-5, 6.5e8, 750.0, drop) == 0.0


@given(areas, losses, densities, drops)
def test_feed_line_and_injector_share_the_pressure_drop(area: float, loss: float, density: float, drop: float) -> None:
    flow = mass_flow_with_feed(area, loss, density, drop)
    in_line = loss * flow**2 / density
    in_injector = flow**2 / (2.0 * density * area**2)
    assert in_line + in_injector == pytest.approx(drop, rel=1e-9)


@given(areas, losses, losses, densities, drops)
def test_resistances_in_series_add(area: float, one: float, other: float, density: float, drop: float) -> None:
    """A lossy line in front of an injector is a narrower injector: 1/(2 A_eff^2) = K + 1/(2 A^2)."""
    narrower = (1.0 / area**2 + 2.0 * one) ** -0.5
    together = mass_flow_with_feed(area, one + other, density, drop)
    assert mass_flow_with_feed(narrower, other, density, drop) == pytest.approx(together, rel=1e-9)


@given(areas, densities, drops)
def test_without_a_loss_the_injector_alone_sets_the_flow(area: float, density: float, drop: float) -> None:
    assert mass_flow_with_feed(area, 0.0, density, drop) == pytest.approx(mass_flow(area, density, drop), rel=1e-12)


@given(areas, densities, drops)
def test_flow_goes_with_the_root_of_the_drop(area: float, density: float, drop: float) -> None:
    assert mass_flow(area, density, 4.0 * drop) == pytest.approx(2.0 * mass_flow(area, density, drop), rel=1e-12)


def test_over_arrays_each_flow_is_its_own() -> None:
    densities, drops = np.array([750.0, 60.0, 700.0, 10.0]), np.array([20e5, 3e5, -1e5, 500.0])
    each = [mass_flow(4e-5, rho, dp) for rho, dp in zip(densities, drops, strict=True)]
    assert mass_flows(4e-5, densities, drops).tolist() == each
    assert mass_flows(np.full(4, 4e-5), 750.0, 20e5).tolist() == [each[0]] * 4


@given(areas, losses, densities, drops)
def test_the_resistance_is_the_drop_that_a_flow_asks_for(area: float, loss: float, density: float, drop: float) -> None:
    flow = mass_flow_with_feed(area, loss, density, drop)
    assert flow_resistance(area, loss) * flow**2 / density == pytest.approx(drop, rel=1e-9)


def test_the_bent_root_joins_smoothly_and_ends_with_a_finite_slope() -> None:
    step = 1e-3 * SMALL_DROP
    below, at, above = (bent_root(SMALL_DROP + x, SMALL_DROP) for x in (-step, 0.0, step))
    assert at == pytest.approx(SMALL_DROP**0.5, rel=1e-12)
    assert above - at == pytest.approx(at - below, rel=2e-3)
    assert bent_root(1e-9, SMALL_DROP) / 1e-9 == pytest.approx(1.5 / SMALL_DROP**0.5, rel=1e-6)


@given(areas, losses, densities, drops)
def test_a_line_loses_what_is_stated_or_by_the_square_of_its_flow(
    area: float, factor: float, density: float, drop: float
) -> None:
    quadratic = line_flow(area, factor, -1.0, density, drop)
    own = line_loss(factor, quadratic, density)
    assert line_flow(area, 0.0, own, density, drop) == pytest.approx(quadratic, rel=1e-6, abs=area * density)
