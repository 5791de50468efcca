"""Does the flow swing?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.inference.logged import seen

from hfanalysis.inference.oscillations.fluctuation import fluctuation
from hfanalysis.inference.oscillations.lines import lines
from hfanalysis.inference.unknowns.swing import LEAD_IN, SLOWEST, Swing
from hfanalysis.record.signals import Signal

STEP, END = 1e-3, 5.0
LEVEL = {"p_tank": 50e5, "p_run": 40e5, "p_chamber": 20e5}
LOSS = LEVEL["p_tank"] - LEVEL["p_run"]
NOISE = 5e3


def logged(swing: Swing | None = None, chamber: float = 1.0, line: float = 1.0, seed: int = 3) -> dict[str, Signal]:
    """Pressures that sink slowly, with a flow that swings; ``chamber`` and ``line``: how they answer."""
    rng, time = np.random.default_rng(seed), np.arange(-1.0, END + 1.0, STEP)
    flow = np.zeros(time.size)
    if swing is not None:
        inside = (time > swing.start) & (time < swing.end)
        flow = np.where(inside, swing.share * np.sin(2.0 * np.pi * swing.frequency * time + swing.phase), 0.0)
    # the run line's pressure gives way: a third of the pressure from tank to chamber is lost in the feed
    answer = {
        "p_tank": 0.0,
        "p_run": -2.0 * LOSS * (1.0 - 1.0 / 3.0) * line,
        "p_chamber": 0.6 * LEVEL["p_chamber"] * chamber,
    }
    out = {}
    for name, level in LEVEL.items():
        values = level * (1.0 - 0.05 * time) + answer[name] * flow + NOISE * rng.standard_normal(time.size)
        out[name] = Signal(name, time, values, NOISE, STEP)
    return out


@given(st.floats(2.5, 20.0), st.floats(0.5, 2.0), st.floats(0.0, 6.2), st.floats(0.006, 0.03))
def test_a_swing_is_seen_with_its_frequency_size_phase_and_time(
    frequency: float, start: float, phase: float, share: float
) -> None:
    hidden = Swing(share, frequency, phase, start, start + 2.0, 0.0)
    found = seen(Swing, logged(hidden), END)
    assert found is not None
    assert found.frequency == pytest.approx(frequency, abs=0.2)
    assert found.share == pytest.approx(share, rel=0.25)
    assert (found.start, found.end) == (pytest.approx(start, abs=0.25), pytest.approx(start + 2.0, abs=0.25))
    middle = start + 1.0
    apart = 2.0 * np.pi * (found.frequency - frequency) * middle + found.phase - phase
    assert np.cos(apart) > 0.9
    assert found.log_evidence > 12.0


def test_its_frequency_is_that_of_the_line_that_the_chamber_shows() -> None:
    signals = logged(Swing(0.015, 7.3, 1.0, 0.0, END, 0.0))
    found = seen(Swing, signals, END)
    whole = fluctuation(signals["p_chamber"], LEAD_IN, END)
    assert found is not None
    assert whole is not None
    assert found.frequency == lines(whole)[0].frequency


@pytest.mark.parametrize("seed", range(20))
def test_noise_does_not_swing(seed: int) -> None:
    found = seen(Swing, logged(seed=seed), END)
    assert found is None or found.log_evidence < 6.0


def test_a_combustion_that_swings_is_not_the_feed() -> None:
    """Its pressure holds the flow back, and the run line's follows it: both go up together, or the line shows none."""
    hidden = Swing(0.03, 8.0, 1.0, 1.0, 4.0, 0.0)
    assert seen(Swing, logged(hidden, line=0.0), END) is None
    assert seen(Swing, logged(hidden, line=-0.2), END) is None
    assert seen(Swing, logged(hidden, chamber=0.0), END) is None


def test_what_the_run_line_does_for_a_moment_at_the_combustions_frequency_is_no_swing_of_the_flow() -> None:
    """A chamber that swings all the time, and a line that does so once, by chance against it."""
    read = logged()
    time = read["p_run"].time
    turning = np.sin(2.0 * np.pi * 23.0 * time)
    chance = np.where((time > 2.0) & (time < 3.0), -0.6 * NOISE * turning, 0.0)
    swung = {"p_chamber": 0.01 * LEVEL["p_chamber"] * turning, "p_run": chance}
    both = {n: Signal(n, s.time, s.value + swung.get(n, 0.0), s.noise, s.step) for n, s in read.items()}
    assert seen(Swing, both, END) is None
    once = {**both, "p_chamber": replace(both["p_chamber"], value=read["p_chamber"].value - 100.0 * chance)}
    assert seen(Swing, once, END) is not None  # a chamber that swings with it is another matter


def test_what_is_slower_than_that_is_left_to_the_means() -> None:
    found = seen(Swing, logged(Swing(0.03, 0.3 * SLOWEST, 1.0, 0.5, 4.5, 0.0)), END)
    assert found is None


def test_a_short_or_slow_log_does_not_tell() -> None:
    hidden = Swing(0.03, 8.0, 1.0, 0.5, 4.0, 0.0)
    assert seen(Swing, logged(hidden), 1.0) is None
    slow = {n: Signal(n, s.time[::20], s.value[::20], s.noise, 20 * STEP) for n, s in logged(hidden).items()}
    assert seen(Swing, slow, END) is None
    assert seen(Swing, {}, END) is None
