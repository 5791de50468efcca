"""Which falls of the chamber's response are an end of the fuel, by their size and by how long they take."""

from __future__ import annotations

import numpy as np
import pytest
from tests.segment.stand import Stand, definition, fire, log_of

from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.segment.fuel import GRID, _fade, _fall_at, _Response
from hfanalysis.segment.phases import find_phases
from hfanalysis.units import Value

TIME = np.arange(0.0, 6.0, GRID)


def response(value: np.ndarray, noise: float) -> _Response:
    scatter = noise * np.random.default_rng(1).standard_normal(value.size)
    return _Response(TIME, value + scatter, noise)


@pytest.mark.parametrize(("level", "fall", "seen"), [(0.1e5, 0.06e5, False), (0.3e5, 0.2e5, True), (10e5, 6e5, True)])
def test_a_fall_of_a_twentieth_of_a_bar_is_the_wander_of_a_sensor(level: float, fall: float, seen: bool) -> None:
    """However large a part of the response it is, and however clear: it is that of a chamber near ambient."""
    value = np.where(TIME < 3.0, level, level - fall)
    assert (_fall_at(response(value, 1e-3 * fall), 3.0, None) > 0.0) is seen


@pytest.mark.parametrize("share", [0.1, 0.2])
def test_a_fall_of_a_fifth_is_no_end_of_the_fuel(share: float) -> None:
    assert _fall_at(response(np.where(TIME < 3.0, 10e5, (1.0 - share) * 10e5), 1e2), 3.0, None) == 0.0


@pytest.mark.parametrize(("lasts", "seen"), [(0.25, True), (0.4, True), (0.75, False)])
def test_a_fade_that_takes_most_of_the_burn_is_no_end_of_the_fuel(lasts: float, seen: bool) -> None:
    """It is how the fire goes throughout; one that begins late is dated by its middle, with its length as doubt."""
    whole = (TIME > 0.3) & (TIME < 5.9)
    first, last = TIME[whole][[0, -1]]
    begins = last - lasts * (last - first)
    value = 10e5 * np.exp(-1.5 * np.clip((TIME - begins) / (last - begins), 0.0, None))
    found = _fade(response(value, 1e2), 0.1, 6.0)
    assert (found is not None) is seen
    if found is not None:
        assert found.time == pytest.approx(0.5 * (begins + last), abs=0.05)
        assert found.duration == pytest.approx(0.85 * (last - begins), abs=0.05)
        drawn = np.random.default_rng(2).uniform(0.0, found.duration, 20_000)
        assert found.std == pytest.approx(drawn.std(), rel=0.03)


@pytest.mark.parametrize(("left", "gone"), [(0.05, True), (0.12, False)])
def test_where_a_fourteenth_of_the_grain_was_left_no_fall_is_the_end_of_the_fuel(left: float, gone: bool) -> None:
    """Slivers of a thirtieth are what every grain leaves."""
    log = log_of(fire(Stand(t_fuel_out=3.0), rate=200.0), white=5e3)
    stated = definition(grain=GrainSection(mass=Value(1.6)), observed=ObservedSection(fuel_mass_after=Value(left)))
    found = find_phases(log, stated).events["t_fuel_out"]
    assert (found.value is not None) is gone
    if not gone:
        assert "0.12 kg of fuel were left" in str(found.reason)
