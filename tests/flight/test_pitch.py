"""Balance over the burn, and the rocket in its pitch plane."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from tests.rocket.test_aerodynamics import HALCYON, HALCYON_CENTER

from hfanalysis.flight.ascent import Arguments, arguments, ascend
from hfanalysis.flight.curve import Curve
from hfanalysis.flight.margin import margin
from hfanalysis.flight.pitch import ATTACK, ATTITUDE, HEIGHT, MARGIN, PITCH_STEP, SPEED, Flights, aero, fly_in_wind
from hfanalysis.rocket.aerodynamics import center_of_pressure, components
from hfanalysis.rocket.balance import MassPart, TankPlace, balance, oxidizer
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo.air import air

BURN = Curve(0.01, np.minimum(2000.0, np.linspace(5e4, 0.0, 501)), np.linspace(31.0, 26.0, 501), 26.0)
INERTIA = 28.0


def rocket(angle: float = 0.0) -> Vehicle:
    return Vehicle(26.0, 0.45, HALCYON.area, radians(angle), 130.0)


def reads(angle: float = 0.0) -> Arguments:
    return arguments(BURN, rocket(angle), 12.0)


def flights(wind: float, seeds: int = 1, angle: float = 0.0, center: float = HALCYON_CENTER) -> Flights:
    weights = np.full(501, center), np.full(501, INERTIA)
    return fly_in_wind(reads(angle), weights, aero(HALCYON), wind, seeds, 40.0)


def test_the_center_of_gravity_is_the_mean_weighed_by_mass() -> None:
    found = balance([MassPart(3.0, 1.0), MassPart(1.0, 2.0)])
    assert found.center == pytest.approx(1.25)
    assert found.inertia == pytest.approx(3.0 * 0.25**2 + 0.75**2)


def test_a_rod_turns_about_its_middle_with_a_twelfth() -> None:
    assert balance([MassPart(6.0, 0.5, 2.0)]).inertia == pytest.approx(6.0 * 4.0 / 12.0)


def test_liquid_lies_at_the_bottom_and_sinks_as_it_leaves() -> None:
    place = TankPlace(2.0, 1.0, 0.010)
    liquid, vapor = np.array([8.0, 4.0, 0.0]), np.array([0.2, 1.0, 1.5])
    of_liquid, of_vapor = oxidizer(place, liquid, vapor, np.full(3, 0.00125))
    assert of_liquid.center == pytest.approx([2.5, 2.75, 3.0])
    assert of_vapor.center == pytest.approx([2.0, 2.25, 2.5])
    assert of_liquid.length + of_vapor.length == pytest.approx([1.0, 1.0, 1.0])


def test_without_wind_and_straight_up_it_flies_as_the_ascent_does() -> None:
    path = flights(0.0).paths[0]
    alone = ascend(BURN, rocket(), 12.0)
    assert np.nanmax(path[:, HEIGHT]) == pytest.approx(alone.height, rel=1e-4)
    assert np.nanmax(path[:, SPEED]) == pytest.approx(float(alone.column("speed").max()), rel=1e-3)
    assert np.nanmax(np.abs(path[: int(20.0 / PITCH_STEP), ATTITUDE])) == 0.0


def test_the_margin_without_an_angle_of_attack_is_barrowman_s() -> None:
    found = flights(0.0)
    at, (row,) = found.departure[0], found.paths
    mach = row[at, SPEED] / air(130.0 + row[at, HEIGHT])[2]
    _, place = center_of_pressure(components(HALCYON, mach))
    assert row[at, MARGIN] == pytest.approx((place - HALCYON_CENTER) / 0.1524, rel=1e-3)


def test_a_stable_rocket_turns_into_the_wind() -> None:
    path, at = flights(6.0).paths[0], flights(6.0).departure[0]
    assert path[at, ATTACK] == pytest.approx(np.arctan(6.0 / 37.0), rel=0.15)
    later = int(at + 3.0 / PITCH_STEP)
    assert path[later, ATTITUDE] > 0.0
    assert path[later, ATTACK] < 0.2 * path[at, ATTACK]


def test_it_swings_at_the_frequency_of_its_margin_and_inertia() -> None:
    """omega^2 = q A C_N x / I; the damping is weak, the speed grows by a few per cent over half a swing."""
    found = flights(3.0)
    path, at = found.paths[0], int(found.departure[0])
    attitude = path[at : at + int(1.0 / PITCH_STEP), ATTITUDE]
    half = float(np.argmax(attitude)) * PITCH_STEP
    mean = path[at : at + int(half / PITCH_STEP), SPEED].mean()
    slope, place = center_of_pressure(components(HALCYON, 0.1))
    stiffness = 0.5 * air(140.0)[1] * mean**2 * HALCYON.area * slope * (place - HALCYON_CENTER)
    assert half == pytest.approx(np.pi / np.sqrt(stiffness / INERTIA), rel=0.15)


def test_a_rocket_that_weighs_aft_of_its_center_of_pressure_tumbles() -> None:
    path = flights(1.0, center=3.0).paths[0]
    assert np.nanmin(path[:, MARGIN]) < 0.0
    assert np.nanmax(path[: int(5.0 / PITCH_STEP), ATTACK]) > 1.0


def test_wind_takes_margin_at_the_rail_s_end() -> None:
    """The body's lift moves the center of pressure ahead as the angle of attack grows."""
    margins = [margin(flights(wind, seeds=5)) for wind in (1.0, 4.0, 8.0)]
    at_rail = [float(m.mean[0]) for m in margins if m is not None]
    assert at_rail == sorted(at_rail, reverse=True)
    assert at_rail[0] - at_rail[2] > 0.5


def test_gusts_spread_the_margin_and_the_same_seeds_give_the_same() -> None:
    first, second = margin(flights(6.0, seeds=20)), margin(flights(6.0, seeds=20))
    assert first is not None
    assert second is not None
    assert first.std[0] > 0.0
    assert first.mean == pytest.approx(second.mean, abs=0.0)
    assert first.product().least == pytest.approx((first.mean - 2.0 * first.std).min())


def test_a_rail_that_is_too_long_has_no_margin() -> None:
    weights = np.full(501, HALCYON_CENTER), np.full(501, INERTIA)
    endless = arguments(BURN, rocket(), 1e6)
    assert margin(fly_in_wind(endless, weights, aero(HALCYON), 3.0, 2, 40.0)) is None
