"""Holes of a log: told with their place, no event in one is surer than it is long."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import definition, fire, log_of

from hfanalysis.record.holes import hole_warnings, holes, leap_warnings, leaps, not_excluded
from hfanalysis.record.log import Channel, Flag, TestLog
from hfanalysis.segment.phases import find_phases

OPENED = 100.0


def cut(log: TestLog, start: float, end: float, *names: str) -> TestLog:
    """The log without its rows [log time], or with drop-outs of some channels in their place."""

    def without(channel: Channel) -> Channel:
        inside = (channel.time > start) & (channel.time < end)
        if names:
            lost = replace(channel, values=np.where(inside, np.nan, channel.values))
            return lost if channel.name in names else channel
        kept = ~inside
        return replace(channel, time=channel.time[kept], values=channel.values[kept], flags=channel.flags[kept])

    return replace(log, channels={n: without(c) for n, c in log.channels.items()})


def test_a_log_without_holes_has_none_whatever_its_rate() -> None:
    assert holes(np.arange(0.0, 10.0, 1e-3)).size == 0
    assert holes(np.arange(0.0, 100.0, 2.0)).size == 0
    assert holes(np.array([1.0])).size == 0


def test_what_the_engineer_left_out_is_no_hole_to_tell() -> None:
    channel = log_of(fire()).channels["p_tank"]
    inside = (channel.time > 101.0) & (channel.time < 102.0)
    assert not_excluded(replace(channel, flags=np.where(inside, Flag.EXCLUDED, 0).astype(np.uint8))).size == 0
    assert not_excluded(replace(channel, flags=np.where(inside, Flag.DROPOUT, 0).astype(np.uint8))).shape == (1, 2)


def test_one_hole_in_all_channels_is_told_once_and_of_many_the_longest() -> None:
    hole = np.array([[2.0, 2.6]])
    both = [("log.csv", "p_tank", hole), ("log.csv", "thrust", hole), ("slow.csv", "T_tank", hole)]
    assert list(hole_warnings(both, {"log.csv": 2, "slow.csv": 1})) == [
        "log.csv: no good samples from 2.00 to 2.60 s of log time; what happens there is not known",
        "T_tank: no good samples from 2.00 to 2.60 s of log time; what happens there is not known",
    ]
    many = np.array([[float(i), i + 0.1 * (i + 1)] for i in range(5)])
    assert list(hole_warnings([("log.csv", "p_run", many)], {"log.csv": 2})) == [
        "p_run: no good samples from 2.00 to 2.30 s, 3.00 to 3.40 s, 4.00 to 4.50 s of log time and in 2 shorter "
        "stretches; what happens there is not known"
    ]


def test_an_opening_in_a_hole_is_as_unsure_as_the_hole_is_long() -> None:
    found = find_phases(cut(log_of(fire(), OPENED, white=5e3), OPENED - 0.4, OPENED + 0.3), definition())
    assert found.t_open.std == pytest.approx(0.7 / np.sqrt(12.0), rel=0.05)
    assert abs(found.t_open.value - OPENED) < 2.0 * found.t_open.std
    assert any("t_open lies in a hole of" in text for text in found.warnings)


def test_an_event_beside_a_hole_of_its_channel_is_unsure_and_one_far_from_it_is_not() -> None:
    whole = log_of(fire(), OPENED, white=5e3)
    t_v = find_phases(whole, definition()).events["t_v"]
    near = find_phases(cut(whole, OPENED + t_v.value - 0.3, OPENED + t_v.value - 0.05, "p_tank"), definition())
    far = find_phases(cut(whole, OPENED + 0.5 * t_v.value, OPENED + 0.5 * t_v.value + 0.25, "p_tank"), definition())
    assert near.events["t_v"].std == pytest.approx(0.25 / np.sqrt(12.0), rel=0.05)
    assert far.events["t_v"].std < 0.01
    assert far.events["t_v"].value == pytest.approx(t_v.value, abs=0.01)


def test_a_liquid_that_ends_in_a_hole_of_the_tanks_pressure_ends_somewhere_in_it() -> None:
    test = fire(rate=100.0)
    log = log_of(test, white=5e3)
    tank = log["p_tank"]
    unseen = np.abs(tank.time - 100.0 - test.t_v + 0.2) < 0.5
    flags = np.where(unseen, np.uint8(Flag.UNUSABLE), tank.flags)
    found = find_phases(TestLog({**log.channels, "p_tank": replace(tank, flags=flags)}), definition())
    assert abs(found.time("t_v") - test.t_v) < 1.96 * found.std("t_v")
    assert found.std("t_v") == pytest.approx(1.0 / np.sqrt(12.0), rel=0.1)
    assert any("t_v lies in a hole of p_tank" in text for text in found.warnings)


def test_a_leap_of_an_even_clock_is_told_with_its_place_and_its_size() -> None:
    time = np.arange(0.0, 10.0, 0.02)
    late = np.where(time > 3.45, time + 0.06, time)
    (said,) = leap_warnings("log.csv", late)
    assert "longer by 0.06 s at 3.44 s" in said
    assert "the clock jumped" in said


@pytest.mark.parametrize("jitter", [0.0, 0.003])
def test_a_clock_without_a_leap_or_that_is_never_even_is_told_nothing_of(jitter: float) -> None:
    time = np.arange(0.0, 10.0, 0.02)
    uneven = np.sort(time + jitter * np.random.default_rng(2).standard_normal(time.size))
    assert leaps(uneven).size == 0
    often = np.delete(time, np.arange(10, 400, 20))
    assert leaps(often).size == 0
