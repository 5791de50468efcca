"""The steady-state design against the report's tables, checked independently, and its closed forms."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from hfanalysis.engine.grain import Grain
from hfanalysis.flight.constant_thrust import Vehicle, apogee, rail_speed
from hfanalysis.steady_design.steady import Requirement, SteadyEngine, design, fuel_for_apogee, ideal_specific_impulse

ROCKET = Vehicle(52.5, 0.529, 19478e-6, radians(6.0), 1402.0)
GRAIN = Grain(0.610, 0.039497, 900.0, 1.32e-4, 0.555)
DESIGN = Requirement(2.5, 27.579e5, 0.84623 * 101325.0, 0.0381)
IDEAL = replace(DESIGN, exit_radius=None)
TARGET = 3048.0


def solved(requirement: Requirement, grain: Grain, vehicle: Vehicle = ROCKET) -> SteadyEngine:
    return design(requirement, grain, fuel_for_apogee(requirement, grain, vehicle, TARGET))


@pytest.fixture(scope="module")
def engine() -> SteadyEngine:
    return solved(DESIGN, GRAIN)


@pytest.mark.parametrize(
    ("quantity", "certified"),
    [
        ("oxidizer_mass", 6.102),
        ("fuel_mass", 1.422),
        ("of_ratio", 4.290),
        ("chamber_temperature", 2666.0),
        ("thrust", 6756.0),
        ("throat_radius", 23.29e-3),
        ("specific_impulse", 223.5),
        ("total_impulse", 16489.0),
    ],
)
def test_the_design_point_is_the_certified_one(engine: SteadyEngine, quantity: str, certified: float) -> None:
    assert getattr(engine, quantity) == pytest.approx(certified, rel=0.005)


def test_its_burn_time_and_thrust_to_weight_are_certified(engine: SteadyEngine) -> None:
    assert engine.burn_time == pytest.approx(2.441, abs=0.010)
    assert engine.thrust_to_weight(ROCKET) == pytest.approx(11.48, rel=0.005)


def test_it_reaches_its_target(engine: SteadyEngine) -> None:
    assert apogee(ROCKET, engine.thrust, engine.propellant_flow, engine.burn_time) == pytest.approx(TARGET, abs=0.05)


def test_the_first_design_has_the_ideally_expanded_nozzle() -> None:
    first = solved(
        replace(IDEAL, oxidizer_flow=2.0), replace(GRAIN, length=0.813), replace(ROCKET, drag_coefficient=0.75)
    )
    assert first.fuel_mass == pytest.approx(2.310, rel=0.005)
    assert first.thrust == pytest.approx(5336.0, rel=0.005)
    assert first.burn_time == pytest.approx(3.349, abs=0.010)


def test_a_shorter_grain_reaches_the_best_mixture() -> None:
    flows = (2.5, 2.8, 3.1)
    short = replace(GRAIN, length=0.457)
    ideal = max(solved(replace(IDEAL, oxidizer_flow=f), short).specific_impulse for f in flows)
    fixed = max(solved(replace(DESIGN, oxidizer_flow=f), short).specific_impulse for f in (2.0, 2.2, 2.4, *flows))
    assert ideal == pytest.approx(237.6, rel=0.002)
    assert fixed == pytest.approx(233.2, rel=0.005)


def test_the_chosen_grain_is_best_near_2_7_kilograms_a_second() -> None:
    impulses = [solved(replace(DESIGN, oxidizer_flow=f), GRAIN).specific_impulse for f in (2.3, 2.7, 3.1)]
    assert impulses[1] == pytest.approx(223.7, rel=0.002)
    assert max(impulses) == impulses[1]


@given(st.floats(0.5, 6.0), st.floats(0.2, 0.9), st.floats(0.1, 0.95), st.floats(2e-5, 3e-4), st.floats(0.2, 1.0))
def test_the_burn_time_is_the_integral_of_the_regression(
    flow: float, n: float, share: float, a: float, length: float
) -> None:
    """Closed form against dt = dr / (a G^n); the mean fuel flow is the fuel over that time."""
    grain = Grain(length, 0.04, 900.0, a, n)
    mass = share * pi * grain.outer_radius**2 * length * grain.density
    slowness = quad(lambda r: 1.0 / (a * (flow / (pi * r * r)) ** n), grain.port_radius(mass), 0.04, epsrel=1e-10)[0]
    assert grain.burn_time(flow, mass) == pytest.approx(slowness, rel=1e-8)


def test_the_port_opens_to_the_outer_radius_in_the_burn_time() -> None:
    time = GRAIN.burn_time(2.5, 1.422)
    out = solve_ivp(
        lambda _t, r: GRAIN.a * (2.5 / (pi * r**2)) ** GRAIN.n,
        (0.0, time),
        [GRAIN.port_radius(1.422)],
        rtol=1e-10,
        atol=1e-14,
    )
    assert out.y[0, -1] == pytest.approx(GRAIN.outer_radius, rel=1e-8)


def test_the_ideal_nozzle_is_the_best_nozzle() -> None:
    impulses = [design(replace(DESIGN, exit_radius=r), GRAIN, 1.422).specific_impulse for r in (0.035, 0.042, 0.055)]
    ideal = design(IDEAL, GRAIN, 1.422)
    assert max(impulses) <= ideal.specific_impulse
    assert design(replace(DESIGN, exit_radius=ideal.exit_radius), GRAIN, 1.422).specific_impulse == pytest.approx(
        ideal.specific_impulse, rel=1e-9
    )
    assert ideal.specific_impulse == pytest.approx(ideal_specific_impulse(DESIGN, ideal.of_ratio), rel=1e-9)


def test_a_denser_chamber_gives_more_impulse() -> None:
    """The report's figure of I_sp against O/F: 20.7 to 34.5 bar in order."""
    impulses = [ideal_specific_impulse(replace(IDEAL, chamber_pressure=p), 6.33) for p in (20.7e5, 27.6e5, 34.5e5)]
    assert impulses == sorted(impulses)


def test_the_ideal_exit_outgrows_the_casing_at_1_5_kilograms_a_second() -> None:
    radii = [solved(replace(IDEAL, oxidizer_flow=f), GRAIN).exit_radius for f in (1.4, 1.6)]
    assert radii[0] < 0.0381 < radii[1]


def test_more_fuel_than_the_casing_holds_is_refused() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        GRAIN.port_radius(1.01 * pi * GRAIN.outer_radius**2 * GRAIN.length * GRAIN.density)


def test_an_exit_smaller_than_the_throat_is_refused() -> None:
    with pytest.raises(ValueError, match="smaller than the throat"):
        design(replace(DESIGN, exit_radius=0.020), GRAIN, 1.422)


def test_a_target_out_of_reach_is_refused() -> None:
    with pytest.raises(ValueError, match="no grain in this casing"):
        fuel_for_apogee(DESIGN, replace(GRAIN, length=0.2), replace(ROCKET, dry_mass=150.0), TARGET)


def test_the_throat_passes_the_flow(engine: SteadyEngine) -> None:
    velocity = 27.579e5 * pi * engine.throat_radius**2 / engine.propellant_flow
    assert velocity == pytest.approx(27.579e5 * pi * 0.02329**2 / (7.524 / 2.441), rel=0.002)
    assert sqrt(2.0) * 1000.0 < velocity < 1700.0


def test_the_speed_at_the_rails_end_is_that_of_a_constant_acceleration(engine: SteadyEngine) -> None:
    """v^2 = 2 (F/m - g cos 6 deg) L, but for the propellant that is gone by then (1 kg of 60) and the drag (5 N)."""
    mass = ROCKET.dry_mass + engine.oxidizer_mass + engine.fuel_mass
    expected = sqrt(2.0 * (engine.thrust / mass - 9.80 * 0.9945) * 6.05)
    found = rail_speed(ROCKET, engine.thrust, engine.propellant_flow, engine.burn_time, 6.05)
    assert found == pytest.approx(expected, rel=0.01)
