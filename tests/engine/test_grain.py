"""The fuel grain: what a port frees as it opens, and how fast it opens."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from hfanalysis.compiled import compiled
from hfanalysis.engine.grain import Grain, fuel_around, opened, oxidizer_flux, pace_between, ring

GRAIN = Grain(length=0.5, outer_radius=0.05, density=900.0, a=1e-4, n=0.6)

radii = st.floats(0.01, 0.06)
exponents = st.floats(0.0, 1.0)


@given(radii, radii, exponents)
def test_a_port_opens_to_where_its_pace_leads(start: float, end: float, n: float) -> None:
    assert opened(start, 1e-4, n, pace_between(start, end, 1e-4, n)) == pytest.approx(end, rel=1e-9)


@pytest.mark.parametrize("n", [0.0, 0.4, 0.9])
def test_the_closed_form_is_the_integral_of_the_regression_law(n: float) -> None:
    """dr/dt = a (mdot / (pi r^2))^n with a flow that changes."""

    def flow(t: float) -> float:
        return 1.5 - 0.2 * t

    course = solve_ivp(lambda t, r: 2e-4 * oxidizer_flux(flow(t), r) ** n, (0.0, 4.0), [0.02], rtol=1e-10, atol=1e-12)
    time = np.linspace(0.0, 4.0, 4001)
    pace = float(np.trapezoid((flow(time) / np.pi) ** n, time))
    assert opened(0.02, 2e-4, n, pace) == pytest.approx(course.y[0, -1], rel=1e-7)


@given(st.floats(0.01, 3.5))
def test_port_and_mass_tell_each_other(mass: float) -> None:
    assert GRAIN.fuel(GRAIN.port_radius(mass)) == pytest.approx(mass, rel=1e-9)


def test_the_ring_is_what_the_grain_loses_as_its_port_opens() -> None:
    step = 1e-6
    assert (GRAIN.fuel(0.03 - step) - GRAIN.fuel(0.03 + step)) / (2.0 * step) == pytest.approx(GRAIN.ring(0.03))


def test_a_grain_with_its_port_at_the_casing_is_burnt() -> None:
    assert GRAIN.fuel(GRAIN.outer_radius) == 0.0
    with pytest.raises(ValueError, match="does not fit"):
        GRAIN.port_radius(1.01 * GRAIN.fuel(0.0))


@compiled
def _in_compiled_code(flow: float, radius: float) -> tuple[float, float, float]:
    return oxidizer_flux(flow, radius), ring(radius, 0.5, 900.0), fuel_around(radius, 0.05, 0.5, 900.0)


def test_a_law_is_the_same_for_numbers_for_arrays_and_in_compiled_code() -> None:
    radius = np.array([0.02, 0.03, 0.04])
    over = np.array([oxidizer_flux(1.2, radius), ring(radius, 0.5, 900.0), fuel_around(radius, 0.05, 0.5, 900.0)])
    for i, r in enumerate(radius):
        each = oxidizer_flux(1.2, r), ring(r, 0.5, 900.0), fuel_around(r, 0.05, 0.5, 900.0)
        assert over[:, i] == pytest.approx(each, rel=1e-15)
        assert _in_compiled_code(1.2, r) == pytest.approx(each, rel=1e-15)
