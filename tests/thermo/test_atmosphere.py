"""The air that a stand or a rocket is in."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.thermo import atmosphere

ATMOSPHERE = 101_325.0


def test_at_the_launch_site_the_pressure_is_the_certified_one() -> None:
    assert atmosphere.pressure(1402.0) / ATMOSPHERE == pytest.approx(0.84623, abs=5e-6)


def test_at_sea_level_it_is_a_standard_day() -> None:
    assert atmosphere.pressure(0.0) == pytest.approx(ATMOSPHERE, rel=0.002)
    assert atmosphere.temperature(0.0) == pytest.approx(288.15, abs=0.1)
    assert atmosphere.density(0.0) == pytest.approx(1.225, rel=0.002)


@pytest.mark.parametrize(("altitude", "kelvin", "relative"), [(11_000.0, 0.15, 0.002), (25_000.0, 0.001, 0.02)])
def test_the_layers_meet(altitude: float, kelvin: float, relative: float) -> None:
    """To what the model's rounded constants allow: its own pressures leave 2 % at 25 km."""
    below, above = altitude - 1e-6, altitude
    assert atmosphere.temperature(below) == pytest.approx(atmosphere.temperature(above), abs=kelvin)
    assert atmosphere.pressure(below) == pytest.approx(atmosphere.pressure(above), rel=relative)


@given(st.floats(-500.0, 29_000.0), st.floats(100.0, 1000.0))
def test_air_thins_with_altitude(altitude: float, climb: float) -> None:
    assert atmosphere.pressure(altitude + climb) < atmosphere.pressure(altitude)
    assert atmosphere.density(altitude + climb) < atmosphere.density(altitude)


@given(st.sampled_from([1000.0, 15_000.0, 27_000.0]))
def test_the_air_carries_the_air_above_it(altitude: float) -> None:
    """Hydrostatics, dp/dz = -rho g, inside each layer."""
    slope = (atmosphere.pressure(altitude + 1.0) - atmosphere.pressure(altitude - 1.0)) / 2.0
    assert slope == pytest.approx(-9.80665 * atmosphere.density(altitude), rel=0.01)


@pytest.mark.parametrize("altitude", [30_001.0, 1e9, float("nan")])
def test_above_30_km_the_model_ends(altitude: float) -> None:
    with pytest.raises(ValueError, match="ends at 30000 m"):
        atmosphere.pressure(altitude)
