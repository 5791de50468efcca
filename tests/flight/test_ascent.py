"""Ascent, coasting and descent of the report's rocket, and limits with analytic answers."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, radians, sqrt

import numpy as np
import pytest
from benchmarks.reference_engine import maelstrom

from hfanalysis.engine.unsteady import Burn, air, burn
from hfanalysis.flight.coast import Descent, Leg, Parachute, coast, descend, fall, speed_of_sound
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY, Vehicle, apogee, drag_coefficient, gravity
from hfanalysis.thermo import air as compiled
from hfanalysis.thermo import atmosphere

DROGUE = Parachute(1.55, 1.17)
MAIN = Parachute(2.20, 10.5, 457.0)
SITE = 1402.0
ROCKET = Vehicle(52.5, 0.529, 19478e-6, radians(6.0), SITE)


@cache
def burnt() -> Burn:
    return burn(maelstrom())


@cache
def coasting(dry_mass: float = ROCKET.dry_mass) -> Leg:
    end = burnt()
    vehicle = replace(ROCKET, dry_mass=dry_mass)
    return coast(vehicle, end.burn_time, float(end.state("altitude")[-1]), float(end.state("speed")[-1]))


@cache
def descent() -> Descent:
    return descend(ROCKET, coasting().end, DROGUE, MAIN)


def test_the_rocket_reaches_the_certified_apogee() -> None:
    time, altitude, speed = coasting().end
    assert altitude - SITE == pytest.approx(3053.0, rel=0.003)
    assert time == pytest.approx(25.4, abs=0.1)
    assert speed == pytest.approx(0.0, abs=1e-6)


def test_the_residual_vapour_carries_it_higher() -> None:
    residual = float(burnt().state("tank_mass")[-1])
    assert coasting(52.5 + residual).altitude[-1] - SITE == pytest.approx(3060.0, rel=0.003)


def test_its_peak_speed_and_mach_number_are_certified() -> None:
    speed, altitude = burnt().state("speed"), burnt().state("altitude")
    assert speed.max() == pytest.approx(252.4, rel=0.005)
    mach = [v / speed_of_sound(float(z)) for v, z in zip(speed, altitude, strict=True)]
    assert max(mach) == pytest.approx(0.758, rel=0.005)


def test_its_peak_acceleration_is_the_engines() -> None:
    peak = float(np.max(burnt().output("acceleration"))) / STANDARD_GRAVITY
    assert peak == pytest.approx(10.2, rel=0.01)


def test_it_leaves_its_rail_at_the_certified_speed() -> None:
    along = (burnt().state("altitude") - SITE) / cos(ROCKET.launch_angle)
    assert float(np.interp(6.05, along, burnt().state("speed"))) == pytest.approx(34.8, rel=0.005)


@pytest.mark.parametrize(
    ("quantity", "certified"),
    [("drogue_speed", 23.5), ("landing_speed", 6.45), ("main_load", 11.7), ("ballistic_speed", 213.1)],
)
def test_the_descent_is_the_certified_one(quantity: str, certified: float) -> None:
    assert getattr(descent(), quantity) == pytest.approx(certified, rel=0.005)


def test_the_main_opens_when_certified() -> None:
    assert descent().time_of_main == pytest.approx(130.5, abs=0.5)


def terminal(area: float, altitude: float) -> float:
    own = ROCKET.drag_coefficient * ROCKET.frontal_area
    return sqrt(2.0 * ROCKET.dry_mass * gravity(altitude) / (atmosphere.density(altitude) * (area + own)))


def test_parachutes_fall_at_their_terminal_velocity() -> None:
    """sqrt(2 m g / (rho C_d A)) at the altitude, but for the air's slow thickening."""
    assert descent().landing_speed == pytest.approx(terminal(2.20 * 10.5, SITE), rel=1e-3)
    assert descent().drogue_speed == pytest.approx(terminal(1.55 * 1.17, SITE + 457.0), rel=3e-3)


def test_coasting_without_drag_is_the_parabola() -> None:
    start, speed = 0.0, 200.0
    leg = coast(Vehicle(50.0, 0.0, 0.02, 0.0, start), 3.0, start, speed)
    flat = speed**2 / (2.0 * STANDARD_GRAVITY)
    radius = 6_371_000.0
    assert leg.altitude[-1] == pytest.approx(flat / (1.0 - flat / radius), rel=1e-7)
    assert leg.time[-1] - 3.0 == pytest.approx(speed / STANDARD_GRAVITY, rel=2e-3)


def test_falling_without_drag_conserves_energy() -> None:
    leg = fall(Vehicle(50.0, 0.0, 0.02, 0.0, 0.0), 0.0, (0.0, 2000.0, 0.0), 0.0)
    radius = 6_371_000.0
    energy = STANDARD_GRAVITY * radius**2 * (1.0 / radius - 1.0 / (radius + 2000.0))
    assert leg.speed[-1] == pytest.approx(-sqrt(2.0 * energy), rel=1e-7)
    assert leg.altitude[-1] == pytest.approx(0.0, abs=1e-6)


def test_a_constant_thrust_without_drag_is_the_rocket_equation() -> None:
    """Burn-out speed and height of a rocket in vacuum and uniform gravity, then the parabola."""
    vehicle, thrust, flow, time = Vehicle(50.0, 0.0, 0.02, 0.0, 0.0), 6000.0, 3.0, 3.0
    exhaust, start = thrust / flow, 50.0 + flow * time
    speed = exhaust * np.log(start / 50.0) - STANDARD_GRAVITY * time
    height = exhaust * (time - 50.0 / flow * np.log(start / 50.0)) - 0.5 * STANDARD_GRAVITY * time**2
    assert apogee(vehicle, thrust, flow, time) == pytest.approx(height + speed**2 / (2.0 * STANDARD_GRAVITY), rel=1e-3)


def test_a_rocket_too_heavy_for_its_engine_stays() -> None:
    assert apogee(ROCKET, 500.0, 2.0, 3.0) == 0.0


def test_a_rocket_that_leaves_the_atmosphere_model_is_refused() -> None:
    with pytest.raises(ValueError, match="atmosphere"):
        apogee(replace(ROCKET, dry_mass=20.0, drag_coefficient=0.01), 8000.0, 2.0, 20.0)
    with pytest.raises(ValueError, match="atmosphere"):
        coast(replace(ROCKET, drag_coefficient=0.01), 0.0, 20_000.0, 900.0)


def test_a_main_without_a_deploy_altitude_opens_at_apogee() -> None:
    down = descend(ROCKET, coasting().end, DROGUE, Parachute(2.20, 10.5))
    assert down.time_of_main == pytest.approx(coasting().end[0], abs=1e-6)
    assert down.drogue_speed == pytest.approx(0.0, abs=1e-6)
    assert down.landing_speed == pytest.approx(descent().landing_speed, rel=1e-3)


def test_a_main_set_above_the_apogee_opens_at_apogee() -> None:
    down = descend(ROCKET, coasting().end, DROGUE, Parachute(2.20, 10.5, 9000.0))
    assert down.time_of_main == pytest.approx(coasting().end[0], abs=1e-6)


def test_the_drag_coefficient_is_linear_between_the_table_s_mach_numbers() -> None:
    table = Vehicle(50.0, 0.5, 0.02, 0.0, 0.0, (0.3, 0.5, 0.9), (0.5, 0.40, 0.6)).drag_table
    found = [drag_coefficient(mach, table) for mach in (0.0, 0.3, 0.4, 0.5, 0.7, 0.9, 2.0)]
    assert found == pytest.approx([0.5, 0.5, 0.45, 0.40, 0.5, 0.6, 0.6])


def test_a_table_of_one_value_flies_as_that_number() -> None:
    flat = replace(ROCKET, drag_coefficient=0.1, drag_mach=(0.1, 0.5), drag_values=(0.529, 0.529))
    end = coasting().time[0], float(coasting().altitude[0]), float(coasting().speed[0])
    assert coast(flat, *end).end == pytest.approx(coasting().end, rel=1e-9)
    assert descend(flat, coasting().end, DROGUE, MAIN).ballistic_speed == pytest.approx(descent().ballistic_speed)
    assert apogee(flat, 6000.0, 3.0, 2.5) == pytest.approx(apogee(ROCKET, 6000.0, 3.0, 2.5), rel=1e-9)


def test_more_drag_at_high_mach_numbers_costs_height() -> None:
    rising = replace(ROCKET, drag_mach=(0.3, 0.8), drag_values=(0.529, 0.7))
    assert apogee(rising, 6000.0, 3.0, 2.5) < apogee(ROCKET, 6000.0, 3.0, 2.5)


@pytest.mark.parametrize("altitude", [0.0, 1402.0, 10_999.0, 11_001.0, 24_999.0, 25_001.0, 30_000.0])
def test_the_engines_air_is_the_atmosphere(altitude: float) -> None:
    pressure, density = air(altitude)
    assert pressure == pytest.approx(atmosphere.pressure(altitude), rel=1e-12)
    assert density == pytest.approx(atmosphere.density(altitude), rel=1e-12)


@pytest.mark.parametrize("altitude", [0.0, 1402.0, 10_999.0, 11_001.0, 24_999.0, 25_001.0, 30_000.0])
def test_the_compiled_air_is_the_atmosphere(altitude: float) -> None:
    pressure, density, sound = compiled.air(altitude)
    assert pressure == pytest.approx(atmosphere.pressure(altitude), rel=1e-12)
    assert density == pytest.approx(atmosphere.density(altitude), rel=1e-12)
    assert sound == pytest.approx(sqrt(1.4 * pressure / density), rel=1e-12)
