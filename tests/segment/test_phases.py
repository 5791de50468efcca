"""A whole test's phases: found, absent with the reason, or set by the engineer."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Stand, Trial, definition, fire, log_of

from hfanalysis.products.disk import to_json
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Flag, TestLog
from hfanalysis.segment.phases import find_phases
from hfanalysis.units import Value

T_OPEN = 100.0


def found_in(test: Trial, white: float = 5e3, **change: Any) -> Segments:
    """The phases of a test's noisy log; ``without`` channels, other keys go to the definition."""
    without = change.pop("without", ())
    log = log_of(test, T_OPEN, white, 1e4, without=without)
    return find_phases(log, definition(test.stand, **change))


def filled(test: Trial, fill: float = 0.15) -> Trial:
    """The same test with a run line that takes its time to fill."""
    share = 1.0 - np.exp(-np.maximum(test.time, 0.0) / fill)
    run = AMBIENT + (test.values["p_run"] - AMBIENT) * share
    return replace(test, values={**test.values, "p_run": run})


@pytest.fixture(scope="module")
def burn() -> Trial:
    return filled(fire(rate=250.0))


@pytest.fixture(scope="module")
def segments(burn: Trial) -> Segments:
    return found_in(burn)


def test_the_events_of_a_burn_are_where_they_happened(burn: Trial, segments: Segments) -> None:
    assert segments.t_open.value == pytest.approx(T_OPEN, abs=0.005)
    for name, truth in (("t_v", burn.t_v), ("t_purge", burn.t_purge)):
        assert segments.time(name) == pytest.approx(truth, abs=max(4.0 * segments.std(name), 0.003))
        assert 0.0 < segments.std(name) < 0.03
    assert 0.3 < (segments.time("t_feed") or 0.0) < 0.8
    assert segments.kind == "hot_fire"
    assert segments.warnings == ()


def test_events_are_listed_in_their_order(segments: Segments) -> None:
    assert segments.order == ("t_feed", "t_v", "t_purge", "t_end")


def test_a_phase_that_a_test_does_not_have_is_absent_with_the_reason(segments: Segments) -> None:
    assert segments.time("t_fuel_out") is None
    assert "do not fall against the feed" in str(segments.events["t_fuel_out"].reason)
    assert segments.std("t_fuel_out") == 0.0


def test_fuel_that_goes_before_the_liquid_is_seen() -> None:
    segments = found_in(fire(Stand(t_fuel_out=3.4), rate=500.0))
    assert segments.time("t_fuel_out") == pytest.approx(3.4, abs=0.03)
    assert segments.order[0] == "t_fuel_out"


@pytest.mark.parametrize(("t_fuel_out", "order"), [(5.523, ["t_fuel_out", "t_v"]), (5.798, ["t_v", "t_fuel_out"])])
def test_fuel_that_goes_within_tenths_of_a_second_of_the_liquid_is_not_mixed_up_with_it(
    t_fuel_out: float, order: list[str]
) -> None:
    test = fire(Stand(t_fuel_out=t_fuel_out), rate=500.0)
    segments = found_in(test)
    assert segments.time("t_fuel_out") == pytest.approx(t_fuel_out, abs=0.01)
    assert segments.time("t_v") == pytest.approx(test.t_v, abs=0.01)
    assert [name for name in segments.order if name in order] == order


@pytest.mark.parametrize(
    ("channel", "event", "reason"),
    [
        ("p_tank", "t_v", "no p_tank"),
        ("p_run", "t_feed", "no p_run"),
        ("p_chamber", "t_end", "no p_chamber"),
        ("p_chamber", "t_fuel_out", "no p_chamber"),
        ("p_run", "t_fuel_out", "without p_run"),
    ],
)
def test_a_missing_channel_takes_only_its_own_event(burn: Trial, channel: str, event: str, reason: str) -> None:
    segments = found_in(burn, without=(channel,))
    assert segments.time(event) is None
    assert reason in str(segments.events[event].reason)
    if channel != "p_tank":
        assert segments.time("t_v") == pytest.approx(burn.t_v, abs=0.05)


def test_the_engineers_instant_wins_and_what_was_found_is_shown(burn: Trial) -> None:
    segments = found_in(burn, segments={"t_v": Value(5.0, 0.02)})
    assert segments.events["t_v"].value == 5.0
    assert segments.std("t_v") == 0.02
    assert segments.events["t_v"].why == "set by the engineer"
    assert segments.engineer == ("t_v",)
    assert segments.found_where_engineer_set["t_v"] == pytest.approx(burn.t_v, abs=0.02)
    (note,) = (n for n in segments.notes if n.startswith("t_v is"))
    assert note.startswith("t_v is set by the engineer at 5.000 s; the search finds 5.7")
    assert any("t_v is set by the engineer at 5.000 s, but the log shows it at 5.7" in w for w in segments.warnings)


def test_an_instant_that_the_log_agrees_with_is_no_warning(burn: Trial) -> None:
    segments = found_in(burn, segments={"t_v": Value(burn.t_v), "t_open": Value(T_OPEN)})
    assert not [words for words in segments.warnings if "set by the engineer" in words]


def test_the_engineers_opening_moves_the_origin(burn: Trial) -> None:
    segments = found_in(burn, segments={"t_open": Value(T_OPEN - 0.2)})
    assert segments.t_open.value == T_OPEN - 0.2
    assert any(words.startswith("t_open is set by the engineer") for words in segments.warnings)
    assert segments.engineer == ("t_open",)
    assert segments.time("t_v") == pytest.approx(burn.t_v + 0.2, abs=0.02)


def test_an_instant_that_only_the_engineer_sees_is_taken_with_the_reason_why_the_search_does_not(burn: Trial) -> None:
    segments = found_in(burn, segments={"t_fuel_out": Value(3.3)})
    assert segments.time("t_fuel_out") == 3.3
    assert any("t_fuel_out is set by the engineer at 3.300 s; the search found none" in n for n in segments.notes)
    assert "t_fuel_out" not in segments.found_where_engineer_set


def test_an_opening_uncertain_by_50_ms_makes_every_event_so(burn: Trial) -> None:
    segments = found_in(burn, segments={"t_open": Value(T_OPEN, 0.05)})
    assert segments.std("t_v") == pytest.approx(0.05, rel=0.05)
    assert segments.std("t_purge") == pytest.approx(0.05, rel=0.05)


def without_fire(test: Trial) -> Trial:
    """Cold nitrous oxide through the same nozzle."""
    cold = AMBIENT + 0.12 * (test.values["p_chamber"] - AMBIENT)
    return replace(test, values={**test.values, "p_chamber": cold, "thrust": 0.12 * test.values["thrust"]})


def test_a_cold_flow_is_recognized_and_has_no_end_of_a_burn(burn: Trial) -> None:
    segments = found_in(without_fire(burn), kind="cold_flow")
    assert segments.kind == "cold_flow"
    assert segments.warnings == ()
    for name in ("t_end", "t_fuel_out"):
        assert "nothing burns" in str(segments.events[name].reason)
    assert segments.time("t_v") == pytest.approx(burn.t_v, abs=0.03)


def test_a_firing_that_does_not_light_is_a_cold_flow_with_a_warning(burn: Trial) -> None:
    segments = found_in(without_fire(burn), kind="hot_fire")
    assert segments.kind == "cold_flow"
    assert segments.misfire
    assert any("nothing burns" in w for w in segments.warnings)


def test_nitrogen_may_come_before_the_liquid_is_gone(burn: Trial) -> None:
    early = 3.0
    since = np.maximum(burn.time - early, 0.0)
    sag = burn.values["p_purge"][0] * (1.0 - 0.25 * (1.0 - np.exp(-since / 1.5)))
    level = 1.3 * burn.values["p_tank"].max() / sag[0]
    segments = found_in(replace(burn, values={**burn.values, "p_purge": level * sag}))
    assert segments.time("t_purge") == pytest.approx(early, abs=0.03)
    assert any("before the liquid is gone: there is no vapor-only phase" in n for n in segments.notes)


def test_flagged_samples_are_not_looked_at(burn: Trial) -> None:
    """A wild stretch of the tank pressure, flagged, moves nothing."""
    clean = log_of(burn, T_OPEN, 5e3, 1e4)
    tank = clean["p_tank"]
    wild = (tank.time > T_OPEN + 2.0) & (tank.time < T_OPEN + 2.4)
    values = np.where(wild, 1e5, tank.values)
    flags = np.where(wild, np.uint8(Flag.SPIKE), tank.flags)
    spoilt = TestLog({**clean.channels, "p_tank": replace(tank, values=values, flags=flags)})
    segments = find_phases(spoilt, definition(burn.stand))
    assert segments.time("t_v") == pytest.approx(burn.t_v, abs=0.005)
    unflagged = TestLog({**clean.channels, "p_tank": replace(tank, values=values)})
    assert find_phases(unflagged, definition(burn.stand)).time("t_v") != segments.time("t_v")


def test_segments_survive_their_product(segments: Segments) -> None:
    again = Segments.from_json(json.loads(to_json(segments)))
    for name in EVENTS:
        one, other = segments.events[name], again.events[name]
        assert (one.value, one.std, one.reason, one.interval) == (other.value, other.std, other.reason, other.interval)
    assert again.to_json() == segments.to_json()


def test_a_misfire_survives_its_product() -> None:
    absent = {n: Quantity.absent("nothing") for n in EVENTS}
    segments = Segments.of(Quantity(1.0, "s", 0.1), absent, kind="cold_flow", kind_reason="no fire", misfire=True)
    assert Segments.from_json(json.loads(to_json(segments))).to_json() == segments.to_json()


def test_a_tank_above_the_critical_pressure_is_supercharged(burn: Trial) -> None:
    """72.4 bar is the most that nitrous oxide alone can stand at."""
    pressed = replace(burn, values={**burn.values, "p_tank": burn.values["p_tank"] + 30e5})
    segments = found_in(pressed)
    assert segments.supercharged
    assert "above the critical pressure" in " ".join(segments.warnings)
    assert Segments.from_json(json.loads(to_json(segments))).supercharged


def test_a_tank_at_its_saturation_pressure_is_not_supercharged(segments: Segments) -> None:
    assert not segments.supercharged


def test_a_thermometer_that_reads_too_cold_for_the_pressure_is_doubted_not_believed(burn: Trial) -> None:
    cold = definition(burn.stand)
    cold = replace(cold, tank=replace(cold.tank, temperature=Value(263.15)))
    segments = find_phases(log_of(burn, T_OPEN, 5e3, 1e4), cold)
    assert not segments.supercharged
    assert "the thermometer does not see the oxidizer" in " ".join(segments.warnings)
