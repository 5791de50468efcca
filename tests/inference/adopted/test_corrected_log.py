"""What adopted sensor effects did to a log is taken off it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import distorted
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.record.log import Channel, TestLog

ORIGIN = 50.0
TIME = np.arange(-2.0, 8.0, 0.005)
TRUE = {
    "p_chamber": 15e5 - 1e5 * TIME + 2e5 * np.sin(TIME),
    "thrust": 1000.0 + 50.0 * TIME,
    "p_tank": 50e5 - 2e5 * TIME,
}


def log_with(*effects: Active, **change: Any) -> TestLog:
    read = distorted(TRUE, TIME, effects)
    channels = {}
    for name, values in read.items():
        flags = np.zeros(TIME.size, dtype=np.uint8)
        channels[name] = Channel(name, "", TIME + ORIGIN, values.copy(), flags, 1.0, True, name, **change)
    return TestLog(channels)


@pytest.mark.parametrize(
    ("active", "channel", "left"),
    [
        (effect("load_cell_drift").at(drift=120.0, time=4.0), "thrust", 1e-9),
        (effect("pressure_transducer_offset").at(p_tank=1e5), "p_tank", 1e-6),
        (effect("chamber_tap_lag").at(lag=0.05), "p_chamber", 0.04),  # to second order
    ],
)
def test_a_distortion_is_taken_off(active: Active, channel: str, left: float) -> None:
    log = log_with(active)
    late = TIME > 0.0
    before = np.abs(log[channel].values - TRUE[channel])[late].max()
    after = np.abs(corrected(log, ORIGIN, [active])[channel].values - TRUE[channel])[late].max()
    assert before > 0.0
    assert after < left * before


def test_raw_values_are_corrected_with_them_and_the_channel_says_so() -> None:
    active = effect("load_cell_drift").at(drift=120.0, time=4.0)
    raw = distorted(TRUE, TIME, [active])["thrust"] + 7.0
    found = corrected(log_with(active, raw=raw), ORIGIN, [active])["thrust"]
    assert found.raw == pytest.approx(TRUE["thrust"] + 7.0)
    assert found.history[-1] == "corrected for load_cell_drift"


def test_samples_without_a_number_stay_without_one_and_spoil_no_other() -> None:
    active = effect("chamber_tap_lag").at(lag=0.05)
    log = log_with(active)
    log["p_chamber"].values[500] = np.nan
    found = corrected(log, ORIGIN, [active])["p_chamber"].values
    assert np.flatnonzero(np.isnan(found)).tolist() == [500]


@pytest.mark.parametrize(
    "active", [effect("load_cell_drift").at(), effect("tank_heat").at(power=900.0)], ids=["idle", "physics"]
)
def test_nothing_to_take_off_leaves_the_log_itself(active: Active) -> None:
    log = log_with()
    assert corrected(log, ORIGIN, [active]) is log
