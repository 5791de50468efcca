"""The verdict over a burn."""

from __future__ import annotations

import numpy as np
import pytest
from tests.inference.oscillations.made import MEAN, clock, noise, wave

from hfanalysis.arrays import Array
from hfanalysis.performance.stability.causes import FEED
from hfanalysis.performance.stability.stability import ROUGH, SMOOTH_BURN, UNSEEN, UNSTABLE, stability
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.products.stability import Stability
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel, TestLog


def burn(time: Array, **fluctuations: Array) -> TestLog:
    """A burn from 0 to 6 s whose liquid is gone at 4.5 s; tank, run line and chamber at 2.5, 2 and 1 times MEAN."""
    lit = (time > 0.0) & (time < 6.0)
    level = {"p_tank": 2.5, "p_run": 2.0, "p_chamber": 1.0}
    values = {n: level[n] * MEAN * lit + noise(time, 2e-3, seed=i) for i, n in enumerate(level)}
    made = {n: v + np.where(lit, fluctuations.get(n, 0.0), 0.0) for n, v in values.items()}
    flags = np.zeros(time.size, dtype=np.uint8)
    return TestLog({n: Channel(n, "Pa", time, v, flags, 1e4, True, n) for n, v in made.items()})


def judged(log: TestLog) -> Stability:
    times = {"t_feed": 0.2, "t_v": 4.5, "t_end": 6.0}
    events = {n: Quantity(times[n], "s", 0.01) if n in times else Quantity.absent("none") for n in EVENTS}
    segments = Segments.of(Quantity(0.0, "s", 0.01), events, kind="hot_fire", misfire=False)
    return stability(log, segments, 6.0, lambda _start, _end: ())


TIME = clock(250.0, 7.0)


def test_a_smooth_burn_says_up_to_where() -> None:
    found = judged(burn(TIME))
    assert found.verdict == SMOOTH_BURN
    assert "125 Hz" in found.why
    assert not found.lines
    assert found.roughness_rms is not None
    assert found.roughness_rms.value == pytest.approx(0.0, abs=1e-3)  # the sensor's noise is not the burn's


def test_broadband_scatter_is_rough() -> None:
    found = judged(burn(TIME, p_chamber=noise(TIME, 0.04, seed=9)))
    assert found.verdict == ROUGH
    assert found.roughness_rms is not None
    assert found.roughness_rms.value == pytest.approx(0.04, rel=0.05)


def test_a_line_that_holds_beyond_five_per_cent_is_unstable_and_one_below_is_not() -> None:
    strong = judged(burn(TIME, p_chamber=wave(TIME, 0.05, 23.0)))
    assert strong.verdict == UNSTABLE
    weak = judged(burn(TIME, p_chamber=wave(TIME, 0.005, 23.0)))
    assert weak.verdict == SMOOTH_BURN
    assert {line.phase for line in weak.lines} == {"liquid", "vapor"}
    assert weak.lines[0].amplitude.value == pytest.approx(0.005, rel=0.1)


def test_the_run_line_tells_the_feed() -> None:
    swings = wave(TIME, 0.02, 15.0)
    driven = judged(burn(TIME, p_chamber=swings, p_run=-swings))
    assert driven.lines[0].phase == "liquid"
    assert driven.lines[0].cause == FEED
    assert driven.lines[0].channels == ("p_chamber", "p_run")
    followed = judged(burn(TIME, p_chamber=swings, p_run=swings / 3.0))
    assert all(line.cause != FEED for line in followed.lines)


def test_what_a_slow_logger_cannot_show_is_not_called_smooth() -> None:
    slow = clock(16.0, 7.0)
    assert judged(burn(slow)).verdict == UNSEEN
    bare = burn(TIME)
    del bare.channels["p_chamber"]
    assert judged(bare).verdict == UNSEEN
