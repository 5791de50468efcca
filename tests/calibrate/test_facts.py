"""What test.toml states and the log contradicts is said, and what rests on it is doubted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.facts import held_against, nothing_to_regress
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import Calibration, FuelLaw
from hfanalysis.quantity import DOUBTED, IDENTIFIED
from hfanalysis.record.sections import NozzleSection, ObservedSection
from hfanalysis.units import Value

STAND = Stand()
THRUST = 1.35
"""Coefficient [-] of a nozzle at 14 bar with this stand's exit."""


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def held(test: Trial, scale: dict[str, float] | None = None, **change: Any) -> Calibration:
    """The calibration of a test of which some channels read ``scale`` times the truth above ambient."""
    found = scale or {}
    pressure = test.values["p_chamber"] - AMBIENT
    thrust = THRUST * np.pi * 0.0233**2 * np.maximum(pressure, 0.0)
    values = {n: AMBIENT + (v - AMBIENT) * found.get(n, 1.0) for n, v in test.values.items()}
    log = log_of(
        replace(test, values=values), white=1e3, more={"thrust": (test.time, thrust * found.get("thrust", 1.0))}
    )
    stated, segments = definition(test.stand, **change), segments_of(test)
    constants = calibrate(log, segments, stated, 40)
    made = constants.with_law(FuelLaw.absent("not asked for"))
    return held_against(log, segments, stated, made)


def doubts(found: Calibration, words: str) -> bool:
    assert found.C_i.value is not None
    return any(words in w for w in found.warnings) and words in (found.C_i.why or "") and found.C_i.verdict == DOUBTED


def test_a_sound_test_has_nothing_against_it(burn: Trial) -> None:
    found = held(burn, observed=ObservedSection(burn_time=Value(burn.t_v + 1.0)))
    assert found.C_i.verdict == IDENTIFIED
    assert not [w for w in found.warnings if "off" in w or "stated" in w]


def test_a_stated_burn_that_the_log_is_too_short_for_leaves_nothing_identified(burn: Trial) -> None:
    found = held(burn, observed=ObservedSection(burn_time=Value(3.0 * burn.t_v)))
    assert doubts(found, "before the stated burn of")
    assert found.C_i.interval is not None
    assert found.C_i.interval[0] < 0.6 * STAND.C_i
    assert not [n for n, q in found.quantities.items() if q.verdict == IDENTIFIED]


@pytest.mark.parametrize("factor", [0.3, 0.5, 1.6])
def test_a_chamber_gauge_that_reads_a_part_is_told_by_thrust_and_flow(burn: Trial, factor: float) -> None:
    found = held(burn, {"p_chamber": factor})
    words = "p_chamber reads about"
    assert doubts(found, words)
    said = float(next(w for w in found.warnings if words in w).split("about ")[1].split(" of")[0])
    assert said == pytest.approx(factor, rel=0.25)
    assert found.C_i.interval is not None
    assert found.C_i.interval[0] < STAND.C_i < found.C_i.interval[1]


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_thrust_cell_that_is_off_leaves_the_chamber_believed(burn: Trial, factor: float) -> None:
    assert held(burn, {"thrust": factor}).C_i.verdict == IDENTIFIED


def test_a_throat_stated_by_its_diameter_is_said(burn: Trial) -> None:
    wide = NozzleSection(Value(2.0 * 23.3e-3), Value(2.0 * 38.1e-3))
    assert doubts(held(burn, nozzle=wide), "[nozzle] throat_radius is stated at 2")


def test_a_run_line_at_a_third_of_the_tank_is_none(burn: Trial) -> None:
    shrunk = {"p_run": 0.4, "p_chamber": 1.0}
    found = held(fire(Stand(chamber=3e5), rate=200.0), shrunk)
    assert doubts(found, "far below the tank")


def test_an_exit_in_the_wrong_unit_is_said(burn: Trial) -> None:
    found = held(burn, nozzle=NozzleSection(Value(23.3e-3), Value(0.381)))
    assert any("exit_radius is 381.0 mm" in w and "is its unit right?" in w for w in found.warnings)


@pytest.mark.parametrize(("factor", "nothing"), [(1.0, False), (0.2, True)])
def test_there_is_nothing_to_regress_where_the_gauge_is_off(burn: Trial, factor: float, nothing: bool) -> None:
    stated, segments = definition(burn.stand), segments_of(burn)
    read = AMBIENT + factor * (burn.values["p_chamber"] - AMBIENT)
    log = log_of(replace(burn, values={**burn.values, "p_chamber": read}), white=1e3)
    found = calibrate(log, segments, stated, 20).constants
    assert (nothing_to_regress(log, segments, stated, found) is not None) == nothing
