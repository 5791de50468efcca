"""A gauge at the head of a narrow port: efficiencies that take it into account hold the truth, others do not."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from benchmarks.narrow_port import PAGE, rows
from simulated.narrow_port import fired, judged

from hfanalysis.engine.port import head_over_nozzle
from hfanalysis.performance.efficiency import above_one
from hfanalysis.performance.tap import before_nozzle, narrow
from hfanalysis.products.validation import Efficiencies
from hfanalysis.quantity import Quantity

NAMES = ("c_star", "c_star_efficiency_frozen", "thrust_coefficient", "thrust_coefficient_efficiency_frozen")


def holds(quantity: Quantity, truth: float) -> bool:
    assert quantity.interval is not None
    low, high = quantity.interval
    return low <= truth <= high


@pytest.mark.parametrize("recovery", [0.15, 0.85])
def test_at_the_head_the_corrected_efficiencies_hold_the_truth_and_the_others_do_not(recovery: float) -> None:
    test = fired(recovery)
    truth, _ = judged(test, None, "nozzle")
    told, _ = judged(test, "head", "head")
    open_, _ = judged(test, None, "head")
    for name in NAMES:
        true, of_head, as_read = getattr(truth, name).value, getattr(told, name), getattr(open_, name)
        assert holds(of_head, true), name
        assert holds(as_read, true), name
        blind = Quantity(as_read.value, as_read.unit, as_read.std)
        assert not holds(blind, true), name


def test_in_a_wide_port_the_head_reads_what_the_nozzle_has() -> None:
    test = fired(0.5)
    wide = replace(test, engine=replace(test.engine, throat_area=0.02 * test.engine.throat_area))
    gamma, port = np.full(3, 1.24), np.full(3, 0.02)
    for tap in ("head", "aft", None):
        found = before_nozzle(tap, port, gamma, wide.engine)
        np.testing.assert_allclose([found.factor, found.low, found.high], 1.0, atol=1e-3)


def test_unstated_the_reading_stays_and_the_interval_reaches_to_one_side() -> None:
    test = fired(0.5)
    plain, found = judged(test, None, "head")
    assert np.array_equal(found.before.factor, np.ones(test.flows.time.size))
    for name, side in (("c_star_efficiency", -1), ("thrust_coefficient_efficiency", 1)):
        quantity: Quantity = getattr(plain, name)
        assert quantity.interval is not None
        below, above = quantity.value - quantity.interval[0], quantity.interval[1] - quantity.value
        assert (below > 3.0 * above) if side < 0 else (above > 3.0 * below)


@pytest.mark.parametrize(
    ("ratio", "limit", "words"), [(0.93, 1.0, "so that it chokes"), (1.5, 2.0, "below 2"), (2.5, None, "")]
)
def test_a_port_below_twice_the_throat_is_warned_of_with_its_value(
    ratio: float, limit: float | None, words: str
) -> None:
    test = fired(0.5)
    engine = replace(test.engine, throat_area=pi * test.engine.port_radius**2 / ratio)
    gamma = np.full(test.flows.time.size, 1.24)
    before = before_nozzle(None, test.flows.port, gamma, engine)
    found = list(narrow(None, engine, before, test.flows.time > 0.0))
    assert [beyond.limit for beyond in found] == ([] if limit is None else [limit])
    for beyond in found:
        assert beyond.value.value == pytest.approx(ratio)
        assert words in beyond.text
        assert "Hill and Peterson" in beyond.source


def efficiency(value: float, std: float) -> Efficiencies:
    none = Quantity.absent("not asked for")
    told: dict[str, Any] = dict.fromkeys(Efficiencies.model_fields, none)
    return Efficiencies(**{**told, "thrust_coefficient_efficiency": Quantity(value, "", std)})


def test_an_efficiency_above_one_by_more_than_its_interval_is_a_finding() -> None:
    (found,) = above_one(efficiency(1.05, 0.01))
    assert found.channels == ("thrust", "p_chamber")
    assert "1.050" in found.text
    assert not above_one(efficiency(1.015, 0.01))
    assert not above_one(efficiency(0.97, 0.01))


def test_the_page_has_what_the_study_finds() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert all(line in page for line in rows(0.85))


def test_wherever_the_gauge_sits_the_warning_has_the_same_head() -> None:
    test = fired(0.5)
    gamma, burning = np.full(test.flows.time.size, 1.24), test.flows.time > 0.0
    said = []
    for tap in ("head", "aft", None):
        (found,) = narrow(tap, test.engine, before_nozzle(tap, test.flows.port, gamma, test.engine), burning)
        said.append(found.text.partition("; ")[0])
    assert len(set(said)) == 1
    engine = test.engine
    areas = [pi * r**2 / engine.throat_area for r in (test.flows.port[1], engine.outer_radius)]
    assert f"up to {100.0 * (head_over_nozzle(1.24, *areas, 0.0) - 1.0):.0f} % above" in said[0]
