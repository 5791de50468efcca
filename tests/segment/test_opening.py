"""t_open: the main valve opens, seen by its own channel or by what the pressures do first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated.stand import noise
from tests.segment.stand import AMBIENT, definition, fire, log_of, signal

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.segment.opening import find_opening
from hfanalysis.segment.phases import find_phases

RATE = 500.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)
OPENING = 8.0


def steady(name: str, level: float, white: float = 5e3, seed: int = 0) -> Signal:
    return signal(name, TIME, level + noise(np.random.default_rng(seed), TIME.size, RATE, white, 1e4))


def with_change(quiet: Signal, change: Array) -> Signal:
    return signal(quiet.name, TIME, quiet.value + change)


def since(instant: float) -> Array:
    return np.maximum(TIME - instant, 0.0)


def filling(instant: float = OPENING, fill: float = 0.15) -> Signal:
    return with_change(steady("p_run", AMBIENT), 40e5 * (1.0 - np.exp(-since(instant) / fill)))


def falling(instant: float = OPENING) -> Signal:
    return with_change(steady("p_tank", 50e5), -6e5 * (1.0 - np.exp(-since(instant) / 0.2)) - 2e5 * since(instant))


def test_a_valve_channel_dates_the_opening_between_its_samples() -> None:
    valve = signal("valve", TIME, (TIME >= OPENING).astype(float))
    found = find_opening({"valve": valve, "p_run": filling(OPENING + 0.4)})
    assert found is not None
    assert found.channels == ("valve",)
    assert found.time == pytest.approx(OPENING - 0.5 / RATE)
    assert found.std == pytest.approx(1.0 / RATE / np.sqrt(12.0))


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_a_valve_channel_that_never_moves_leaves_it_to_the_pressures(level: float) -> None:
    found = find_opening({"valve": signal("valve", TIME, np.full(TIME.size, level)), "p_run": filling()})
    assert found is not None
    assert found.channels == ("p_run",)
    assert found.time == pytest.approx(OPENING, abs=0.02)


@pytest.mark.parametrize("fill", [0.02, 0.15, 0.5])
def test_the_run_line_fills_when_the_valve_opens(fill: float) -> None:
    found = find_opening({"p_run": filling(fill=fill), "p_tank": steady("p_tank", 50e5, seed=1)})
    assert found is not None
    assert found.channels == ("p_run",)
    assert found.time == pytest.approx(OPENING, abs=max(0.004, 4.0 * found.std))


def test_the_tank_alone_shows_the_opening_too() -> None:
    found = find_opening({"p_tank": falling()})
    assert found is not None
    assert found.channels == ("p_tank",)
    assert found.time == pytest.approx(OPENING, abs=max(0.004, 4.0 * found.std))


def test_tank_and_line_together_date_it() -> None:
    found = find_opening({"p_run": filling(), "p_tank": falling()})
    assert found is not None
    assert set(found.channels) == {"p_run", "p_tank"}
    assert found.time == pytest.approx(OPENING, abs=max(0.002, 4.0 * found.std))


@pytest.mark.parametrize("name", ["p_run", "p_chamber", "p_tank", "thrust"])
def test_spikes_are_no_opening_valve(name: str) -> None:
    value = steady(name, AMBIENT).value.copy()
    for i in (1000, 4000, 4001, 7000):
        value[i] += 60e5
    assert find_opening({name: signal(name, TIME, value)}) is None


def test_filling_the_tank_and_settling_are_no_opening_valve() -> None:
    tank = with_change(steady("p_tank", 20e5), 1.5e5 * TIME - 0.3e5 * since(15.0))
    run = with_change(steady("p_run", AMBIENT), 0.3e5 * TIME)
    assert find_opening({"p_tank": tank, "p_run": run}) is None


def test_spikes_before_the_opening_do_not_shift_it() -> None:
    run = filling()
    value = run.value.copy()
    value[500], value[2500] = 100e5, -50e5
    found = find_opening({"p_run": signal("p_run", TIME, value)})
    assert found is not None
    assert found.time == pytest.approx(OPENING, abs=0.01)


def test_the_deviation_of_the_opening_is_honest() -> None:
    generator = np.random.default_rng(9)
    z = []
    for _ in range(20):
        instant = OPENING + generator.uniform(-0.5, 0.5)
        pure = AMBIENT + 40e5 * (1.0 - np.exp(-since(instant) / 0.1))
        run = signal("p_run", TIME, pure + noise(generator, TIME.size, RATE, 15e3, 1e5))
        found = find_opening({"p_run": run})
        assert found is not None
        z.append((found.time - instant) / found.std)
    assert abs(np.mean(z)) < 3.0 * np.std(z) / np.sqrt(20)
    assert np.sqrt(np.mean(np.square(z))) < 1.6


def test_a_log_in_which_nothing_happens_is_said_to_hold_no_firing() -> None:
    test = fire(before=4.0, after=0.0)
    quiet = test.time < -0.01
    values = {n: v[quiet] for n, v in test.values.items()}
    channels = log_of(type(test)(test.stand, test.time[quiet], values, 0, 0, 0, test.flow, test.mass), white=5e3)
    found = find_phases(channels, definition())
    assert (found.kind, found.t_open.value, found.firings) == ("nothing", None, ())
    assert "test T: the log holds no firing and no flow: nothing in p_run, p_chamber" in found.warnings[0]
    with pytest.raises(AbsentError, match=r"test T: the log holds no firing and no flow: nothing in p_run, p_chamber"):
        _ = found.fired


def test_a_log_without_a_telling_channel_says_so() -> None:
    log = log_of(fire(), without=("p_run", "p_chamber", "p_tank", "thrust"))
    with pytest.raises(AbsentError, match="no channel has good samples that change"):
        find_phases(TestLog(log.channels), definition())


@pytest.mark.parametrize(("scale", "strange"), [(1.0, False), (1.6, False), (6.895, True), (0.0689, True)])
def test_a_tank_that_no_nitrous_oxide_is_in_is_asked_for_its_unit(scale: float, strange: bool) -> None:
    """Scales of kPa read as psi, and of bar read as psi."""
    log = log_of(fire(), white=5e3)
    tank = log.channels["p_tank"]
    read = dict(log.channels, p_tank=replace(tank, values=scale * tank.values))
    found = find_phases(TestLog(read), definition())
    assert any("is its unit right?" in text for text in found.warnings) == strange
