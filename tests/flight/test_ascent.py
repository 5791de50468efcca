"""Ascent, coasting and descent of the report's rocket, and limits with analytic answers."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, radians, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated.engines import maelstrom

from hfanalysis.engine.unsteady import Burn, burn
from hfanalysis.flight.ascent import ACCELERATION, MACH, NOMINAL, RAIL, SPEED, TIME, Ascent, ascend
from hfanalysis.flight.constant_thrust import apogee
from hfanalysis.flight.curve import Curve, even_curve
from hfanalysis.flight.descent import Descent, descend, fall
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY, Vehicle, drag_coefficient, gravity
from hfanalysis.simulation import flown
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
def flight() -> Ascent:
    return flown.ascend(maelstrom(), burnt(), 6.05)


@cache
def descent() -> Descent:
    return descend(ROCKET, flight().end, DROGUE, MAIN)


def test_the_rocket_reaches_the_certified_apogee() -> None:
    time, altitude, speed = flight().end
    assert altitude - SITE == pytest.approx(3053.0, rel=0.003)
    assert time == pytest.approx(25.4, abs=0.1)
    assert speed == pytest.approx(0.0, abs=1e-6)


def test_the_residual_vapor_carries_it_higher() -> None:
    residual = float(burnt().state("tank_mass")[-1])
    carrying = replace(flown.curve_of(maelstrom(), burnt()), mass_after=52.5 + residual)
    assert ascend(carrying, ROCKET).height == pytest.approx(3060.0, rel=0.003)


def test_its_peak_speed_and_mach_number_are_certified() -> None:
    assert flight().results[SPEED] == pytest.approx(252.4, rel=0.005)
    assert flight().results[MACH] == pytest.approx(0.758, rel=0.005)


def test_its_peak_acceleration_is_the_engines() -> None:
    assert flight().results[ACCELERATION] / STANDARD_GRAVITY == pytest.approx(10.2, rel=0.01)


def test_it_leaves_its_rail_at_the_certified_speed() -> None:
    assert flight().results[RAIL] == pytest.approx(34.8, rel=0.005)


def test_it_flies_as_the_engine_s_own_system_of_equations_has_it() -> None:
    """The solver of the engine carries altitude and speed too, with a step that it controls."""
    end, t = burnt(), burnt().time[-1]
    assert np.interp(t, flight().column("time"), flight().column("speed")) == pytest.approx(
        float(end.state("speed")[-1]), rel=1e-4
    )
    assert np.interp(t, flight().column("time"), flight().column("altitude")) == pytest.approx(
        float(end.state("altitude")[-1]), rel=1e-4
    )


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


def short(vehicle: Vehicle, speed: float) -> Curve:
    """A burn of a millisecond that gives about a speed [m/s]."""
    push = vehicle.dry_mass * speed / 1e-3
    return Curve(1e-4, np.full(11, push), np.full(11, vehicle.dry_mass), vehicle.dry_mass)


def test_coasting_without_drag_is_the_parabola() -> None:
    rocket = Vehicle(50.0, 0.0, 0.02, 0.0, 0.0)
    coasting = ascend(short(rocket, 200.0), rocket)
    speed = float(coasting.results[SPEED])
    flat = speed**2 / (2.0 * STANDARD_GRAVITY)
    radius = 6_371_000.0
    assert speed == pytest.approx(200.0, rel=1e-3)
    assert coasting.height - 0.5 * speed * 1e-3 == pytest.approx(flat / (1.0 - flat / radius), rel=2e-6)
    assert coasting.results[TIME] - 1e-3 == pytest.approx(speed / STANDARD_GRAVITY, rel=1e-3)


def test_a_finer_clock_gives_the_same_flight() -> None:
    burn_time = burnt().time
    later = np.flatnonzero(np.diff(burn_time, prepend=-1.0) > 0.0)
    mass = flown.mass(maelstrom(), burnt())[later]
    fine = even_curve(burn_time[later], burnt().state("impulse")[later], mass, 52.5, steps=8000)
    assert ascend(fine, ROCKET).height == pytest.approx(flight().height, rel=1e-5)
    assert fine.impulse == pytest.approx(float(burnt().state("impulse")[-1]), rel=1e-12)


def test_a_wind_from_ahead_turns_the_path_at_the_rail_s_end() -> None:
    """tan of the angle to the vertical: horizontal over vertical speed of the rocket through the air."""
    curve, row = flown.curve_of(maelstrom(), burnt()), NOMINAL.copy()
    row[[6, 7]] = 0.0, -10.0
    vertical = replace(ROCKET, launch_angle=0.0)
    turned = ascend(curve, vertical, 6.05, row)
    after = turned.column("time") > 1.0
    climb = np.diff(turned.column("altitude")[after]) / np.diff(turned.column("time")[after])
    mean = 0.5 * (turned.column("speed")[after][1:] + turned.column("speed")[after][:-1])
    tilt = np.arctan(10.0 / turned.results[RAIL])
    assert climb[:100] / mean[:100] == pytest.approx(np.full(100, cos(tilt)), rel=1e-4)
    assert turned.height < ascend(curve, vertical, 6.05).height


def test_a_rocket_that_turns_while_its_engine_still_burns_has_its_apogee_there() -> None:
    fading = np.concatenate([np.full(51, 3000.0), np.full(950, 1.0)])
    rocket = Vehicle(50.0, 0.5, 0.02, 0.0, 0.0)
    flight = ascend(Curve(0.01, fading, np.full(1001, 50.0), 50.0), rocket)
    assert flight.results[TIME] < 10.0
    assert flight.end[2] == 0.0


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


def test_a_main_without_a_deploy_altitude_opens_at_apogee() -> None:
    down = descend(ROCKET, flight().end, DROGUE, Parachute(2.20, 10.5))
    assert down.time_of_main == pytest.approx(flight().end[0], abs=1e-6)
    assert down.drogue_speed == pytest.approx(0.0, abs=1e-6)
    assert down.landing_speed == pytest.approx(descent().landing_speed, rel=1e-3)


def test_a_main_set_above_the_apogee_opens_at_apogee() -> None:
    down = descend(ROCKET, flight().end, DROGUE, Parachute(2.20, 10.5, 9000.0))
    assert down.time_of_main == pytest.approx(flight().end[0], abs=1e-6)


def test_the_drag_coefficient_is_linear_between_the_table_s_mach_numbers() -> None:
    table = Vehicle(50.0, 0.5, 0.02, 0.0, 0.0, (0.3, 0.5, 0.9), (0.5, 0.40, 0.6)).drag_table
    found = [drag_coefficient(mach, table) for mach in (0.0, 0.3, 0.4, 0.5, 0.7, 0.9, 2.0)]
    assert found == pytest.approx([0.5, 0.5, 0.45, 0.40, 0.5, 0.6, 0.6])


def test_a_table_of_one_value_flies_as_that_number() -> None:
    flat = replace(ROCKET, drag_coefficient=0.1, drag_mach=(0.1, 0.5), drag_values=(0.529, 0.529))
    curve = flown.curve_of(maelstrom(), burnt())
    assert ascend(curve, flat, 6.05).results == pytest.approx(flight().results, rel=1e-9)
    assert descend(flat, flight().end, DROGUE, MAIN).ballistic_speed == pytest.approx(descent().ballistic_speed)
    assert apogee(flat, 6000.0, 3.0, 2.5) == pytest.approx(apogee(ROCKET, 6000.0, 3.0, 2.5), rel=1e-9)


def test_more_drag_at_high_mach_numbers_costs_height() -> None:
    rising = replace(ROCKET, drag_mach=(0.3, 0.8), drag_values=(0.529, 0.7))
    assert apogee(rising, 6000.0, 3.0, 2.5) < apogee(ROCKET, 6000.0, 3.0, 2.5)


@pytest.mark.parametrize("altitude", [0.0, 1402.0, 10_999.0, 11_001.0, 24_999.0, 25_001.0, 30_000.0])
def test_the_engines_air_is_the_atmosphere(altitude: float) -> None:
    pressure, density, _ = compiled.air(altitude)
    assert pressure == pytest.approx(atmosphere.pressure(altitude), rel=1e-12)
    assert density == pytest.approx(atmosphere.density(altitude), rel=1e-12)


@pytest.mark.parametrize("altitude", [0.0, 1402.0, 10_999.0, 11_001.0, 24_999.0, 25_001.0, 30_000.0])
def test_the_compiled_air_is_the_atmosphere(altitude: float) -> None:
    pressure, density, sound = compiled.air(altitude)
    assert pressure == pytest.approx(atmosphere.pressure(altitude), rel=1e-12)
    assert density == pytest.approx(atmosphere.density(altitude), rel=1e-12)
    assert sound == pytest.approx(sqrt(1.4 * pressure / density), rel=1e-12)


def test_the_way_down_is_that_of_another_solver() -> None:
    """Drogue, then main, by scipy's LSODA on the report's equations as they stand."""
    time, top, _ = flight().end
    state, start, drag = [top, 0.0], time, 0.0

    def rates(_t: float, y: list[float]) -> list[float]:
        rho = compiled.air(y[0])[1]
        own = ROCKET.drag_coefficient * ROCKET.frontal_area
        return [y[1], -gravity(y[0]) - 0.5 * rho * (drag + own) * y[1] * abs(y[1]) / ROCKET.dry_mass]

    for canopy, floor in ((DROGUE, SITE + 457.0), (MAIN, SITE)):
        drag = canopy.drag_coefficient * canopy.area

        def down(_t: float, y: list[float], floor: float = floor) -> float:
            return y[0] - floor

        down.terminal = True  # type: ignore[attr-defined]
        span = (start, start + 3600.0)
        out = solve_ivp(rates, span, state, method="LSODA", events=down, rtol=1e-10, atol=1e-9)
        start, state = float(out.t[-1]), [float(out.y[0, -1]), float(out.y[1, -1])]
    assert descent().landing_time == pytest.approx(start, rel=1e-7)
    assert descent().landing_speed == pytest.approx(-state[1], rel=1e-7)
