"""The air of the launch's day."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hfanalysis.flight.ascent import ascend
from hfanalysis.flight.curve import Curve
from hfanalysis.flight.descent import fall
from hfanalysis.rocket.vehicle import Vehicle, air_about, gravity
from hfanalysis.thermo.air import air

GROUND = 1402.0
VEHICLE = Vehicle(50.0, 0.5, 0.02, 0.1, GROUND)
WARM = replace(VEHICLE, warmer=20.0)
LOW = replace(VEHICLE, pressure_share=0.97)


def test_a_day_like_any_other_is_the_standard_air() -> None:
    for altitude in (GROUND, 4000.0, 12_000.0, 26_000.0):
        assert air_about(VEHICLE, altitude) == air(altitude)


def test_at_the_site_the_air_is_as_stated() -> None:
    pressure, rho, sound = air(GROUND)
    warm, low = air_about(WARM, GROUND), air_about(LOW, GROUND)
    assert warm[0] == pytest.approx(pressure)
    assert warm[1] / rho == pytest.approx(279.09 / 299.09, rel=1e-4)
    assert warm[2] / sound == pytest.approx((299.09 / 279.09) ** 0.5, rel=1e-4)
    assert low == pytest.approx((0.97 * pressure, 0.97 * rho, sound))


@pytest.mark.parametrize("altitude", [2000.0, 6000.0, 10_000.0])
def test_the_pressure_carries_the_air_above(altitude: float) -> None:
    """dp = -rho g dz, in the model's own g (that of its power: 9.80665 m/s^2 with the lapse rate, to 0.2 %)."""
    above, below = (air_about(WARM, altitude + d)[0] for d in (1.0, -1.0))
    rho = air_about(WARM, altitude)[1]
    assert (below - above) / 2.0 == pytest.approx(rho * 9.80665, rel=3e-3)
    assert gravity(altitude) < 9.80665


def test_thin_air_lets_a_rocket_fly_higher_and_fall_faster() -> None:
    curve = Curve(0.01, np.full(301, 3000.0), np.linspace(60.0, 50.0, 301), 50.0)
    usual, warm, low = (ascend(curve, vehicle).height for vehicle in (VEHICLE, WARM, LOW))
    assert usual < low < warm
    speeds = [abs(fall(vehicle, 1.5, (0.0, 2500.0, 0.0), GROUND).end[2]) for vehicle in (VEHICLE, WARM)]
    assert speeds[1] / speeds[0] == pytest.approx(np.sqrt(299.09 / 279.09), rel=2e-3)
