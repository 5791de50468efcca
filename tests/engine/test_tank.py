"""The self-pressurising tank, emptied: mass and energy close, and the phases follow their laws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson
from scipy.optimize import brentq

from hfanalysis.arrays import Array
from hfanalysis.engine.blowdown import TankRun, blow_down
from hfanalysis.engine.closure import implied_heat
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.tank import (
    SPECIFIC_GAS_CONSTANT,
    compressibility,
    internal_energy,
    mass_along,
    mass_along_blowdown,
    split,
)
from hfanalysis.thermo.nitrous import SOURCES, saturation
from hfanalysis.thermo.saturation import Property, Saturation

VOLUME = 16.5e-3
MASS = 10.0
TEMPERATURE = 293.15
FEED = FeedSystem(VOLUME, 2.0e-5, 6.5e8)
CHAMBER = 12e5

both_sources = pytest.mark.parametrize("source", SOURCES)


def emptied(
    source: str = "coolprop",
    feed: FeedSystem = FEED,
    m: float = 1.1,
    step: float = 1e-3,
    end: float = 12.0,
    chamber: float = CHAMBER,
    mass: float = MASS,
    heat: float = 0.0,
) -> TankRun:
    time = np.arange(0.0, end, step)
    return blow_down(saturation(source), feed, mass, TEMPERATURE, time, np.full(time.size, chamber), m, heat)


def liquid_part(run: TankRun) -> slice:
    return slice(0, int(np.searchsorted(run.time, run.t_v)))


def energy(nitrous: Saturation, mass: Array, temperature: Array) -> Array:
    """U of a saturated tank [J]."""
    return np.array(
        [
            parts.liquid * float(nitrous.energy(Property.LIQUID_ENERGY, t)[0])
            + parts.vapor * float(nitrous.energy(Property.VAPOR_ENERGY, t)[0])
            for m, t in zip(mass, temperature, strict=True)
            if (parts := split(nitrous, VOLUME, float(m), float(t)))
        ]
    )


@both_sources
@given(fill=st.floats(0.02, 0.98), place=st.floats(0.0, 1.0))
def test_liquid_and_vapor_fill_the_tank(source: str, fill: float, place: float) -> None:
    nitrous = saturation(source)
    t = 190.0 + place * 115.0
    rho_l, rho_v = float(nitrous.liquid_density(t)), float(nitrous.vapor_density(t))
    mass = VOLUME * (fill * rho_l + (1.0 - fill) * rho_v)
    parts = split(nitrous, VOLUME, mass, t)
    assert parts.liquid + parts.vapor == pytest.approx(mass, rel=1e-12)
    assert parts.liquid / rho_l + parts.vapor / rho_v == pytest.approx(VOLUME, rel=1e-9)
    assert parts.liquid == pytest.approx(fill * VOLUME * rho_l, rel=1e-9)


def test_a_tank_that_cannot_be_saturated_shows_in_the_sign() -> None:
    nitrous = saturation()
    assert split(nitrous, VOLUME, 0.9 * VOLUME * float(nitrous.vapor_density(TEMPERATURE)), TEMPERATURE).liquid < 0.0
    assert split(nitrous, VOLUME, 1.1 * VOLUME * float(nitrous.liquid_density(TEMPERATURE)), TEMPERATURE).vapor < 0.0


@both_sources
def test_what_leaves_the_tank_has_passed_the_injector(source: str) -> None:
    run = emptied(source)
    for part in (liquid_part(run), slice(liquid_part(run).stop, None)):
        passed = cumulative_simpson(run.flow[part], x=run.time[part], initial=0.0)
        np.testing.assert_allclose(run.mass[part] + passed, run.mass[part][0], rtol=1e-6)
    assert run.mass[-1] < 0.2 * MASS


@both_sources
@pytest.mark.parametrize("heat", [0.0, 20e3])
def test_a_saturated_tank_closes_in_energy(source: str, heat: float) -> None:
    """U + integral of h_l dm changes by the heat alone."""
    nitrous, run = saturation(source), emptied(source, heat=heat)
    part = liquid_part(run)
    time, mass, temperature = run.time[part], run.mass[part], run.temperature[part]
    h = nitrous.energy(Property.LIQUID_ENTHALPY, temperature)[0]
    carried = cumulative_simpson(run.flow[part] * h, x=time, initial=0.0)
    u = energy(nitrous, mass, temperature)
    gained = u + carried - u[0]
    np.testing.assert_allclose(gained, heat * time, atol=1e-5 * np.abs(carried[-1]))


def test_the_emptied_tank_is_a_state_of_the_equation_of_state_itself() -> None:
    """Density and temperature, given to CoolProp, return the tank's pressure and the energy that is left."""
    from CoolProp import CoolProp

    nitrous, run = saturation(), emptied()
    part = liquid_part(run)
    h = nitrous.energy(Property.LIQUID_ENTHALPY, run.temperature[part])[0]
    carried = cumulative_simpson(run.flow[part] * h, x=run.time[part], initial=0.0)
    state = CoolProp.AbstractState("HEOS", "NitrousOxide")
    u = []
    for i in (0, part.stop - 1):
        state.update(CoolProp.DmassT_INPUTS, run.mass[i] / VOLUME, run.temperature[i])
        assert state.p() == pytest.approx(run.pressure[i], rel=1e-6)
        u.append(run.mass[i] * state.umass())
    assert u[1] + carried[-1] == pytest.approx(u[0], abs=1e-5 * carried[-1])


def test_heat_keeps_the_pressure_up() -> None:
    cold, warm = emptied(), emptied(heat=50e3)
    i = liquid_part(cold).stop - 1
    assert warm.pressure[i] > cold.pressure[i] + 1e5
    assert warm.t_v < cold.t_v


def test_the_end_of_the_liquid_is_found_inside_its_step() -> None:
    """Refining the step moves t_v by less and less: at 4 ms it stands to a tenth of a millisecond."""
    exact = emptied(step=2.5e-4).t_v
    errors = [abs(emptied(step=h).t_v - exact) for h in (0.064, 0.016, 0.004)]
    assert errors[0] < 5e-3
    assert errors[2] < 1e-4
    assert errors[2] <= errors[1] <= errors[0]
    assert errors[2] < 0.05 * errors[0]


@both_sources
def test_at_the_end_of_the_liquid_only_saturated_vapor_is_left(source: str) -> None:
    run = emptied(source, m=1.0)
    t_empty = run.temperature[-1]  # m = 1 holds it
    nitrous = saturation(source)
    left = VOLUME * float(nitrous.vapor_density(t_empty))
    near = np.searchsorted(run.time, run.t_v)
    assert run.mass[near] < left < run.mass[near - 1]
    assert run.pressure[near - 1] > float(nitrous.pressure(t_empty)) > run.pressure[near]


@both_sources
def test_temperature_alone_tells_the_mass_of_an_adiabatic_blowdown(source: str) -> None:
    run = emptied(source, m=1.0)
    part = liquid_part(run)
    chosen = np.r_[0 : part.stop : 400, part.stop - 1]
    mass = mass_along_blowdown(saturation(source), VOLUME, run.temperature[-1], run.temperature[chosen])
    np.testing.assert_allclose(mass, run.mass[chosen], rtol=1e-5)


def test_the_way_up_along_a_blowdown_is_the_way_down() -> None:
    nitrous = saturation()
    temperatures = np.array([290.0, 284.0, 277.0])
    down = mass_along(nitrous.kernel_table, VOLUME, MASS, TEMPERATURE, temperatures)
    up = mass_along(
        nitrous.kernel_table, VOLUME, float(down[-1]), temperatures[-1], np.array([284.0, 290.0, TEMPERATURE])
    )
    assert up == pytest.approx([down[1], down[0], MASS], rel=1e-9)


def test_the_energy_of_a_tank_is_that_of_its_phases() -> None:
    nitrous = saturation()
    mass, temperature = np.array([10.0, 6.0]), np.array([293.0, 280.0])
    assert internal_energy(nitrous, VOLUME, mass, temperature) == pytest.approx(energy(nitrous, mass, temperature))


def test_a_tank_below_its_chamber_holds_the_line_at_its_own_pressure() -> None:
    """Nothing flows, and nothing is lost on the way."""
    run = emptied(chamber=70e5, end=0.1)
    assert run.run_pressure.tolist() == run.pressure.tolist()


@pytest.mark.parametrize("m", [0.75, 1.0, 1.3])
def test_the_vapor_expands_along_its_polytrope(m: float) -> None:
    run = emptied(m=m)
    after = slice(liquid_part(run).stop, None)
    p, mass, t = run.pressure[after], run.mass[after], run.temperature[after]
    assert mass[-1] < 0.6 * mass[0]
    np.testing.assert_allclose(p / p[0], (mass / mass[0]) ** m, rtol=1e-10)
    np.testing.assert_allclose(t / t[0], (mass / mass[0]) ** (m - 1.0), rtol=1e-10)


def test_the_compressibility_factor_holds_over_the_vapor_phase() -> None:
    run = emptied(m=1.15)
    after = range(liquid_part(run).stop, run.time.size, 1000)
    z = [compressibility(run.pressure[i], VOLUME, run.mass[i], run.temperature[i]) for i in after]
    assert z == pytest.approx([z[0]] * len(z), rel=1e-10)
    assert 0.6 < z[0] < 0.95  # nitrous oxide vapor at 20 to 40 bar


def test_a_line_with_a_loss_factor_loses_with_the_square_of_the_flow() -> None:
    run = emptied()
    nitrous = saturation()
    for i in range(0, liquid_part(run).stop, 500):
        density = float(nitrous.liquid_density(run.temperature[i]))
        expected = mass_flow_with_feed(FEED.area, FEED.loss_factor, density, run.pressure[i] - CHAMBER)
        assert run.flow[i] == pytest.approx(expected, rel=1e-9)


def test_constant_losses_take_their_own_phase() -> None:
    liquid, vapor = 6.0e5, 3.0e5
    run = emptied(feed=FeedSystem(VOLUME, 2.0e-5, 6.5e8, (liquid, vapor)))
    nitrous = saturation()
    end = liquid_part(run).stop
    for i in (0, end // 2, end - 1):
        density = float(nitrous.liquid_density(run.temperature[i]))
        assert run.flow[i] == pytest.approx(mass_flow(2.0e-5, density, run.pressure[i] - liquid - CHAMBER), rel=1e-9)
    for i in (end, end + 500):
        assert run.flow[i] == pytest.approx(
            mass_flow(2.0e-5, run.mass[i] / VOLUME, run.pressure[i] - vapor - CHAMBER), rel=1e-9
        )


def test_a_constant_loss_stops_the_flow_above_the_chamber_and_a_quadratic_one_does_not() -> None:
    """Why the model uses K_loss: with a constant loss the tank keeps what it has while the chamber is still below."""
    constant = emptied(feed=FeedSystem(VOLUME, 2.0e-5, 0.0, (3e5, 3e5)), end=60.0, step=5e-3)
    quadratic = emptied(end=60.0, step=5e-3)
    assert constant.pressure[-1] == pytest.approx(CHAMBER + 3e5, rel=1e-3)
    assert quadratic.pressure[-1] == pytest.approx(CHAMBER, rel=1e-3)


def test_a_chamber_above_the_tank_keeps_everything_in() -> None:
    run = emptied(chamber=70e5, end=1.0)
    assert (run.flow == 0.0).all()
    assert (run.mass == MASS).all()
    assert np.isnan(run.t_v)


def test_a_tank_of_saturated_vapor_starts_in_the_vapor_phase() -> None:
    nitrous = saturation()
    mass = VOLUME * float(nitrous.vapor_density(TEMPERATURE))
    run = emptied(mass=mass * (1.0 - 1e-12), m=1.2, end=2.0)
    assert run.t_v == 0.0
    assert run.pressure[0] == pytest.approx(float(nitrous.pressure(TEMPERATURE)), rel=1e-9)
    assert run.flow[0] == pytest.approx(
        mass_flow_with_feed(FEED.area, FEED.loss_factor, mass / VOLUME, run.pressure[0] - CHAMBER), rel=1e-9
    )
    np.testing.assert_allclose(run.pressure, run.pressure[0] * (run.mass / run.mass[0]) ** 1.2, rtol=1e-10)


def test_the_chamber_pressure_is_taken_linear_between_its_samples() -> None:
    """A burn against a falling chamber pressure does not depend on how finely it was logged."""
    runs = []
    for step in (0.05, 0.001):
        time = np.arange(0.0, 4.0, step)
        runs.append(blow_down(saturation(), FEED, MASS, TEMPERATURE, time, 20e5 - 2e5 * time, 1.1))
    coarse, fine = runs
    np.testing.assert_allclose(coarse.mass, np.interp(coarse.time, fine.time, fine.mass), rtol=1e-5)


@pytest.mark.parametrize("m", [0.75, 0.95, 1.0, 1.1, 1.3])
@pytest.mark.parametrize("t", [260.0, 275.0, 285.0])
def test_the_heat_that_an_exponent_implies_is_that_of_the_equation_of_state(m: float, t: float) -> None:
    """Q = [M u] and h of what leaves, along p = p_v (M/M_v)^m, with CoolProp's u, h at each pressure and density."""
    from CoolProp import CoolProp

    gas = CoolProp.AbstractState("HEOS", "NitrousOxide")
    gas.update(CoolProp.QT_INPUTS, 1.0, t)
    density, pressure = gas.rhomass(), gas.p()
    gas.specify_phase(CoolProp.iphase_gas)
    mass = np.linspace(1.2, 0.9, 201)
    energy, enthalpy = [], []
    for left in mass:
        rho, target = density * left / mass[0], pressure * (left / mass[0]) ** m

        def excess(warm: float, rho: float = rho, target: float = target) -> float:
            gas.update(CoolProp.DmassT_INPUTS, rho, warm)  # below saturation too, as vapor
            return float(gas.p()) - target

        brentq(excess, t - 40.0, t + 80.0)
        energy.append(gas.umass())
        enthalpy.append(gas.hmass())
    exact = mass[-1] * energy[-1] - mass[0] * energy[0] - np.trapezoid(enthalpy, mass)
    z = pressure / (density * SPECIFIC_GAS_CONSTANT * t)
    displaced = pressure / density * (mass[0] - mass[-1])
    assert implied_heat(saturation(), m, mass[0], mass[-1], t, z) == pytest.approx(exact, abs=0.1 * displaced)


def test_an_adiabatic_expansion_takes_no_heat() -> None:
    nitrous, t = saturation(), 270.0
    m = float(nitrous.isentropic_exponent(t))
    assert implied_heat(nitrous, m, 1.2, 0.5, t, 0.7) == pytest.approx(0.0, abs=1e-9)


def test_the_exponent_zero_is_no_exception() -> None:
    """A constant pressure: p V ln(M_v/M) is what the pressure would have to be held up with, times m_s/G."""
    nitrous, z, t = saturation(), 0.7, 270.0
    factor = float(nitrous.isentropic_exponent(t) / nitrous.grueneisen(t))
    held = z * SPECIFIC_GAS_CONSTANT * t * 1.2
    assert implied_heat(nitrous, 0.0, 1.2, 0.5, t, z) == pytest.approx(factor * held * np.log(1.2 / 0.5), rel=1e-12)


def test_an_exponent_below_one_heats_the_gas_with_tens_of_kilowatts() -> None:
    heat = implied_heat(saturation(), 0.75, 1.4, 0.9, 270.0, 0.75)
    assert heat > implied_heat(saturation(), 1.0, 1.4, 0.9, 270.0, 0.75)
    assert heat / 0.72 > 20e3  # over the 0.72 s of HF5's vapor phase
