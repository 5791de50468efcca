"""Which falls of the chamber's response are an end of the fuel, by their size and by how long they take."""

from __future__ import annotations

import numpy as np
import pytest
from tests.segment.stand import Stand, definition, fire, log_of

from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.segment.fade import find_fade
from hfanalysis.segment.fire import GRID, Response
from hfanalysis.segment.fuel_at_once import _falls, _step
from hfanalysis.segment.phases import find_phases
from hfanalysis.units import Value

TIME = np.arange(0.0, 6.0, GRID)


def response(value: np.ndarray, noise: float) -> Response:
    scatter = noise * np.random.default_rng(1).standard_normal(value.size)
    return Response(TIME, value + scatter, noise, GRID)


@pytest.mark.parametrize(("level", "fall", "seen"), [(0.1e5, 0.06e5, False), (0.3e5, 0.2e5, True), (10e5, 6e5, True)])
def test_a_fall_of_a_twentieth_of_a_bar_is_the_wander_of_a_sensor(level: float, fall: float, seen: bool) -> None:
    """However large a part of the response it is, and however clear: it is that of a chamber near ambient."""
    value = np.where(TIME < 3.0, level, level - fall)
    assert bool(_falls(response(value, 1e-3 * fall), np.array([3.0]), None)[0] > 0.0) is seen


@pytest.mark.parametrize("share", [0.1, 0.2])
def test_a_fall_of_a_fifth_is_no_end_of_the_fuel(share: float) -> None:
    assert _falls(response(np.where(TIME < 3.0, 10e5, (1.0 - share) * 10e5), 1e2), np.array([3.0]), None)[0] == 0.0


@pytest.mark.parametrize(("lasts", "seen"), [(0.25, True), (0.4, True), (0.75, False)])
def test_a_fade_that_takes_most_of_the_burn_is_no_end_of_the_fuel(lasts: float, seen: bool) -> None:
    """It is how the fire goes throughout; one that begins late is dated as well as its bend is seen."""
    whole = (TIME > 0.3) & (TIME < 5.9)
    first, last = TIME[whole][[0, -1]]
    begins = last - lasts * (last - first)
    value = 10e5 * np.exp(-1.5 * np.clip((TIME - begins) / (last - begins), 0.0, None))
    found = find_fade(TIME[whole], response(value, 5e3).value[whole])
    assert (found is not None) is seen
    if found is not None:
        assert found.begin == pytest.approx(begins, abs=2.0 * found.begin_std)
        assert 0.02 < found.begin_std < 0.15
        assert found.gone is None


@pytest.mark.parametrize("power", [0.8, 1.0, 1.6])
def test_a_fade_that_has_ended_before_the_liquid_is_dated_at_both_bends(power: float) -> None:
    value = 10e5 * (1.0 - 0.6 * np.clip((TIME - 2.5) / 1.5, 0.0, 1.0) ** power)
    found = find_fade(TIME[50:], response(value, 1e4).value[50:])
    assert found is not None
    assert found.gone is not None
    assert found.begin == pytest.approx(2.5, abs=2.0 * found.begin_std)
    assert found.gone == pytest.approx(4.0, abs=2.0 * found.gone_std)
    assert found.gone_std < 0.15


def test_a_fire_that_only_settles_does_not_fade() -> None:
    settling = 10e5 * (1.0 + 0.7 * np.exp(-TIME / 0.6)) * (1.0 - 0.02 * TIME)
    assert find_fade(TIME, response(settling, 1e4).value) is None


def test_the_deviation_of_a_fall_is_that_of_repeated_draws() -> None:
    """A short side after a long one: the slope of the long one, carried over, is most of the scatter."""
    generator, time = np.random.default_rng(5), np.arange(0.0, 1.0, GRID)
    noise = 1e3 * generator.standard_normal((300, time.size)) - 1e5 * time
    drawn = [_step(time, value, (0.1, 0.4), (0.44, 0.5), 1e3) for value in noise]
    falls, stated = np.array([fall for _, fall, _ in drawn]), np.array([error for _, _, error in drawn])
    assert 0.7 < falls.std() / np.median(stated) < 1.3


@pytest.mark.parametrize(("left", "gone"), [(0.05, True), (0.12, False)])
def test_where_a_fourteenth_of_the_grain_was_left_no_fall_is_the_end_of_the_fuel(left: float, gone: bool) -> None:
    """Slivers of a thirtieth are what every grain leaves."""
    log = log_of(fire(Stand(t_fuel_out=3.0), rate=200.0), white=5e3)
    stated = definition(grain=GrainSection(mass=Value(1.6)), observed=ObservedSection(fuel_mass_after=Value(left)))
    found = find_phases(log, stated).events["t_fuel_out"]
    assert (found.value is not None) is gone
    if not gone:
        assert "0.12 kg of fuel were left" in str(found.reason)
