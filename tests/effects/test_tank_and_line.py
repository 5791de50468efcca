"""What the effects of tank and feed line do: signs, sizes and limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.effects.runs import channel, only, own_state, plain, with_effects
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.effects.feed_line_fill import FULL_AT, LIQUID_DENSITY
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, energy_derivatives
from hfanalysis.engine.unsteady import Burn, burn

AT_REST = float(engine_on_stand().saturation.pressure(engine_on_stand().temperature))
"""The tank's pressure before anything flows [Pa]."""


@pytest.mark.parametrize(("lag", "begun"), [(0.02, 0.0), (0.1, 0.0), (2.0, 0.0), (2.0, 0.4), (2.0, 1.0)])
def test_heat_keeps_the_tank_warmer_by_the_energy_it_brings(lag: float, begun: float) -> None:
    """Before anything flows or fades much: m c dT = P (t - (1 - s) tau (1 - exp(-t/tau))), with the saturated tank's
    own heat capacity."""
    warm = only("tank_heat", power=2000.0, lag=lag, fade=500.0, begun=begun)
    gain = channel(warm, "tank_temperature", 0.2) - channel(plain(), "tank_temperature", 0.2)
    _, by_temperature, _ = energy_derivatives(engine_on_stand().saturation.kernel_table, 16.5e-3, 8.2, 292.6)
    brought = 2000.0 * (0.2 - (1.0 - begun) * lag * (1.0 - np.exp(-0.2 / lag)))
    assert gain == pytest.approx(brought / by_temperature, rel=0.02)


def test_nitrogen_enters_from_the_opening_on_and_is_conserved() -> None:
    found = with_effects(effect("n2_purge").at(area=4e-6, supply_pressure=35e5))
    pressure, inflow = found.output("tank_pressure"), found.output("nitrogen_inflow")
    assert (inflow[pressure > (35e5 - 4.27e5)] == 0.0).all()
    assert inflow[-1] > 0.0
    held = found.state("tank_nitrogen")[-1]
    entered = np.trapezoid(inflow, found.time)
    left = np.trapezoid(found.output("oxidizer_flow") * found.output("nitrogen_share"), found.time)
    assert held + left == pytest.approx(entered, rel=2e-3)
    assert held > 0.0


def test_a_valve_that_closes_where_the_pressure_hardly_moves_stops_no_run() -> None:
    """After a dip the tank's pressure comes up to a flat top, a few pascal above that at which the valve opens."""
    dip = effect("tank_nonequilibrium").at(depth=9e5, delay=0.1, sustained=0.1)
    dipping = burn(engine_on_stand(effects=(dip,)), 3.0)
    pressure = dipping.output("tank_pressure")
    lowest = int(np.argmin(np.where(dipping.time < 0.6, pressure, np.inf)))
    top = float(pressure[lowest:].max())
    assert top > pressure[lowest] + 5e5
    for below in np.geomspace(1.0, 1e5, 80):
        purge = effect("n2_purge").at(area=4e-5, supply_pressure=top - below + 4e5, cracking_pressure=4e5)
        assert burn(engine_on_stand(effects=(dip, purge)), 3.0).time[-1] > 2.9


def test_nitrogen_is_choked_below_the_critical_ratio_of_its_line() -> None:
    """ISO 6358: mdot is that of the choked flow below p_2 / p_1 = b, and falls by an ellipse to nothing above."""
    flows = {}
    for b in (0.2, 0.5):
        found = with_effects(effect("n2_purge").at(area=4e-7, supply_pressure=80e5, critical_ratio=b))
        ratio = (found.output("tank_pressure") + 4.27e5) / 80e5
        flow = found.output("nitrogen_inflow") / (4e-7 * 0.6847 * 80e5 / np.sqrt(296.8 * 293.15))
        between = (ratio > b + 0.01) & (ratio < 0.95)
        assert between.sum() > 10
        assert flow[between] == pytest.approx(np.sqrt(1.0 - ((ratio[between] - b) / (1.0 - b)) ** 2), rel=2e-3)
        flows[b] = flow[ratio < b]
    assert flows[0.5].size > 10
    assert flows[0.5] == pytest.approx(1.0, rel=2e-3)


def test_the_wall_gives_what_it_loses_and_cools_behind_the_oxidizer() -> None:
    found = only("tank_wall_heat_capacity", capacity=4000.0)
    wall, oxidizer = own_state(found, 0, 5.0), channel(found, "tank_temperature", 5.0)
    assert oxidizer < wall < 293.0
    given = 4000.0 * (293.0 - wall)
    _, by_temperature, _ = energy_derivatives(engine_on_stand().saturation.kernel_table, 16.5e-3, 2.5, 280.0)
    warmer = oxidizer - channel(plain(), "tank_temperature", 5.0)
    # most of it came early, into a tank that held more
    assert 0.3 * given < by_temperature * warmer < given


def test_a_wall_left_hot_by_blankets_gives_kilowatts() -> None:
    """C dT / tau: 4 kJ/K at 40 K above the oxidizer over 25 s are 6.4 kW at ignition, where liquid wets the wall."""
    hot, level = (only("tank_wall_heat_capacity", capacity=4000.0, excess=k, vapor_share=0.2) for k in (40.0, 0.0))
    gain = channel(hot, "tank_temperature", 0.2) - channel(level, "tank_temperature", 0.2)
    _, by_temperature, _ = energy_derivatives(engine_on_stand().saturation.kernel_table, 16.5e-3, 8.2, 292.6)
    gas = engine_on_stand().saturation
    liquid, vapor = float(gas.liquid_density(292.6)), float(gas.vapor_density(292.6))
    wetted = (channel(level, "tank_mass", 0.1) / 16.5e-3 - vapor) / (liquid - vapor)
    assert gain * by_temperature == pytest.approx(6400.0 * 0.2 * (wetted + 0.2 * (1.0 - wetted)), rel=0.03)


def test_late_boiling_dips_by_its_depth_and_rebounds() -> None:
    found = only("tank_nonequilibrium", depth=3e5, delay=0.25, sustained=0.0)
    assert gap(found, 0.25) == pytest.approx(-3e5 * channel(plain(), "tank_pressure", 0.25) / AT_REST, rel=0.02)
    assert abs(gap(found, 0.0)) < 1.0
    # what did not flow out meanwhile is still there
    assert 0.0 < gap(found, 3.0) < 0.03 * 3e5


@pytest.mark.parametrize("sustained", [0.2, 1.0])
def test_a_sustained_dip_stays_to_the_end_of_the_liquid(sustained: float) -> None:
    found = only("tank_nonequilibrium", depth=3e5, delay=0.25, sustained=sustained)
    assert found.liquid_out is not None
    early, late = (below_saturation(found, at) * AT_REST for at in (0.25, found.liquid_out - 1e-3))
    assert early == pytest.approx(3e5 * (1.0 - sustained / np.e), rel=1e-4)
    assert late == pytest.approx(3e5 * sustained, rel=1e-4)


def test_the_vapor_goes_on_from_the_lower_pressure_without_a_leap() -> None:
    """What the liquid leaves behind expands like the report's vapor, its pressure lower in proportion."""
    found = only("tank_nonequilibrium", depth=3e5, delay=0.25, sustained=1.0)
    gone = found.liquid_out
    assert gone is not None
    before, after = (channel(found, "tank_pressure", gone + wait) for wait in (-1e-6, 1e-6))
    assert after == pytest.approx(before, rel=1e-5)
    for at in (gone + 1e-6, gone + 0.5, gone + 1.5):
        held = channel(found, "tank_mass", at) * channel(found, "vapor_compressibility", at)
        vapor = held * SPECIFIC_GAS_CONSTANT * channel(found, "tank_temperature", at) / engine_on_stand().feed.volume
        assert channel(found, "tank_pressure", at) == pytest.approx(vapor * (1.0 - 3e5 / AT_REST), rel=1e-4)


def below_saturation(run: Burn, at: float) -> float:
    """Part of the saturation pressure at the tank's temperature that the tank's pressure lacks."""
    saturated = float(engine_on_stand().saturation.pressure(channel(run, "tank_temperature", at)))
    return 1.0 - channel(run, "tank_pressure", at) / saturated


def gap(run: Burn, at: float) -> float:
    """Tank pressure against the plain engine's [Pa]."""
    return channel(run, "tank_pressure", at) - channel(plain(), "tank_pressure", at)


def test_a_hot_ullage_starts_at_its_own_saturation_and_falls_to_the_bulks() -> None:
    found = only("tank_stratification", excess=2.0)
    saturation = engine_on_stand().saturation
    above = float(saturation.pressure(295.0) - saturation.pressure(293.0))
    assert gap(found, 0.0) == pytest.approx(above, rel=0.02)
    assert 0.0 < gap(found, 0.3) < 0.6 * above
    assert abs(gap(found, 3.0)) < 0.02 * above


def test_a_hot_ullage_is_spent_by_what_flows_out_not_by_time() -> None:
    """Half the injector: half the flow, the same excess after the same mass."""
    full = only("tank_stratification", excess=2.0)
    feed = engine_on_stand().feed
    half = with_effects(
        effect("tank_stratification").at(excess=2.0), rtol=1e-7, feed=replace(feed, area=0.5 * feed.area)
    )
    out = 8.35 - channel(full, "tank_mass", 0.3)
    later = float(np.interp(out, 8.35 - half.state("tank_mass"), half.time))
    assert later > 0.4
    assert own_state(half, 0, later) == pytest.approx(own_state(full, 0, 0.3), rel=0.02)


def test_an_empty_rigid_line_takes_its_fill_from_the_tank_and_holds_back_the_chamber() -> None:
    found = only("feed_line_fill", volume=3e-4, steepness=1.0, boiling=0.0, throttled=0.0)
    density = LIQUID_DENSITY
    assert own_state(found, 0, 2.0) == pytest.approx(3e-4 * density, rel=0.01)
    missing = channel(plain(), "tank_mass", 1.0) - channel(found, "tank_mass", 1.0)
    assert 0.3 * 3e-4 * density < missing < 3e-4 * density
    assert channel(found, "run_pressure", 0.02) < 0.6 * channel(found, "run_pressure", 1.0)
    assert channel(found, "chamber_pressure", 0.02) < 0.7 * channel(plain(), "chamber_pressure", 0.02)


def test_behind_a_valve_that_throttles_the_injector_goes_without_what_fills_the_line() -> None:
    """The tank gives hardly more than into a full line: the chamber comes up later, which draws a little. Where the
    valve is open at once it gives the fill besides."""
    throttled, open_ = (
        only("feed_line_fill", volume=1e-4, steepness=1.0, boiling=0.0, throttled=share) for share in (1.0, 0.0)
    )
    held = 1e-4 * LIQUID_DENSITY
    for found in (throttled, open_):
        assert own_state(found, 0, 1.0) == pytest.approx(held, rel=0.01)
    at_once, besides = (
        channel(plain(), "tank_mass", 1.0) - channel(found, "tank_mass", 1.0) for found in (throttled, open_)
    )
    assert 0.0 < at_once < 0.2 * held
    assert besides > 0.5 * held
    assert channel(throttled, "run_pressure", 0.04) < channel(open_, "run_pressure", 0.04) - 1e5


@pytest.mark.parametrize("boiling", [0.0, 0.5, 1.0])
def test_a_larger_line_takes_longer_to_fill_within_a_second(boiling: float) -> None:
    filled = [filling_time(volume, boiling) for volume in (1e-4, 3e-4, 6e-4)]
    assert filled == sorted(filled)
    assert 0.03 < filled[0] < filled[2] < 0.9


def filling_time(volume: float, boiling: float) -> float:
    """When the run line first reaches 98 % of its highest pressure [s]."""
    found = only("feed_line_fill", volume=volume, steepness=1.0, boiling=boiling, throttled=0.0)
    pressure = found.output("run_pressure")
    return float(found.time[np.argmax(pressure > 0.98 * pressure.max())])


def leap_at_the_end_of_the_liquid(run: Burn, name: str) -> float:
    """By how much an output changes [SI] within 20 ms about the end of the liquid."""
    assert run.liquid_out is not None
    return abs(channel(run, name, run.liquid_out + 0.01) - channel(run, name, run.liquid_out - 0.01))


@pytest.mark.parametrize("beside", [{}, {"injector_choked_vapor": 0.8}, {"injector_two_phase": 0.3}])
def test_the_pressure_of_a_boiling_line_does_not_leap_as_the_liquid_ends(beside: dict[str, float]) -> None:
    """Whatever the injector's law: the line holds what it holds."""
    others = [effect(name).at(weight=weight) for name, weight in beside.items()]
    boiling, rigid = (
        with_effects(*others, effect("feed_line_fill").at(volume=4e-4, boiling=share)) for share in (1.0, 0.0)
    )
    assert leap_at_the_end_of_the_liquid(rigid, "run_pressure") > 1.5e5
    assert leap_at_the_end_of_the_liquid(boiling, "run_pressure") < 0.5e5
    assert boiling.liquid_out is not None
    for at in (2.0, boiling.liquid_out + 0.5):
        assert channel(boiling, "run_pressure", at) == pytest.approx(own_state(boiling, 2, at), rel=1e-3)


def test_a_boiling_line_holds_what_its_pressure_says_and_feeds_the_injector() -> None:
    found = only("feed_line_fill", volume=4e-4, boiling=1.0)
    assert found.liquid_out is not None
    held, pressure = (np.array([own_state(found, i, at) for at in (0.1, 2.0, found.liquid_out + 0.5)]) for i in (0, 2))
    assert held == pytest.approx(4e-4 * LIQUID_DENSITY * (pressure - engine_on_stand().ambient) / FULL_AT, rel=1e-3)
    at = found.liquid_out + 0.5
    drawn, onward = channel(found, "tank_outflow", at), channel(found, "oxidizer_flow", at)
    assert 0.5 * onward < drawn < 0.95 * onward


def test_a_boiling_line_of_no_volume_is_none() -> None:
    tiny = only("feed_line_fill", volume=1e-9, boiling=1.0)
    for name in ("run_pressure", "tank_pressure", "chamber_pressure"):
        assert channel(tiny, name, 3.0) == pytest.approx(channel(plain(), name, 3.0), rel=1e-4)
