"""No single channel fools the phases: look-alikes of logs in which one did."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Stand, Trial, channel, definition, fire, log_of, signal

from hfanalysis.arrays import Array
from hfanalysis.record.log import TestLog
from hfanalysis.segment.end_of_burn import _last_of_burn, find_low_pressure, pulses_after
from hfanalysis.segment.kind import Known, recognize
from hfanalysis.segment.opening import find_opening
from hfanalysis.segment.phases import find_phases

TIME = np.arange(-4.0, 14.0, 0.01)


def noisy(value: Array, white: float = 1e4, seed: int = 0) -> Array:
    return value + white * np.random.default_rng(seed).standard_normal(value.size)


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=100.0)


def with_values(test: Trial, **values: Array) -> Trial:
    return replace(test, values={**test.values, **values})


def test_a_dead_chamber_gauge_makes_no_cold_flow(burn: Trial) -> None:
    dead = with_values(burn, p_chamber=np.full(burn.time.size, AMBIENT))
    found = find_phases(log_of(dead, 100.0, 5e3, 1e4), definition())
    assert (found.kind, found.misfire) == ("hot_fire", False)
    assert "thrust over flow" in found.kind_reason


@pytest.mark.parametrize("stated", ["hot_fire", "cold_flow"])
def test_where_chamber_and_thrust_disagree_the_statement_decides_and_it_is_said(stated: str) -> None:
    on = (TIME > 0.0) * 1.0
    signals = {
        "p_chamber": signal("p_chamber", TIME, noisy(AMBIENT + 0.8e5 * on, 1e3)),
        "thrust": signal("thrust", TIME, noisy(2400.0 * on, 5.0)),
        "p_run": signal("p_run", TIME, noisy(AMBIENT + 35e5 * on)),
    }
    found = recognize(signals, stated, (0.3, 8.0), Known(AMBIENT, 1.2, 1.7e-3))
    assert found.name == stated
    assert "disagree whether it burns" in found.warning


def test_a_line_far_below_any_tank_of_nitrous_oxide_lets_water_flow() -> None:
    flowing = (TIME > 0.0) & (TIME < 9.0)
    log = TestLog({"p_run": channel("p_run", TIME + 50.0, noisy(AMBIENT + 2.4e5 * flowing, 4e3))})
    found = find_phases(log, definition(kind="cold_flow"))
    assert found.kind == "water_flow"
    assert found.t_open.value == pytest.approx(50.0, abs=0.05)
    assert find_phases(log, definition(kind="water_flow")).kind_reason == "as stated"


def test_interference_is_no_opening() -> None:
    value = noisy(AMBIENT + 0.1e5 * (TIME > 3.0), 1e3)
    assert find_opening({"p_chamber": signal("p_chamber", TIME, value)}) is None


def test_a_slow_valve_channel_leaves_the_date_to_the_pressures() -> None:
    slow = np.arange(-4.0, 14.0, 0.5) + 0.2
    rise = AMBIENT + 40e5 * (1.0 - np.exp(-np.maximum(TIME, 0.0) / 0.1))
    signals = {
        "valve": signal("valve", slow, 1.0 * (slow > 0.0)),
        "p_run": signal("p_run", TIME, noisy(rise)),
    }
    found = find_opening(signals)
    assert found is not None
    assert found.channels == ("p_run",)
    assert found.time == pytest.approx(0.0, abs=0.02)


def test_a_line_that_rises_long_before_all_else_puts_its_lead_into_the_deviation(burn: Trial) -> None:
    width = 75
    smoothed = np.convolve(np.pad(burn.values["p_run"], width, mode="edge"), np.ones(2 * width + 1), mode="valid")
    lagging = with_values(burn, p_run=smoothed / (2 * width + 1))
    found = find_phases(log_of(lagging, 100.0, 5e3, 1e4), definition())
    assert found.time("t_v") == pytest.approx(burn.t_v, abs=2.0 * found.std("t_v"))
    assert found.std("t_v") > 0.1


def slow_valve() -> Trial:
    """A valve that takes half a second, a tank that boils late, a knee at 8.6 s."""
    nodes = [-4.0, 0.0, 0.5, 0.9, 2.0, 8.6, 9.5, 10.0, 14.0]
    tank = np.interp(TIME, nodes, [51e5, 51e5, 44e5, 39e5, 41.5e5, 31e5, 24e5, 20.5e5, 20.2e5])
    run = np.interp(TIME, [0.0, 0.5, 2.0, 8.6, 9.6, 10.2], [AMBIENT, 35e5, 37e5, 25e5, 17e5, AMBIENT])
    chamber = np.interp(TIME, [0.05, 0.5, 8.6, 10.2], [AMBIENT, 24e5, 15e5, AMBIENT])
    values = {"p_tank": noisy(tank, 4e3), "p_run": noisy(run, 5e3, 1), "p_chamber": noisy(chamber, 5e3, 2)}
    return Trial(Stand(), TIME, values, 8.6, np.inf, 31e5, np.zeros(0), np.zeros(0))


def test_the_openings_own_drop_and_the_end_of_late_boiling_are_no_end_of_the_liquid() -> None:
    test = slow_valve()
    unknown = definition(tank=None, injector=None, nozzle=None)
    found = find_phases(log_of(test, 100.0), unknown)
    assert found.time("t_v") == pytest.approx(8.6, abs=max(2.0 * found.std("t_v"), 0.1))


def test_a_purge_after_the_burn_is_not_counted() -> None:
    time = np.arange(-3.0, 20.0, 0.01)
    pressure = AMBIENT + np.interp(time, [0.0, 0.2, 10.0, 11.0, 11.5], [0.0, 6e5, 6e5, 0.8e5, 0.0])
    pressure += 1.6e5 * ((time > 14.0) & (time < 16.0))
    chamber = signal("p_chamber", time, noisy(pressure, 2e3))
    found = find_low_pressure(chamber, AMBIENT, 0.3)
    assert not isinstance(found, str)
    assert found[0] == pytest.approx(11.0, abs=0.05)
    ((start, end),) = pulses_after(chamber, 1.8 * AMBIENT, found[0])
    assert (start, end) == pytest.approx((14.0, 16.0), abs=0.1)


def test_a_knee_that_what_is_stated_contradicts_is_told_with_what_may_be_off(burn: Trial) -> None:
    log, stated = log_of(burn, 100.0, 5e3, 1e4), definition()
    assert stated.tank is not None
    assert stated.tank.oxidizer_mass is not None
    assert stated.injector is not None
    for factor_of_load, factor_of_holes, off in ((0.3, 1.0, "oxidizer_mass or volume are off"), (1.0, 0.01, "holes")):
        load = replace(stated.tank.oxidizer_mass, value=factor_of_load * stated.tank.oxidizer_mass.value)
        area = replace(stated.injector.hole_area, value=factor_of_holes * stated.injector.hole_area.value)
        tank, injector = replace(stated.tank, oxidizer_mass=load), replace(stated.injector, hole_area=area)
        found = find_phases(log, replace(stated, tank=tank, injector=injector))
        assert found.t_v.value is None
        assert "has a knee at" in str(found.t_v.reason)
        assert off in str(found.t_v.reason)


def test_a_burn_of_which_one_sample_stands_out_ends_at_it() -> None:
    """As where a damaged log leaves one sample between two holes."""
    assert _last_of_burn(np.arange(5.0), np.array([-1.0, -1.0, 2.0, -1.0, -1.0])) == 2
