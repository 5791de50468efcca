"""What the effects of injector, grain, chamber and nozzle do: signs, sizes and limits."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from scipy.special import erfcx
from tests.effects.runs import channel, only, own_state, plain, with_effects
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.effects.chamber_heat_loss import cold_share
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.effects.injector_two_phase import critical_ratio, flashing_flow
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Burn


def with_throat(share: float, *effects: Active) -> Burn:
    """A run whose throat is smaller or larger, and with it the chamber's pressure."""
    return with_effects(*effects, rtol=1e-7, throat_area=share * engine_on_stand().throat_area)


def sensitivity_to_back_pressure(*effects: Active) -> float:
    """d ln(flow) / d ln(p_c), at 1 s, from engines with two throats."""
    runs = [with_throat(share, *effects) for share in (0.7, 1.0)]
    flows, pressures = ([channel(run, name, 1.0) for run in runs] for name in ("oxidizer_flow", "chamber_pressure"))
    return float(np.log(flows[0] / flows[1]) / np.log(pressures[0] / pressures[1]))


def test_flashing_flow_is_largest_at_its_critical_ratio() -> None:
    ratios = np.linspace(0.2, 0.99, 2000)
    for omega in (1.0, 2.0, 3.1, 6.0):
        flows = [flashing_flow(float(ratio), omega) for ratio in ratios]
        assert ratios[int(np.argmax(flows))] == pytest.approx(critical_ratio(omega), abs=1e-3)


def test_flashing_flow_near_no_drop_is_that_of_the_liquid() -> None:
    assert flashing_flow(0.9999, 3.1) == pytest.approx(sqrt(2.0 * 1e-4), rel=1e-3)


def test_flashing_liquid_flows_less_and_hardly_responds_to_the_chamber() -> None:
    plain_response = sensitivity_to_back_pressure()
    flashing = sensitivity_to_back_pressure(effect("injector_two_phase").at(weight=1.0, line=0.0))
    assert plain_response < -0.1
    assert abs(flashing) < 0.1 * abs(plain_response)
    assert channel(only("injector_two_phase", weight=1.0, line=0.0), "oxidizer_flow", 1.0) < 0.8 * channel(
        plain(), "oxidizer_flow", 1.0
    )


def test_choking_leaves_the_liquid_alone() -> None:
    choked = only("injector_choked_vapor", weight=1.0)
    assert channel(choked, "oxidizer_flow", 4.0) == pytest.approx(channel(plain(), "oxidizer_flow", 4.0), rel=1e-6)


@pytest.mark.parametrize("vapor", [0.0, 0.6])
def test_the_vapor_takes_as_much_part_in_flashing_as_it_is_said_to(vapor: float) -> None:
    """Without a part it flows as the report says; with one, that share of the weight chokes (g = 1.2)."""
    flashing = only("injector_two_phase", weight=0.1, vapor=vapor)
    assert flashing.liquid_out is not None
    after = flashing.liquid_out + 0.3
    pressure, density = channel(flashing, "tank_pressure", after), channel(flashing, "tank_mass", after) / 16.5e-3
    drop = pressure - channel(flashing, "chamber_pressure", after)
    feed = engine_on_stand().feed
    expected = sqrt(density * drop / (feed.loss_factor + 0.5 / feed.area**2))
    back = channel(flashing, "chamber_pressure", after) / pressure
    assert back < 0.5
    share = 1.0 + 0.1 * vapor * (0.6485 / sqrt(2.0 * (1.0 - back)) - 1.0)
    assert channel(flashing, "oxidizer_flow", after) == pytest.approx(share * expected, rel=1e-5)


def test_gas_that_hardly_expands_flows_as_a_fluid_and_more_drop_only_costs() -> None:
    assert expanding_flow(0.9999, 1.2) == pytest.approx(1.0, abs=1e-4)
    shares = [expanding_flow(ratio, 1.2) for ratio in np.linspace(0.99, 0.0, 100)]
    assert all(np.diff(shares) < 0.0)
    assert shares[-1] == pytest.approx(0.6485 / sqrt(2.0), rel=1e-3)


def test_choked_vapor_flows_as_an_orifice_says() -> None:
    """Deep below the critical ratio mdot / mdot_incompressible = psi / sqrt(2 (1 - eta)), psi = 0.6485 for g = 1.2."""
    found = only("injector_choked_vapor", weight=1.0, gamma=1.2)
    pressure, density = channel(found, "tank_pressure", 9.0), channel(found, "tank_mass", 9.0) / 16.5e-3
    back = channel(found, "chamber_pressure", 9.0)
    feed = engine_on_stand().feed
    plain_flow = sqrt(density * (pressure - back) / (feed.loss_factor + 0.5 / feed.area**2))
    assert back < 0.5 * pressure
    expected = 0.6485 / sqrt(2.0 * (1.0 - back / pressure))
    assert channel(found, "oxidizer_flow", 9.0) / plain_flow == pytest.approx(expected, rel=1e-3)


def test_a_deficit_of_characteristic_velocity_lowers_c_star_by_it() -> None:
    found = only("combustion_efficiency", deficit=0.08)
    assert c_star(found, 2.0) / c_star(plain(), 2.0) == pytest.approx(0.92, abs=2e-3)


def c_star(run: Burn, at: float) -> float:
    return channel(run, "chamber_pressure", at) * engine_on_stand().throat_area / channel(run, "nozzle_flow", at)


def test_after_burn_out_there_is_no_hot_gas_to_lose_anything() -> None:
    for found in (only("combustion_efficiency", deficit=0.3), only("chamber_heat_loss", loss=1e6)):
        at = found.burn_time + 0.3
        assert channel(found, "chamber_temperature_by_mass", at) == pytest.approx(
            188.9 * channel(found, "tank_temperature", at), rel=0.01
        )


@pytest.mark.parametrize("warming", [1e6, 2.0])
def test_heat_into_the_walls_is_missing_in_the_gas(warming: float) -> None:
    """Q = mdot c_p (T_ad - T), 100 kW of some megawatts, of which a wall that has warmed takes less."""
    found = only("chamber_heat_loss", loss=1e5, exponent=0.0, warming=warming)
    flow, rt, gamma = (channel(found, n, 2.0) for n in ("nozzle_flow", "chamber_temperature_by_mass", "gamma"))
    kept = flow * rt * gamma / (gamma - 1.0)
    adiabatic = channel(plain(), "chamber_temperature_by_mass", 2.0)
    lost = flow * (adiabatic - rt) * gamma / (gamma - 1.0)
    assert 2e6 < kept < 1e7
    assert lost == pytest.approx(1e5 * cold_share((2.0 / warming) ** 0.5), rel=0.05)


@pytest.mark.parametrize("root", [1e-3, 0.3, 1.0, 4.9, 5.1, 30.0])
def test_a_thick_wall_takes_what_conduction_carries_away(root: float) -> None:
    """exp(x^2) erfc(x), scaled by another library."""
    assert cold_share(root) == pytest.approx(float(erfcx(root)), rel=1e-3)
    assert cold_share(root) < cold_share(0.9 * root)


def test_no_heat_loss_takes_more_than_the_gas_carries() -> None:
    found = only("chamber_heat_loss", loss=2e6)
    assert found.output("chamber_temperature_by_mass").min() > 0.0
    assert found.output("chamber_pressure").min() > 0.0


def test_fuel_regresses_faster_at_higher_pressure_and_alike_at_the_reference() -> None:
    small, large = (ratio_of_fuel_flows(share, 0.3) for share in (0.7, 1.4))
    assert small > 1.0 > large
    pressure = channel(plain(), "chamber_pressure", 0.02)
    alike = only("grain_pressure_regression", exponent=0.3, reference=pressure)
    assert channel(alike, "fuel_flow", 0.02) == pytest.approx(channel(plain(), "fuel_flow", 0.02), rel=2e-3)


def ratio_of_fuel_flows(throat: float, exponent: float) -> float:
    """Fuel flow right after ignition with the effect over that without."""
    reference = channel(plain(), "chamber_pressure", 0.02)
    strong = effect("grain_pressure_regression").at(exponent=exponent, reference=reference)
    return channel(with_throat(throat, strong), "fuel_flow", 0.02) / channel(with_throat(throat), "fuel_flow", 0.02)


def test_a_sliver_burns_longer_with_less_thrust_and_all_of_it_goes() -> None:
    found = only("fuel_sliver", depth=0.8, width=3e-3, tail=0.5)
    assert found.fuel_out
    assert found.burn_time > plain().burn_time + 0.3
    assert channel(found, "port_radius", 9.9) == pytest.approx(engine_on_stand().outer_radius, rel=1e-6)
    last = found.burn_time - 0.01
    assert channel(found, "fuel_flow", last) < 0.4 * channel(plain(), "fuel_flow", plain().burn_time - 0.01)


def test_thin_slivers_leave_what_burns_before_alone() -> None:
    found = only("fuel_sliver", depth=0.8, width=1e-3, tail=0.5)
    assert channel(found, "fuel_flow", 4.0) == pytest.approx(channel(plain(), "fuel_flow", 4.0), rel=1e-3)


def test_walls_show_one_after_another() -> None:
    """What burns of the surface leaves 1 without a corner: A^2 = 1 - exp(-2 (R - r) / w) for k = 1/2 and d = 1."""
    found, e = only("fuel_sliver", depth=1.0, width=3e-3, tail=0.5), engine_on_stand()
    webs = []
    for t in np.arange(1.0, found.burn_time - 0.3, 0.25):
        radius, flow = channel(found, "port_radius", t), channel(found, "oxidizer_flow", t)
        surface = 2.0 * np.pi * radius * e.grain_length
        whole = e.fuel_density * surface * e.a * (flow / (np.pi * radius**2)) ** e.n
        webs.append((e.outer_radius - radius) / 3e-3)
        share = channel(found, "fuel_flow", t) / whole
        assert share == pytest.approx(sqrt(1.0 - (1.0 - 0.005**2) * np.exp(-2.0 * webs[-1])), rel=1e-3)
    assert webs[0] > 2.0 > 0.5 > webs[-1]


@pytest.mark.parametrize("tail", [0.5, 0.95])
def test_even_a_grain_that_shows_the_wall_all_over_burns_out(tail: float) -> None:
    assert only("fuel_sliver", depth=0.95, width=2e-2, tail=tail).time[-1] == pytest.approx(10.0)


def test_remainders_of_any_thinness_fade_exponentially() -> None:
    """k = 1 and all walls seen in the end: dr/dt = r' (R - r) / w."""
    slow, even = (only("fuel_sliver", depth=1.0, width=6e-3, tail=k) for k in (0.97, 0.5))
    left = [engine_on_stand().outer_radius - channel(slow, "port_radius", t) for t in (4.0, 5.0, 6.0)]
    assert left[0] < 6e-3
    # the flow of the vapor falls: so does the rate, but by less than half
    assert 1.0 < np.log(left[0] / left[1]) / np.log(left[1] / left[2]) < 2.0
    assert channel(slow, "port_radius", 9.9) < channel(even, "port_radius", 9.9)


def test_an_igniter_gives_its_mass_and_lifts_the_chamber_for_its_duration() -> None:
    found = only("ignition_transient", mass=0.1, duration=0.5)
    assert own_state(found, 0, 0.0) == pytest.approx(0.1)
    assert own_state(found, 0, 1.0) == pytest.approx(0.0, abs=1e-6)
    extra = [channel(found, "chamber_pressure", t) - channel(plain(), "chamber_pressure", t) for t in (0.12, 0.49, 1.0)]
    assert extra[0] > 2e5
    assert extra[1] < 0.1 * extra[0]
    assert abs(extra[2]) < 0.02e5


def test_the_throat_grows_by_rate_and_time_at_the_stated_pressure() -> None:
    """What is left of it while the wall heats is the integral of t^2 / (t^2 + tau^2): t - tau atan(t / tau)."""
    found = only("nozzle_throat_erosion", rate=2e-4, exponent=0.0, heating=1.5)
    assert own_state(found, 0, 5.0) == pytest.approx(2e-4 * (5.0 - 1.5 * np.arctan(5.0 / 1.5)), rel=1e-3)
    at_end = own_state(found, 0, found.burn_time)
    assert own_state(found, 0, 9.9) == pytest.approx(at_end, rel=2e-3)


def test_a_grown_throat_is_one_made_larger() -> None:
    """Once it has grown, chamber pressure is that of a nozzle of that throat: p_c A_t / mdot = c* stays."""
    found = only("nozzle_throat_erosion", rate=4e-4, heating=0.01)
    growth = own_state(found, 0, 4.0)
    radius = 0.0233 + growth
    assert growth > 1e-3
    star = channel(found, "chamber_pressure", 4.0) * np.pi * radius**2 / channel(found, "nozzle_flow", 4.0)
    assert star == pytest.approx(c_star(plain(), 4.0), rel=5e-3)


def test_a_diverging_nozzle_costs_thrust_and_nothing_else() -> None:
    found = only("nozzle_divergence", loss=0.03)
    ratio = channel(found, "thrust", 3.0) / channel(plain(), "thrust", 3.0)
    assert ratio == pytest.approx(0.97, rel=1e-6)
    assert channel(found, "chamber_pressure", 3.0) == pytest.approx(channel(plain(), "chamber_pressure", 3.0), rel=1e-6)
