"""What a flight may differ in is drawn as widely as it is stated to be known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hfanalysis.flight import ascent
from hfanalysis.measured_flight.firing import Firing
from hfanalysis.measured_flight.uncertainty import rows
from hfanalysis.record.rocket import Rocket
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.units import Value

FLIGHTS = 20_000
VEHICLE = Vehicle(50.0, 0.5, 0.02, np.radians(6.0), 1400.0)


def drawn(**stated: Any) -> np.ndarray[Any, Any]:
    """Flights of a rocket of 50 kg with 10 kg of propellant to 0.1 kg, its thrust to 1 %, 5 N and 20 N of drift."""
    firing = SimpleNamespace(
        vehicle=VEHICLE,
        thrust=SimpleNamespace(gain_std=0.01, bias_std=5.0, drift_std=20.0),
        propellant=SimpleNamespace(total=np.array([10.0, 0.0]), loaded_std=0.1, stated_std=True),
    )
    rocket = Rocket(dry_mass=stated.pop("dry_mass", Value(50.0, 0.4)), **stated)
    return rows(cast(Firing, firing), rocket, FLIGHTS, 5)


@pytest.mark.parametrize(
    ("wind", "speed", "std"), [(None, 0.0, 2.0), (Value(5.0, 1.0), 5.0, 1.0), (Value(4.0), 4.0, 0.3 * 4.0)]
)
def test_wind_comes_from_anywhere_as_strong_as_it_is_stated(wind: Value | None, speed: float, std: float) -> None:
    """Of a wind u from any direction with v' along and across, each component's square is u^2/2 + v'^2 on the mean."""
    found = drawn(wind_speed=wind)
    for component in (ascent.WIND, ascent.CROSSWIND):
        assert np.mean(found[:, component]) == pytest.approx(0.0, abs=4.0 * np.hypot(speed, std) / np.sqrt(FLIGHTS))
        assert np.mean(found[:, component] ** 2) == pytest.approx(0.5 * speed**2 + std**2, rel=0.05)
    assert abs(np.corrcoef(found[:, ascent.WIND], found[:, ascent.CROSSWIND])[0, 1]) < 0.03


@pytest.mark.parametrize(
    ("column", "mean", "std"),
    [
        (ascent.THRUST_SCALE, 1.0, 0.01),
        (ascent.THRUST_BIAS, 0.0, 5.0),
        (ascent.THRUST_DRIFT, 0.0, 20.0),
        (ascent.MASS, 0.0, 0.4),
        (ascent.PROPELLANT, 1.0, 0.1 / 10.0),
        (ascent.DRAG, 1.0, 0.03),
        (ascent.ANGLE, np.radians(6.0), np.radians(0.5)),
    ],
)
def test_all_else_scatters_by_its_own_deviation(column: int, mean: float, std: float) -> None:
    found = drawn(drag_uncertainty=0.03, launch_angle=Value(np.radians(6.0), np.radians(0.5)))[:, column]
    assert found.mean() == pytest.approx(mean, abs=4.0 * std / np.sqrt(FLIGHTS))
    assert found.std() == pytest.approx(std, rel=0.03)


def test_what_is_not_stated_is_known_as_rockets_of_this_size_are() -> None:
    """A drag build-up to 10 %, a rail to a degree, a weighed rocket to half a per cent."""
    found = drawn(dry_mass=Value(50.0), launch_angle=Value(np.radians(6.0)))
    assert found[:, ascent.DRAG].std() == pytest.approx(0.1, rel=0.03)
    assert found[:, ascent.ANGLE].std() == pytest.approx(np.radians(1.0), rel=0.03)
    assert found[:, ascent.MASS].std() == pytest.approx(0.25, rel=0.03)
