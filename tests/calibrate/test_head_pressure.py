"""A gauge aft of the grain: the injector has the head's pressure behind it."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.head_pressure import before_injector, before_nozzle_of
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.engine.port import stagnation_over_static
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.logspec import ChannelSpec
from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.units import Value

OUTER, LENGTH, DENSITY = 40e-3, 0.6, 900.0


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def stated(test: Trial, tap: str | None, port: float, outer: float = OUTER) -> TestDefinition:
    mass = DENSITY * pi * LENGTH * (outer**2 - port**2)
    grain = GrainSection(mass=Value(mass), length=Value(LENGTH), density=Value(DENSITY), outer_radius=Value(outer))
    found = definition(test.stand, grain=grain, observed=ObservedSection(burn_time=Value(9.0, 0.1)))
    return replace(found, channels={"p_chamber": ChannelSpec("p", unit="Pa", tap=tap, name="p_chamber")})  # type: ignore[arg-type]


def aft(log: TestLog, share: np.ndarray) -> TestLog:
    """What a gauge reads aft where the head has the log's chamber pressure."""
    chamber = log["p_chamber"]
    above = np.clip((chamber.values / AMBIENT - 1.0) / 0.8, 0.0, 1.0)
    read = replace(chamber, values=chamber.values / (1.0 + above * (share - 1.0)))
    return replace(log, channels={**log.channels, "p_chamber": read})


def test_the_injectors_coefficient_is_that_of_the_heads_pressure(burn: Trial) -> None:
    told, untold = stated(burn, "aft", 22e-3), stated(burn, None, 22e-3)
    log, segments = log_of(burn), segments_of(burn)
    # port and throat are alike at first: the head stands 34 % above what is read, then less and less
    factor = before_injector(log, segments, told)["p_chamber"].values / log["p_chamber"].values
    read = aft(log, np.maximum(factor, 1.0))
    true, found, blind = (
        calibrate(taken, segments, of, 20).constants.C_i.value
        for taken, of in ((log, untold), (read, told), (read, untold))
    )
    assert found == pytest.approx(true, rel=3e-3)
    assert abs((blind or 0.0) / (true or 1.0) - 1.0) > 0.02


def test_in_a_wide_port_aft_and_head_are_one(burn: Trial) -> None:
    wide = stated(burn, "aft", 150e-3, 200e-3)
    log = log_of(burn)
    for found in (before_injector(log, segments_of(burn), wide), before_nozzle_of(log, wide)):
        np.testing.assert_allclose(found["p_chamber"].values, log["p_chamber"].values, rtol=5e-4)


def test_the_nozzles_pressure_is_the_static_one_brought_to_rest(burn: Trial) -> None:
    log, told = log_of(burn), stated(burn, "aft", 22e-3)
    found, read = before_nozzle_of(log, told)["p_chamber"].values, log["p_chamber"].values
    assert told.nozzle is not None
    assert told.nozzle.throat_radius is not None
    expected = stagnation_over_static(1.24, OUTER**2 / told.nozzle.throat_radius.value**2)
    assert np.allclose((found / read)[read > 2.0 * AMBIENT], expected)
    assert np.array_equal(found[read <= AMBIENT], read[read <= AMBIENT])


@pytest.mark.parametrize("tap", ["head", None])
def test_a_gauge_elsewhere_is_taken_as_it_reads(burn: Trial, tap: str | None) -> None:
    log = log_of(burn)
    assert before_injector(log, segments_of(burn), stated(burn, tap, 22e-3)) is log
    assert before_nozzle_of(log, stated(burn, tap, 22e-3)) is log
