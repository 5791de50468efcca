"""Specific impulse by what was expended: definitions, and the gas of a purge between its limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.products.filled import filled
from tests.segment.stand import HOLE_AREA, HOLES, Trial, definition, fire, log_of, segments_of

from hfanalysis.performance.flows import Flows
from hfanalysis.performance.measured import Fire
from hfanalysis.performance.specific_impulse import Expended, expended, impulses
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.units import Value

FIRE = Fire(9.0, 0.1, "video")
GRAVITY = 9.80665


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def flows() -> Flows:
    """1 kg/s of oxidizer and 0.1 kg/s of fuel until 6 s, a tenth of both after that."""
    time = np.arange(0.0, 9.0001, 0.02)
    on = np.where(time <= 6.0, 1.0, 0.1)
    return Flows(time, on, 0.1 * on, np.full(time.size, 1e-3), np.full(time.size, 0.03))


def gone(test: Trial, stated: TestDefinition, nitrogen: float = 0.0, purge: bool = True) -> Expended:
    """Of the flows above, of a calibration that is exact."""
    found = flows()
    calibration = filled(Calibration, {"C_i": Quantity(test.stand.C_i, std=0.0),
                                       "regression_rate_reference": Quantity(1e-3, "m/s", 0.0)})  # fmt: skip
    segments = segments_of(test) if purge else segments_of(test, t_purge=Quantity.absent("none enters"))
    entering = np.where(found.time > test.t_purge, nitrogen, 0.0)
    return expended(log_of(test), segments, stated, calibration, found, FIRE, entering)


def test_until_nitrogen_enters_it_is_what_injector_and_grain_gave(burn: Trial) -> None:
    found = gone(burn, definition(burn.stand))
    assert found.until == pytest.approx(burn.t_purge)
    until = 6.0 if burn.t_purge >= 6.0 else burn.t_purge
    assert found.to_purge.value == pytest.approx(1.1 * until + 0.11 * (burn.t_purge - until), rel=5e-3)


def test_after_it_the_gas_is_between_nitrogen_that_chokes_and_nitrous_oxide_that_does_not_expand(burn: Trial) -> None:
    found = gone(burn, definition(burn.stand))
    low, high = (float(words) for words in found.whole_why.split("after t_purge ")[1].split(" kg")[0].split(" to "))
    time, origin = np.arange(burn.t_purge, FIRE.end, 0.02), segments_of(burn).t_open.value or 0.0
    run, chamber = (
        np.interp(time + origin, c.time, c.values) for c in (log_of(burn)[n] for n in ("p_run", "p_chamber"))
    )
    area = burn.stand.C_i * HOLES * HOLE_AREA
    # half nitrogen, half nitrous oxide at 260 K
    density = run / (0.5 * (296.8 + 0.9 * 188.9) * 260.0)
    true = float(np.trapezoid(area * np.sqrt(2.0 * density * np.maximum(run - chamber, 0.0)), time)) * 0.75
    assert 0.0 < low < true < high
    fuel = 0.01 * (FIRE.end - burn.t_purge)
    assert found.whole.value == pytest.approx(found.to_purge.value + 0.5 * (low + high) + fuel, abs=0.02)
    assert found.whole.std == pytest.approx((high - low) / np.sqrt(12.0), rel=0.02)


def test_a_purge_that_is_known_is_counted_as_it_is(burn: Trial) -> None:
    found = gone(burn, definition(burn.stand), nitrogen=0.05)
    entered = 0.05 * (FIRE.end - burn.t_purge)
    alone = gone(burn, definition(burn.stand), purge=False)
    assert found.whole.value == pytest.approx(alone.whole.value + entered, rel=2e-3)


def test_what_is_weighed_after_a_test_without_purge_is_what_was_expended(burn: Trial) -> None:
    left = ObservedSection(oxidizer_mass_after=Value(1.0, 0.05), fuel_mass_after=Value(0.4, 0.01))
    stated = definition(burn.stand, grain=GrainSection(mass=Value(1.6, 0.01)), observed=left)
    found = gone(burn, stated, purge=False)
    assert found.whole.value == pytest.approx(burn.stand.mass - 1.0 + 1.2)
    assert found.whole_why == "loaded less left"


def test_the_three_are_impulses_over_the_weights_of_their_masses(burn: Trial) -> None:
    found = replace(gone(burn, definition(burn.stand)), whole=Value(8.0, 0.4), to_purge=Value(6.0, 0.0))
    whole, first = Quantity(12000.0, "N s", 0.0), Quantity(11000.0, "N s", 0.0)
    told = impulses(found, whole, first, (Quantity(7.0, "kg", 0.0), Quantity(1.5, "kg", 0.0)))
    values = [told[f"specific_impulse{which}"].value for which in ("", "_to_purge", "_loaded")]
    expected = [12000.0 / (8.0 * GRAVITY), 11000.0 / (6.0 * GRAVITY), 12000.0 / (8.5 * GRAVITY)]
    assert values == pytest.approx(expected)
    assert told["specific_impulse"].std == pytest.approx(expected[0] * 0.05)
