"""Until when a chamber burns: by its pressure over the flow, whatever of the fall is hidden by the liquid's end."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulated.blind import slots as s
from simulated.blind.stand import Histories, Stand
from simulated.worlds import laws
from simulated.worlds.engines import drawn, simulated
from tests.segment.stand import signal

from hfanalysis.inference.observations.flame import (
    BEFORE,
    LIQUID,
    SETTLES,
    SETTLING,
    VAPOR,
    FlameOut,
    OverFlow,
    flame_out,
    shown_to_burn,
)
from hfanalysis.thermo.nitrous import saturation

FADES = (0.01, 0.03, 0.3)
"""Seconds in which a chamber without a flame turns cold."""


def world(mixing: float, tail: float = 1e-3) -> laws.World:
    values = np.zeros(laws.LAWS)
    values[[laws.TAIL, laws.MIXING]] = tail, mixing
    return laws.World(values, "coolprop", (0.0, 0.0))


@cache
def run(end: str, mixing: float, tail: float = 1e-3) -> tuple[Stand, Histories]:
    stand = drawn(np.random.default_rng(6_900_003), "4 kN", end, world(mixing, tail))
    return stand, simulated(stand, world(mixing, tail))


def over_flow(
    stand: Stand, true: Histories, chamber: float = 1.0, end: float | None = None, run: bool = True
) -> OverFlow:
    """Its pressures up to an end, the chamber's times a factor, with a gauge before the injector or without."""
    rng = np.random.default_rng(2)
    read = [
        signal(name, true.time[::4], k * true.trace(which)[::4] + 5e3 * rng.standard_normal(true.time[::4].size))
        for name, which, k in (("p_tank", s.P_TANK, 1.0), ("p_run", s.P_RUN, 1.0), ("p_chamber", s.P_CHAMBER, chamber))
    ]
    made = OverFlow.of(read[0], read[1] if run else None, read[2], saturation(), true.t_v, end or stand.closing)
    assert made is not None
    return made


def found(stand: Stand, true: Histories, chamber: float = 1.0, run: bool = True) -> FlameOut | None:
    """What is found in its pressures."""
    return flame_out(over_flow(stand, true, chamber, run=run))


@pytest.mark.parametrize("gauge", [True, False])
@pytest.mark.parametrize("mixing", FADES)
@pytest.mark.parametrize("end", ["early", "together"])
def test_the_end_of_a_flame_is_found_where_liquid_or_its_end_hides_it(end: str, mixing: float, gauge: bool) -> None:
    stand, true = run(end, mixing)
    flame = found(stand, true, run=gauge)
    assert flame is not None
    assert -0.15 < flame.begins - true.t_fuel_out < 0.05 + 0.1 * mixing
    assert flame.out < true.t_fuel_out + 0.15 + 2.5 * mixing
    assert flame.std == pytest.approx((flame.out - flame.begins) / np.sqrt(12.0))


def test_fuel_that_goes_on_for_a_time_burns_on() -> None:
    stand, true = run("early", 0.01, tail=0.15)
    flame = found(stand, true)
    assert flame is not None
    assert -0.15 < flame.begins - true.t_fuel_out < 0.6


@pytest.mark.parametrize("seed", range(4))
def test_a_chamber_that_burns_to_the_end_has_no_such_end(seed: int) -> None:
    rng = np.random.default_rng(6_900_100 + seed)
    here = laws.draw(rng)
    stand = drawn(rng, ("1 kN", "2 kN", "4 kN", "9 kN")[seed], "left", here)
    assert found(stand, simulated(stand, here)) is None


def test_a_valve_behind_the_gauge_that_closes_is_no_end_of_a_flame() -> None:
    stand, true = run("left", 0.01)
    closing, traces = true.t_v - 0.6, true.traces.copy()
    after = true.time > closing
    traces[after, s.P_TANK] = traces[after, s.P_RUN] = traces[after, s.P_TANK][0]
    traces[after, s.P_CHAMBER] = stand.ambient
    assert found(stand, replace(true, traces=traces)) is None


def test_a_gauge_that_reads_a_tenth_less_changes_nothing() -> None:
    stand, true = run("together", 0.03)
    one, other = found(stand, true), found(stand, true, 0.9)
    assert one is not None
    assert other is not None
    assert other.begins == pytest.approx(one.begins, abs=0.05)


@pytest.mark.parametrize("gauge", [True, False])
@pytest.mark.parametrize("after", [0.3, 0.5])
def test_a_fade_that_the_log_does_not_show_to_its_end_leaves_a_flame_up_to_where_it_begins(
    after: float, gauge: bool
) -> None:
    stand, true = run("together", 0.6)
    seen = over_flow(stand, true, end=max(true.t_v, true.t_fuel_out) + after, run=gauge)
    assert flame_out(seen) is None
    shown = shown_to_burn(seen, stand.ambient, None)
    assert shown is not None
    assert -0.3 < shown - true.t_fuel_out < 0.05


@pytest.mark.parametrize("gauge", [True, False])
@pytest.mark.parametrize("end", ["early", "together"])
def test_what_burns_on_for_long_is_no_flame_that_is_shown(end: str, gauge: bool) -> None:
    stand, true = run(end, 0.01, 0.4)
    seen = over_flow(stand, true, end=true.t_v + 0.8, run=gauge)
    found, shown = flame_out(seen), shown_to_burn(seen, stand.ambient, None)
    begins = shown if found is None else found.begins
    assert begins is not None
    assert -0.3 < begins - true.t_fuel_out < 0.15  # a mixture that gets leaner burns hotter first


@pytest.mark.parametrize("gauge", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_fuel_that_lasts_is_shown_to_burn(seed: int, gauge: bool) -> None:
    rng = np.random.default_rng(6_900_100 + seed)
    here = laws.draw(rng)
    stand = drawn(rng, ("1 kN", "2 kN", "4 kN", "9 kN")[seed], "left", here)
    true = simulated(stand, here)
    for end in (true.t_v, true.t_v + 0.3, stand.closing):
        seen = over_flow(stand, true, end=end, run=gauge)
        assert shown_to_burn(seen, stand.ambient, end) is None


def test_a_tap_that_lags_is_no_fade() -> None:
    stand, true = run("left", 0.01)
    traces, lag = true.traces.copy(), 0.12
    step = float(true.time[1] - true.time[0])
    read = traces[:, s.P_CHAMBER].copy()
    for i in range(1, read.size):
        read[i] = read[i - 1] + (traces[i, s.P_CHAMBER] - read[i - 1]) * step / lag
    traces[:, s.P_CHAMBER] = read
    seen = over_flow(stand, replace(true, traces=traces), end=min(true.t_v + 1.0, stand.closing))
    assert shown_to_burn(seen, stand.ambient, None) is None


@pytest.mark.parametrize("fails", [False, True], ids=["a flame", "a flow"])
def test_a_fall_through_the_end_of_the_liquid_is_a_flames_and_one_that_ends_there_a_flows(fails: bool) -> None:
    """The flame's own fall slows down, and comes to rest at what hot oxidizer alone has; a flow that fails is one of
    vapor after the end of the liquid."""
    began, t_v, rest, times = 3.8, 4.3, 0.65, np.arange(0.32, 7.0, 0.04)
    phase = (times >= t_v) * SETTLING + (times >= t_v + SETTLES) * (VAPOR - SETTLING)
    ratio = rest + (1.0 - rest) * np.exp(-np.maximum(times - began, 0.0) / 0.5)
    if fails:
        ratio = np.where(phase == LIQUID, ratio, 1.0)
    seen = OverFlow(times, 3e6 - 3e5 * times, np.full(times.size, 1e6), ratio, phase)
    shown = shown_to_burn(seen, 1e5, None)
    if fails:
        assert shown is None
    else:  # on a level course the top may be anywhere within BEFORE
        assert shown is not None
        assert began - BEFORE - 0.05 < shown < began + 0.05
