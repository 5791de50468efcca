"""What a test cannot tell is refused, with the reason; what it tells and cannot be is called unphysical."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import TankConstants
from hfanalysis.quantity import NOT_IDENTIFIABLE, UNPHYSICAL, Quantity
from hfanalysis.units import Value

SAMPLES = 40


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(test: Trial, **change: Any) -> TankConstants:
    events = {n: change.pop(n) for n in ("t_v", "t_purge", "t_feed") if n in change}
    without = change.pop("without", ())
    log = log_of(test, white=change.pop("white", 1e3), without=without)
    return calibrate(log, segments_of(test, **events), definition(test.stand, **change), SAMPLES).constants


def refused(found: TankConstants, name: str) -> str:
    quantity = found.quantities[name]
    assert quantity.value is None, f"{name} = {quantity.value}"
    assert quantity.verdict == NOT_IDENTIFIABLE
    return str(quantity.reason)


def with_values(test: Trial, **values: Any) -> Trial:
    return replace(test, values={**test.values, **values})


# --- C_i --------------------------------------------------------------------------------------------------------------


def test_C_i_is_refused_where_the_run_line_is_not_above_the_chamber(burn: Trial) -> None:
    found = calibrated(with_values(burn, p_run=burn.values["p_chamber"] - 2e5))
    for name in ("C_i", "m", "K_loss", "oxidizer_flow_peak"):
        assert "p_run is not above p_chamber over 100 % of the liquid phase" in refused(found, name)
    assert found.quantities["p_loss_liquid"].value is not None  # the loss needs no flow
    assert found.rest is None


def test_a_few_samples_with_the_run_line_below_the_chamber_are_counted_as_no_flow(burn: Trial) -> None:
    below = np.where((burn.time > 2.0) & (burn.time < 2.2), burn.values["p_chamber"] - 1e5, burn.values["p_run"])
    found = calibrated(with_values(burn, p_run=below)).quantities["C_i"]
    assert found.value is not None
    assert found.verdict == "identified"
    assert "count as no flow" in str(found.why)


@pytest.mark.parametrize("section", ["tank", "injector"])
def test_without_tank_or_injector_there_is_no_C_i(burn: Trial, section: str) -> None:
    found = calibrated(burn, **{section: None})
    assert section in refused(found, "C_i")
    assert found.quantities["p_loss_liquid"].value is not None


def test_without_an_end_of_the_liquid_there_is_nothing_to_calibrate_with(burn: Trial) -> None:
    with pytest.raises(AbsentError, match="no end of the liquid to calibrate with: no knee"):
        calibrated(burn, t_v=Quantity.absent("no knee"))


@pytest.mark.parametrize("channel", ["p_tank", "p_chamber"])
def test_a_burn_needs_the_pressures_of_tank_and_chamber(burn: Trial, channel: str) -> None:
    with pytest.raises(AbsentError, match=f"the log has no {channel}"):
        calibrated(burn, without=(channel,))


def test_a_cold_flow_may_lack_the_chamber_pressure(burn: Trial) -> None:
    cold = fire(Stand(chamber=0.0), rate=200.0)
    segments = segments_of(cold).but(kind="cold_flow")
    found = calibrate(log_of(cold, without=("p_chamber",)), segments, definition(cold.stand), SAMPLES).constants
    assert found.quantities["C_i"].value == pytest.approx(cold.stand.C_i, rel=0.01)
    assert any("ambient pressure taken" in note for note in found.notes)


def test_a_C_i_above_one_is_unphysical(burn: Trial) -> None:
    small = replace(definition(burn.stand).injector, holes=6)
    found = calibrated(burn, injector=small).quantities["C_i"]
    assert found.value == pytest.approx(0.35 * 22 / 6, rel=0.01)
    assert found.verdict == UNPHYSICAL
    assert "outside 0.05 to 1.0" in str(found.why)


def test_less_oxidizer_than_the_vapor_that_is_left_is_unphysical(burn: Trial) -> None:
    found = calibrated(burn, mass=Value(0.8, 0.01)).quantities["C_i"]
    assert found.value is not None
    assert found.value < 0.0
    assert found.verdict == UNPHYSICAL
    assert "less than the vapor left at t_v" in str(found.why)


# --- m ----------------------------------------------------------------------------------------------------------------


def test_with_nitrogen_in_before_the_liquid_is_gone_there_is_no_m(burn: Trial) -> None:
    found = calibrated(burn, t_purge=Quantity(burn.t_v - 0.5, "s", 0.01))
    assert "nitrogen is in the tank from 5.2" in refused(found, "m")
    assert "before the liquid is gone" in refused(found, "p_loss_vapor")
    assert found.quantities["C_i"].value is not None


def test_a_vapor_phase_of_milliseconds_does_not_tell_m() -> None:
    reason = refused(calibrated(fire(Stand(vapor_time=0.004), rate=1000.0), white=2e4), "m")
    assert "too little to tell m" in reason or "too short" in reason
    assert "0.004 s" in reason


def test_a_vapor_phase_of_a_few_samples_does_not_tell_m() -> None:
    assert "samples of p_tank: too little to tell m" in refused(calibrated(fire(Stand(vapor_time=0.5), rate=10.0)), "m")


def test_a_tank_pressure_that_rises_tells_no_m(burn: Trial) -> None:
    rising = np.where(burn.time > burn.t_v, burn.p_v + 1e5 * (burn.time - burn.t_v), burn.values["p_tank"])
    assert "does not fall over the vapor phase" in refused(calibrated(with_values(burn, p_tank=rising)), "m")


def test_no_exponent_empties_a_tank_as_fast_as_a_burst_one(burn: Trial) -> None:
    since = np.maximum(burn.time - burn.t_v, 0.0)
    burst = np.where(since > 0.0, AMBIENT + (burn.p_v - AMBIENT) * np.exp(-since / 0.01), burn.values["p_tank"])
    reason = refused(calibrated(with_values(burn, p_tank=burst, p_run=np.minimum(burn.values["p_run"], burst))), "m")
    assert "no exponent between 0.05 and 6.0 takes the tank from" in reason


def test_an_exponent_below_one_is_unphysical_and_states_its_heat() -> None:
    found = calibrated(fire(Stand(m=0.7), rate=500.0)).quantities["m"]
    assert found.value == pytest.approx(0.7, rel=0.03)
    assert found.verdict == UNPHYSICAL
    assert "no property of nitrous oxide" in str(found.why)
    kilowatts = float(str(found.why).split("implies ")[1].split(" kW")[0])
    assert kilowatts > 10.0


def test_without_nitrogen_m_is_shot_to_a_share_of_the_pressure() -> None:
    """A test that simply empties: m comes from the first 40 % of the pressure lost."""
    test = fire(Stand(vapor_time=2.5), rate=500.0)
    found = calibrated(test, t_purge=Quantity.absent("no purge line"))
    assert found.quantities["m"].value == pytest.approx(test.stand.m, rel=0.02)
    assert any("40 %" in note for note in found.notes)


def test_a_log_that_ends_with_the_liquid_tells_no_m() -> None:
    test = fire(rate=500.0)
    keep = test.time < test.t_v + 0.05
    short = replace(test, time=test.time[keep], values={n: v[keep] for n, v in test.values.items()})
    reason = refused(calibrated(short, t_purge=Quantity.absent("the log has no p_purge")), "m")
    assert "ends" in reason or "no good samples" in reason
