"""A log with several firings: all are found, one is taken, and no search looks into another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Trial, channel, definition, fire, log_of, signal

from hfanalysis.errors import AbsentError
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import TestLog
from hfanalysis.record.logspec import FileSpec, LogSpec
from hfanalysis.segment.firings import find_flows
from hfanalysis.segment.phases import find_phases

GAP = 4.0


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0, before=GAP)


def after(first: TestLog, second: TestLog) -> TestLog:
    """One log after the other, the first from where its firing is over."""
    start = max(c.time[-1] for c in first.channels.values()) + 5e-3
    begins = min(c.time[0] for c in second.channels.values())
    joined = {}
    for name, one in first.channels.items():
        other = second[name]
        time = np.concatenate((one.time, other.time - begins + start))
        joined[name] = channel(name, time, np.concatenate((one.values, other.values)))
    return TestLog(joined)


def burst(test: Trial, seconds: float = 0.8) -> Trial:
    """Only the first of a firing."""
    kept = test.time < seconds
    return replace(test, time=test.time[kept], values={n: v[kept] for n, v in test.values.items()})


def cold(test: Trial) -> Trial:
    low = AMBIENT + 0.1 * (test.values["p_chamber"] - AMBIENT)
    return replace(test, values={**test.values, "p_chamber": low, "thrust": 0.1 * test.values["thrust"]})


def logged(test: Trial, seed: int) -> TestLog:
    return log_of(test, 100.0, 5e3, 1e4, seed=seed)


def check(found: Segments, burn: Trial, number: int, of: int) -> None:
    assert [one.number for one in found.firings] == list(range(1, of + 1))
    assert [one.number for one in found.firings if one.taken] == [number]
    assert found.kind == "hot_fire"
    assert found.time("t_v") == pytest.approx(burn.t_v, abs=0.03)
    assert found.time("t_purge") == pytest.approx(burn.t_purge, abs=0.05)
    assert any(f"number {number} is taken" in text for text in found.warnings)
    assert all((found.std(name) or 0.0) < 1.0 for name in found.order)


def test_of_a_burst_and_a_firing_the_firing_is_taken(burn: Trial) -> None:
    check(find_phases(after(logged(burst(burn), 1), logged(burn, 2)), definition()), burn, 2, 2)


def test_of_a_cold_flow_and_a_firing_the_firing_is_taken(burn: Trial) -> None:
    log = after(logged(cold(burn), 1), logged(burn, 2))
    check(find_phases(log, definition()), burn, 2, 2)
    asked = find_phases(log, definition(), 1)
    assert asked.kind == "cold_flow"
    assert asked.time("t_v") == pytest.approx(burn.t_v, abs=0.1)


def test_of_two_alike_the_first_is_taken_unless_test_toml_says_otherwise(burn: Trial) -> None:
    log = after(logged(burn, 1), logged(burn, 2))
    first = find_phases(log, definition())
    check(first, burn, 1, 2)
    second = find_phases(log, replace(definition(), log=LogSpec((FileSpec("log.csv"),), 2)))
    check(second, burn, 2, 2)
    taken = second.taken
    assert taken is not None
    assert taken.start == first.firings[0].end
    part = log.between(taken.start, taken.end)
    assert part["p_run"].time[0] >= (taken.start or 0.0)
    assert log.between(None, None) is log


def test_a_firing_that_the_log_does_not_hold_is_said(burn: Trial) -> None:
    with pytest.raises(AbsentError, match=r"firing = 3: the log holds 2 firings"):
        find_phases(after(logged(burn, 1), logged(burn, 2)), definition(), 3)


def test_a_pulse_of_purge_gas_and_a_spike_are_no_firings() -> None:
    time = np.arange(0.0, 40.0, 0.01)
    pressure = AMBIENT + np.interp(time, [5.0, 5.1, 15.0, 15.3], [0.0, 8e5, 8e5, 0.0])
    pressure[(time > 20.0) & (time < 22.0)] += 2e5
    pressure[3000] += 30e5
    flows = find_flows({"p_chamber": signal("p_chamber", time, pressure)})
    assert len(flows) == 1
    assert flows[0].start == pytest.approx(5.0, abs=0.2)
    assert flows[0].end == pytest.approx(15.2, abs=0.3)


def test_a_run_line_that_drops_out_in_mid_burn_ends_no_firing() -> None:
    time = np.arange(0.0, 20.0, 0.01)
    on = (time > 5.0) & (time < 12.0)
    run = np.where(on & ~((time > 7.0) & (time < 8.5)), 40e5, AMBIENT)
    chamber = np.where(on, 35e5, AMBIENT)
    flows = find_flows({"p_run": signal("p_run", time, run), "p_chamber": signal("p_chamber", time, chamber)})
    assert [(round(flow.start), round(flow.end)) for flow in flows] == [(5, 12)]
