"""Without a purge line, nitrogen shows where the tank's fall begins to die away."""

from __future__ import annotations

import numpy as np
import pytest
from tests.segment.stand import Stand, fire, signal

from hfanalysis.record.signals import Signal
from hfanalysis.segment.purge_by_tank import CLEAR, find_nitrogen_by_tank

T_V = 5.0


def tank(enters: float | None, dies: float = 0.5, rate: float = 0.22, seed: int = 1, noise: float = 1.5e3) -> Signal:
    """A tank that loses ``rate`` of its pressure in a second, until what ``enters`` [s after t_v] lets it die away."""
    time = np.arange(0.0, 14.0, 0.002)
    since = np.maximum(time - T_V, 0.0)
    fall = rate / (1.0 + 0.15 * since)
    if enters is not None:
        fall = fall * np.exp(-np.maximum(since - enters, 0.0) / dies)
    slope = np.where(time < T_V, -0.08, -fall)
    pressure = 55e5 * np.exp(np.cumsum(slope) * 0.002)
    return signal("p_tank", time, pressure + noise * np.random.default_rng(seed).standard_normal(time.size))


@pytest.mark.parametrize("enters", [0.5, 0.8, 1.5])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_instant_is_found_within_its_interval(enters: float, seed: int) -> None:
    found = find_nitrogen_by_tank(tank(enters, seed=seed), T_V)
    assert not isinstance(found, str)
    time, std = found
    assert abs(time - T_V - enters) < 2.5 * std
    assert std < 0.3


@pytest.mark.parametrize("rate", [0.05, 0.22, 0.6])
@pytest.mark.parametrize("seed", range(5))
def test_a_tank_that_empties_by_itself_shows_none(rate: float, seed: int) -> None:
    assert "does not show where nitrogen enters" in str(find_nitrogen_by_tank(tank(None, rate=rate, seed=seed), T_V))


@pytest.mark.parametrize("vapor_time", [0.4, 0.6, 1.2])
def test_nitrogen_that_enters_at_once_makes_a_corner(vapor_time: float) -> None:
    """Of another kind than the jump of the curvature, and as well dated."""
    burn = fire(Stand(vapor_time=vapor_time), rate=200.0)
    noise = 2e3 * np.random.default_rng(1).standard_normal(burn.time.size)
    found = find_nitrogen_by_tank(signal("p_tank", burn.time, burn.values["p_tank"] + noise), burn.t_v)
    assert not isinstance(found, str)
    assert abs(found[0] - burn.t_purge) < 2.0 * found[1]


def test_nothing_is_looked_for_before_the_liquid_is_gone() -> None:
    assert "no p_purge" in str(find_nitrogen_by_tank(tank(0.8), None))
    assert "does not show" in str(find_nitrogen_by_tank(tank(0.8).between(0.0, T_V + 0.4), T_V))
    assert CLEAR > 1.5
