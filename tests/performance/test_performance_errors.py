"""The performance table's deviations hold what goes wrong on a stand, and its peaks are those of the engine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.segment.heated_cell import EMPTY, heated, quenched
from tests.segment.stand import Trial, definition, fire, log_of, segments_of

from hfanalysis.arrays import Array
from hfanalysis.performance.measured import _average, _less, measured, specific_impulse
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.units import Value

Course = Callable[[Array], Array]
GRAIN = GrainSection(mass=Value(1.6, 0.01))


@pytest.fixture(scope="module")
def cold() -> Trial:
    return quenched()


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=500.0)


def table(test: Trial, log: TestLog, **seen: float) -> dict[str, Quantity]:
    phases = segments_of(test, t_end=Quantity(EMPTY, "s", 0.01))
    return measured(
        log, phases, definition(test.stand, observed=ObservedSection(burn_time=Value(EMPTY, 0.01)), grain=GRAIN), None
    )


def stepped(at: float) -> Course:
    """All of a drift at once, after a part of the burn."""
    return lambda part: (part > at).astype(np.float64)


def warmed(within: float) -> Course:
    """A drift by heat, in a time that is a part of the burn or several."""
    return lambda part: -np.expm1(-part / within) / -np.expm1(-1.0 / within)


def impulse_error(test: Trial, size: float, course: Course) -> float:
    """Of the impulse in its own standard deviations, where the cell drifts in this ``course`` of the burn."""
    log = heated(test, size)
    thrust = log["thrust"]
    left = np.interp(test.time, [EMPTY, 21.0], [1.0, 0.5])
    drifting = replace(
        thrust, values=test.values["thrust"] + size * course(np.clip(test.time / EMPTY, 0.0, 1.0)) * left, accuracy=1.0
    )
    found = table(test, replace(log, channels={**log.channels, "thrust": drifting}))["total_impulse"]
    burnt = (test.time >= 0.0) & (test.time <= EMPTY)
    true = float(np.trapezoid(test.values["thrust"][burnt], test.time[burnt]))
    assert found.value is not None
    assert found.std is not None
    return (found.value - true) / found.std


def test_an_impulse_is_known_whatever_the_course_of_the_cells_drift(cold: Trial) -> None:
    """A step at any moment is the most that a line may be wrong by; cells that warm are within it."""
    steps = [impulse_error(cold, size, stepped(at)) for size in (300.0, -200.0) for at in (0.1, 0.3, 0.5, 0.7, 0.9)]
    warm = [impulse_error(cold, size, warmed(in_)) for size in (300.0, -200.0) for in_ in (0.4, 0.6, 1.0, 2.0, 10.0)]
    assert 0.7 < np.sqrt(np.mean(np.square(steps))) < 1.3
    assert np.abs(steps + warm).max() < 2.0


def test_a_zero_takes_away_half_of_the_variance_of_a_gauge(burn: Trial) -> None:
    """The rest is its error of span: a gauge without a zero that is the root of 2 better is as good."""
    log = log_of(burn)

    def spread(accuracy: float, zeroed: bool) -> float:
        off = replace(log["p_chamber"], accuracy=accuracy, zero=0.0, zero_std=0.0 if zeroed else None)
        found = table(burn, replace(log, channels={**log.channels, "p_chamber": off}))["peak_chamber_pressure"].std
        assert found is not None
        return found

    assert spread(4e5, zeroed=True) == pytest.approx(spread(4e5 / np.sqrt(2.0), zeroed=False), rel=1e-3)


def with_hump(test: Trial, length: float, height: float) -> TestLog:
    """Half a sine on the chamber's pressure from 1 s on."""
    log = log_of(test)
    p, since = log["p_chamber"], test.time - 1.0
    hump = np.where((since > 0.0) & (since < length), height * np.sin(np.pi * since / length), 0.0)
    return replace(log, channels={**log.channels, "p_chamber": replace(p, values=p.values + hump)})


def test_an_overshoot_of_a_quarter_of_a_second_is_the_peak(burn: Trial) -> None:
    """Of a hard start's overshoot, as long as the chamber takes to settle, nine tenths are told."""
    plain = table(burn, log_of(burn))["peak_chamber_pressure"].value
    found = table(burn, with_hump(burn, 0.25, 20e5))["peak_chamber_pressure"].value
    level = float(np.interp(1.125, burn.time, burn.values["p_chamber"]))
    assert plain is not None
    assert found is not None
    assert found > plain + 5e5
    assert (found - level) / 20e5 == pytest.approx(0.93, abs=0.03)


def test_one_cycle_of_a_rough_chamber_is_no_peak(burn: Trial) -> None:
    """At the 20 Hz of the slowest hybrid instabilities, half a cycle lasts 25 ms."""
    plain = table(burn, log_of(burn))["peak_chamber_pressure"].value
    found = table(burn, with_hump(burn, 0.025, 5e5))["peak_chamber_pressure"].value
    assert found == pytest.approx(plain, abs=0.2 * 5e5)


def test_the_deviation_of_a_specific_impulse_is_that_of_drawn_ones() -> None:
    impulse, oxidizer, fuel = (Quantity(16e3, "N s", 160.0), Quantity(8.0, "kg", 0.2), Quantity(1.6, "kg", 0.1))
    found = specific_impulse(impulse, oxidizer, fuel)
    rng = np.random.default_rng(4)
    i, o, f = (q.value + q.std * rng.standard_normal(20_000) for q in (impulse, oxidizer, fuel))  # type: ignore[operator]
    drawn = i / (9.80665 * (o + f))
    assert found.value == pytest.approx(drawn.mean(), rel=2e-3)
    assert found.std == pytest.approx(drawn.std(), rel=0.03)


def test_an_average_is_as_well_known_as_impulse_and_burn_time() -> None:
    impulse, time = Quantity(16e3, "N s", 300.0), Quantity(9.0, "s", 0.2)
    rng = np.random.default_rng(5)
    drawn = (16e3 + 300.0 * rng.standard_normal(20_000)) / (9.0 + 0.2 * rng.standard_normal(20_000))
    found = _average(impulse, time)
    assert found.value == pytest.approx(drawn.mean(), rel=2e-3)
    assert found.std == pytest.approx(drawn.std(), rel=0.03)


def test_what_has_burnt_is_as_well_known_as_both_weighings() -> None:
    """And a weighing whose error nobody states, to a hundredth of what was loaded."""
    assert _less(Value(1.6, 0.03), None).std == 0.03
    assert _less(Value(1.6, 0.03), Value(0.4, 0.04)).std == pytest.approx(0.05)
    assert _less(Value(2.0), Value(0.4)).std == pytest.approx(0.02 * np.sqrt(2.0))


@pytest.mark.parametrize(("kilonewton_seconds", "unphysical"), [(25.0, False), (60.0, True)])
def test_more_impulse_than_the_propellant_can_give_is_unphysical(kilonewton_seconds: float, unphysical: bool) -> None:
    impulse = Quantity(1e3 * kilonewton_seconds, "N s", 100.0)
    found = specific_impulse(impulse, Quantity(10.0, "kg", 0.1), Quantity(2.0, "kg", 0.01))
    assert (found.verdict == "unphysical") == unphysical
    assert unphysical == ("its unit or a mass is off" in str(found.why))
