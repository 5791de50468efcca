"""What a channel may differ by where the end of the liquid was seen a little early or late."""

from __future__ import annotations

import numpy as np
import pytest
from tests.segment.stand import signal

from hfanalysis.diagnose.observations.blocks import Blocks
from hfanalysis.diagnose.observations.covariance import LEAST_SHIFT, of_the_model
from hfanalysis.diagnose.observations.frame import EVENT_STD, Frame

FALL, KNEE, END = 3e5, 5.0, 8.0
"""Pressure that the tank loses in a second [Pa/s], when its liquid is gone, and when the test ends [s]."""


@pytest.mark.parametrize(("seen", "shift"), [(4e-4, LEAST_SHIFT), (3e-3, 3e-3), (2e-2, 2e-2)])
def test_a_channel_is_as_unsure_as_the_knee_was_seen_and_no_more(seen: float, shift: float) -> None:
    """By how much more than that a model's liquid may end elsewhere is a matter of the instant, which has EVENT_STD."""
    time = np.arange(0.05, END, 0.1)
    value = 50e5 - FALL * time
    rows = np.arange(time.size)
    ones, still = np.ones(time.size, dtype=np.int64), np.zeros(time.size, dtype=bool)
    blocks = Blocks(signal("p_tank", time, value), time, value, rows, ones, value, ~still)
    changes = {"t_v": (KNEE, seen)}
    frame = Frame(time, still, np.zeros(time.size), 0, changes, 0.03, 0.0, {"chamber": END, "tank": END})
    moved = np.abs(of_the_model(blocks, frame)[:, 0])
    before = time < KNEE
    assert moved.max() == pytest.approx(FALL * shift, rel=0.02)
    assert moved[before][0] < 0.1 * moved.max()  # a run is stretched from the opening on
    assert moved[~before] == pytest.approx(FALL * shift)
    assert LEAST_SHIFT < EVENT_STD
