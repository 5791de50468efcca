"""The air that compiled flights go through, against the tables of the U.S. Standard Atmosphere, 1976."""

from __future__ import annotations

import pytest

from hfanalysis.thermo import atmosphere
from hfanalysis.thermo.air import air

STANDARD = {
    0.0: (101_325.0, 1.2250, 340.29),
    1_500.0: (84_560.0, 1.0581, 334.49),
    5_000.0: (54_048.0, 0.73643, 320.55),
    10_000.0: (26_500.0, 0.41351, 299.53),
    15_000.0: (12_112.0, 0.19475, 295.07),
    20_000.0: (5_529.3, 0.08891, 295.07),
}
"""Altitude [m]: pressure [Pa], density [kg/m^3], speed of sound [m/s]."""


@pytest.mark.parametrize("altitude", STANDARD)
def test_the_air_is_that_of_the_standard_s_tables(altitude: float) -> None:
    pressure, density, sound = air(altitude)
    expected = STANDARD[altitude]
    assert pressure == pytest.approx(expected[0], rel=0.01)
    assert density == pytest.approx(expected[1], rel=0.01)
    assert sound == pytest.approx(expected[2], rel=0.001)


@pytest.mark.parametrize("altitude", [-300.0, 0.0, 1402.0, 10_999.0, 11_001.0, 24_999.0, 25_001.0, 29_900.0])
def test_compiled_and_plain_air_are_the_same(altitude: float) -> None:
    pressure, density, sound = air(altitude)
    assert pressure == pytest.approx(atmosphere.pressure(altitude), rel=1e-9)
    assert density == pytest.approx(atmosphere.density(altitude), rel=1e-9)
    assert (sound / air(0.0)[2]) ** 2 == pytest.approx(
        atmosphere.temperature(altitude) / atmosphere.temperature(0.0), rel=1e-9
    )


def test_above_its_upper_end_the_air_stays_as_it_is_there() -> None:
    assert air(80_000.0) == air(30_000.0)
