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


@pytest.mark.parametrize(("factor", "believed"), [(0.3, False), (0.5, False), (1.0, True), (1.6, False)])
def test_a_gauge_whose_size_is_doubted_is_believed_where_the_flow_speaks_for_it(
    burn: Trial, factor: float, believed: bool
) -> None:
    why = doubted_law(burn, factor)
    assert (why is None) == believed
    assert believed or "the size of p_chamber cannot be believed" in str(why)


def test_a_throat_stated_by_its_diameter_leaves_nothing_to_regress(burn: Trial) -> None:
    """Thrust and p_c A_t disagree by four then, which doubts the sizes of both."""
    wide = NozzleSection(Value(2.0 * 23.3e-3), Value(2.0 * 38.1e-3))
    assert "or the stated throat" in str(doubted_law(burn, 1.0, nozzle=wide))


def doubted_law(burn: Trial, factor: float, **change: Any) -> str | None:
    """Why a and n have nothing to rest on, of a chamber gauge that reads this much and whose scale is doubted."""
    stated, segments = definition(burn.stand, **change), segments_of(burn)
    read = AMBIENT + factor * (burn.values["p_chamber"] - AMBIENT)
    log = log_of(replace(burn, values={**burn.values, "p_chamber": read}), white=1e3)
    wide = replace(log["p_chamber"], doubt=0.5 * float(np.ptp(read)))
    found = calibrate(log, segments, stated, 20).constants
    return nothing_to_regress(replace(log, channels={**log.channels, "p_chamber": wide}), segments, stated, found)


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
