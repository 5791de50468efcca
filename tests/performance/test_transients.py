"""How a burn starts and ends, of burns whose curve is known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.performance import transients as module
from hfanalysis.performance.measured import Fire
from hfanalysis.performance.thrust import Thrust
from hfanalysis.performance.transients import transients
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel, TestLog

PLATEAU, LIQUID, END = 2e6, 4.0, 6.0


def burn(time: Array, delay: float, rise: float, overshoot: float) -> Array:
    since = np.clip(time - delay, 0.0, None)
    shape = (1.0 - np.exp(-since / rise)) * (1.0 + overshoot * np.exp(-since / 0.08))
    return np.asarray(PLATEAU * shape * np.where(time < END, 1.0, np.exp(-(time - END) / 0.05)))


def log_of(time: Array, pressure: Array, noise: float, seed: int) -> TestLog:
    rng = np.random.default_rng(seed)
    read = pressure + 1e5 + 4e3 * rng.standard_normal() + noise * PLATEAU * rng.standard_normal(time.size)
    flags = np.zeros(time.size, dtype=np.uint8)
    values = {
        "p_chamber": ("Pa", read, 1e4),
        "thrust": ("N", 1e-3 * pressure, 5.0),
        "p_run": ("Pa", 2.5 * pressure + 1e5, 1e4),
    }
    return TestLog({n: Channel(n, u, time, v, flags, a, True, n) for n, (u, v, a) in values.items()})


def segments(**times: float) -> Segments:
    found = {"t_v": LIQUID, "t_end": END, **times}
    return cast("Any", SimpleNamespace(
        t_open=Quantity(0.0, "s", 1e-4), time=found.get, std=lambda _: 0.02, t_v=Quantity(LIQUID, "s", 0.02)
    ))  # fmt: skip


@pytest.fixture(autouse=True)
def cell(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cell without a drift."""

    def plain(log: TestLog, *_: object) -> Thrust:
        return Thrust(module.Signal.of(log["thrust"]), 0.0, np.nan)

    monkeypatch.setattr(module, "thrust_of", plain)


def told(log: TestLog, of: Segments) -> dict[str, Quantity]:
    return transients(log, of, cast("Any", None), Fire(END, 0.02, ""))


def test_delay_rise_and_overshoot_lie_in_their_intervals() -> None:
    inside: dict[str, list[bool]] = {"ignition_delay": [], "rise_time": [], "ignition_overshoot": []}
    fine = np.arange(0.0, END, 2e-4)
    for seed in range(60):
        rng = np.random.default_rng(seed)
        delay, rise, over = rng.uniform(0.05, 0.6), rng.choice([0.02, rng.uniform(0.05, 0.2)]), rng.choice([0.0, 0.6])
        time = np.arange(-2.0 - rng.random() * 0.01, 9.0, 1.0 / float(rng.choice([50.0, 200.0, 1000.0])))
        clean = burn(fine, delay, rise, over)
        passes = [fine[np.argmax(clean > part * PLATEAU)] for part in (0.1, 0.9)]
        truth = {
            "ignition_delay": passes[0],
            "rise_time": passes[1] - passes[0],
            "ignition_overshoot": clean.max() / PLATEAU,
        }
        found = told(log_of(time, burn(time, delay, rise, over), float(rng.choice([2e-3, 0.02])), seed), segments())
        for name, true in truth.items():
            low, high = found[name].interval or (0.0, 0.0)
            inside[name].append(bool(low <= true <= high))
    assert all(np.mean(kept) > 0.9 for kept in inside.values()), inside


def test_times_and_impulses_of_a_thrust() -> None:
    time = np.arange(-2.0, 9.0, 2e-3)
    found = told(log_of(time, burn(time, 0.1, 0.02, 0.0), 2e-3, 1), segments(t_purge=5.0))
    rise, fall = (lambda part: -0.02 * np.log(1.0 - part)), (lambda part: -0.05 * np.log(part))
    for name, part in (("action_time", 0.1), ("burn_time_5_percent", 0.05)):
        low, high = found[name].interval or (0.0, 0.0)
        assert low <= END + fall(part) - 0.1 - rise(part) <= high
        assert high - low < 0.05
    assert found["impulse_vapor"].value == pytest.approx(2000.0, rel=1e-3)
    assert found["impulse_nitrogen"].value == pytest.approx(2000.0, rel=1e-2)
    assert found["tail_impulse"].value == pytest.approx(4000.0, rel=1e-2)
    assert found["injector_drop_liquid"].value == pytest.approx(1.5 * PLATEAU / (PLATEAU + 1e5), rel=0.02)


def test_what_a_log_does_not_have_says_so() -> None:
    time = np.arange(-2.0, 5.5, 2e-3)
    short = log_of(time, burn(time, 0.1, 0.02, 0.0), 2e-3, 1)
    assert "the log ends" in str(told(short, segments())["action_time"].reason)
    ended = told(short, segments(t_purge=5.0))
    assert [name for name in ended if name.startswith("impulse_") and ended[name].value is None] == ["impulse_nitrogen"]
    assert "end at 5.5 s" in str(ended["impulse_nitrogen"].reason)
    del short.channels["thrust"]
    assert told(short, segments())["tail_impulse"].value is None
    del short.channels["p_chamber"]
    assert "no p_chamber" in str(told(short, segments())["rise_time"].reason)


def test_a_single_sample_is_named_as_such() -> None:
    time = np.arange(-2.0, 9.0, 2e-3)
    pressure = burn(time, 0.1, 0.02, 0.0)
    pressure[np.searchsorted(time, 0.2)] += PLATEAU
    overshoot = told(log_of(time, pressure, 2e-3, 1), segments())["ignition_overshoot"]
    assert overshoot.value == pytest.approx(1.0, abs=0.02)
    assert "single sample" in str(overshoot.why)
    assert overshoot.interval is not None
    assert overshoot.interval[1] > 1.9
