"""When a calibrated number is believed, refused or remarked upon: bounds by what injectors, gases and scales do."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from tests.segment.stand import Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.blowdown import Inputs, Reduction
from hfanalysis.calibrate.diagnostics import other_masses
from hfanalysis.calibrate.loaded_mass import LoadedMass
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.calibrate.verdicts import judge_discharge, judge_exponent
from hfanalysis.products.calibration import Rest, TankConstants
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value


def reduction(**values: float) -> Reduction:
    usual = {"C_i": 0.3, "m": 1.1, "Z": 0.6, "vapor_mass": 1.8, "vapor_mass_end": 1.1, "temperature_v": 275.0}
    return cast(Reduction, SimpleNamespace(**{**usual, **values}))


def draws(name: str, value: float, std: float) -> Draws:
    return Draws({name: value + std * np.random.default_rng(8).standard_normal(2000)})


@pytest.mark.parametrize(
    ("value", "std", "verdict"),
    [
        (0.85, 0.02, "identified"),  # a plate with rounded holes
        (0.25, 0.01, "identified"),  # liquid that flashes in the holes
        (0.08, 0.005, "doubted"),  # holes half blocked, or an area that is wrong by three
        (0.02, 0.002, "unphysical"),
        (1.2, 0.02, "unphysical"),  # more than without any loss
        (1.05, 0.06, "identified"),  # which may well be less than 0.95
        (0.99, 0.01, "doubted"),
    ],
)
def test_a_discharge_coefficient_is_one_that_holes_have(value: float, std: float, verdict: str) -> None:
    found = judge_discharge(reduction(C_i=value), draws("C_i", value, std), 0.0)
    assert found.verdict == verdict
    assert found.std == pytest.approx(std, rel=0.05)
    assert found.interval == pytest.approx((value - 1.96 * std, value + 1.96 * std), abs=0.15 * std)


@pytest.mark.parametrize(("share", "told"), [(0.004, False), (0.016, True)])
def test_samples_without_a_flow_are_told_from_a_hundredth_on(share: float, told: bool) -> None:
    found = judge_discharge(reduction(), draws("C_i", 0.3, 0.01), share)
    assert ("count as no flow" in str(found.why)) is told


@pytest.mark.parametrize(
    ("value", "std", "verdict"),
    [
        (1.05, 0.02, "identified"),  # isothermal, nearly
        (1.26, 0.02, "identified"),  # the isentropic exponent of the thin gas is 1.27
        (1.45, 0.02, "unphysical"),  # no gas of three atoms
        (0.9, 0.02, "unphysical"),  # only with kilowatts of heat
        (1.35, 0.08, "identified"),  # which may well be 1.25
        (1.1, 0.16, "identified"),
        (1.1, 0.26, "not identifiable"),  # all of the physical range
    ],
)
def test_an_exponent_is_one_that_expanding_vapor_has(value: float, std: float, verdict: str) -> None:
    inputs = cast(Inputs, SimpleNamespace(t_v=5.0, t_end=6.0, p_v=30e5, p_end=18e5))
    found = judge_exponent(reduction(m=value), draws("m", value, std), inputs, None, saturation())
    assert found.verdict == verdict


def test_few_answers_are_no_deviation() -> None:
    few = Draws({"m": np.r_[np.full(200, np.nan), 1.0 + 0.1 * np.arange(9)]})
    assert np.isnan(few.std("m"))
    assert few.answered("m") == pytest.approx(9.0 / 209.0)


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(log: TestLog, test: Trial, **change: Any) -> TankConstants:
    return calibrate(log, segments_of(test), definition(test.stand, **change), 30).constants


def test_the_loaded_mass_is_as_well_known_as_it_is_stated(burn: Trial) -> None:
    found = calibrated(log_of(burn), burn, mass=Value(burn.stand.mass, 0.07)).quantities
    assert (found["oxidizer_mass"].value, found["oxidizer_mass"].std) == (burn.stand.mass, 0.07)
    # what is left at t_feed, nothing having gone yet, and what has gone by t_v, are known no better
    assert found["mass_at_t_feed"].std == pytest.approx(0.07)
    assert found["oxidizer_mass_liquid_phase"].std == pytest.approx(0.07, rel=0.2)


@pytest.mark.parametrize(("share", "known"), [(0.05, True), (0.15, False)])
def test_a_line_below_the_chamber_for_a_tenth_of_the_liquid_gives_no_coefficient(
    burn: Trial, share: float, known: bool
) -> None:
    below = (burn.time > 1.0) & (burn.time < 1.0 + share * burn.t_v)
    values = {**burn.values, "p_run": np.where(below, burn.values["p_chamber"] - 1e5, burn.values["p_run"])}
    found = calibrated(log_of(replace(burn, values=values)), burn).quantities["C_i"]
    assert (found.value is not None) is known


@pytest.mark.parametrize(("length", "known"), [(0.06, True), (0.2, False)])
def test_a_hole_in_the_vapor_phase_takes_m_from_a_tenth_of_a_second_on(burn: Trial, length: float, known: bool) -> None:
    log = log_of(burn)
    tank, since = log["p_tank"], log["p_tank"].time - 100.0 - burn.t_v
    flags = np.where((since > 0.2) & (since < 0.2 + length), 1, 0).astype(np.uint8)
    found = calibrated(replace(log, channels={**log.channels, "p_tank": replace(tank, flags=flags)}), burn)
    assert (found.quantities["m"].value is not None) is known


@pytest.mark.parametrize(
    ("cell", "own", "remarks"),
    [
        (10.2, 10.5, 0),
        (10.6, 10.5, 1),  # beyond 0.2 kg of scale and three deviations
        (10.0, 11.0, 0),  # two deviations of what the blowdown tells
        (10.0, 12.0, 1),
        (11.0, 12.0, 2),
    ],
)
def test_masses_that_disagree_by_three_deviations_are_remarked(cell: float, own: float, remarks: int) -> None:
    at_rest = cast(
        Rest,
        SimpleNamespace(load_cell_mass=Quantity(cell, "kg", 0.05), blowdown_mass=Quantity(own, "kg", 0.5)),
    )
    assert len(other_masses(at_rest, LoadedMass(10.0, 0.05, "as stated"))) == remarks


@pytest.mark.parametrize(("samples", "known"), [(2, True), (6, False)])
def test_a_slow_logger_may_lose_samples_in_the_vapor_phase_as_long_as_others_are_near(
    samples: int, known: bool
) -> None:
    """At 20 Hz two lost samples leave 0.15 s, within four steps; six leave a third of a second."""
    test = fire(Stand(vapor_time=1.5), rate=20.0)
    log = log_of(test)
    tank = log["p_tank"]
    first = int(np.searchsorted(tank.time, 100.0 + test.t_v + 0.5))
    flags = np.zeros(tank.time.size, np.uint8)
    flags[first : first + samples] = 1
    found = calibrated(replace(log, channels={**log.channels, "p_tank": replace(tank, flags=flags)}), test)
    assert (found.quantities["m"].value is not None) is known
