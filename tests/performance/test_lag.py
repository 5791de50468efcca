"""The lag of the chamber's pressure behind the thrust."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.performance.lag import pressure_lag
from hfanalysis.performance.measured import Fire
from hfanalysis.performance.thrust import Thrust
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.signals import Signal

SEGMENTS = cast("Any", SimpleNamespace(t_open=Quantity(0.0, "s")))


def course(time: Array) -> Array:
    up, down = np.clip(time - 0.2, 0.0, None), np.clip(time - 5.0, 0.0, None)
    return np.asarray((1.0 - np.exp(-up / 0.05)) * np.exp(-down / 0.1))


def found(rate: float, lag: float, seed: int = 0) -> Quantity:
    rng = np.random.default_rng(seed)
    time = np.arange(-2.0, 8.0, 1.0 / rate)
    flags = np.zeros(time.size, dtype=np.uint8)
    read = 2e6 * course(time - lag) + 1e5 + 4e3 * rng.standard_normal(time.size)
    force = 1e3 * course(time) + 3.0 * rng.standard_normal(time.size)
    log = TestLog({
        "p_chamber": Channel("p_chamber", "Pa", time, read, flags, 1e4, True, "p"),
        "thrust": Channel("thrust", "N", time, force, flags, 5.0, True, "f"),
    })  # fmt: skip
    return pressure_lag(log, SEGMENTS, Thrust(Signal.of(log["thrust"]), 0.0, np.nan), Fire(5.5, 0.02, ""))


@pytest.mark.parametrize("lag", [-0.03, 0.0, 0.02, 0.08])
@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0])
def test_a_lag_lies_in_its_interval(rate: float, lag: float) -> None:
    told = found(rate, lag)
    assert told.interval is not None
    assert told.interval[0] <= lag <= told.interval[1]
    assert told.interval[1] - told.interval[0] < 0.15


def test_what_shares_nothing_and_what_is_too_slow_say_so() -> None:
    assert found(200.0, 2.0).value is None
    assert found(5.0, 0.0).value is None
