"""What was put into a test comes out of its calibration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.segment.stand import HOLE_AREA, HOLES, Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import TankConstants
from hfanalysis.record.sections import Injector
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

STANDS = {
    "poor injector, lossy line": Stand(C_i=0.2, K_loss=6e8, mass=9.0),
    "good injector, wide line": Stand(C_i=0.6, K_loss=2e7, mass=11.0, volume=18e-3),
    "cold tank": Stand(temperature=278.0, chamber=8e5),
    "hot tank, steep expansion": Stand(temperature=300.0, m=1.25),
    "heated vapor": Stand(m=0.9),
    "the report's properties": Stand(source="report"),
}


OTHER_VERDICTS = {"Z": "derived", "vapor_mass_at_t_v": "derived", "m_choked": "conditional", "vapor_C_d": "conditional"}
"""Of what a table says, and of what hangs on how the vapor flows."""


def calibrated(test: Trial, samples: int = 20) -> TankConstants:
    return calibrate(log_of(test), segments_of(test), definition(test.stand), samples).constants


def value(found: TankConstants, name: str) -> float:
    quantity = found.quantities[name]
    assert quantity.value is not None, quantity.reason
    return quantity.value


@pytest.mark.parametrize("name", STANDS)
def test_without_noise_the_truth_comes_back(name: str) -> None:
    stand = STANDS[name]
    test = fire(stand)
    found = calibrated(test)
    assert value(found, "C_i") == pytest.approx(stand.C_i, rel=1e-3)
    assert value(found, "m") == pytest.approx(stand.m, rel=5e-3)
    assert value(found, "K_loss") == pytest.approx(stand.K_loss, rel=1e-2)
    nitrous = saturation(stand.source)
    vapor = stand.volume * float(nitrous.vapor_density(nitrous.temperature(test.p_v)))
    assert value(found, "vapor_mass_at_t_v") == pytest.approx(vapor, rel=1e-3)
    assert value(found, "oxidizer_mass_liquid_phase") == pytest.approx(stand.mass - vapor, rel=1e-3)


def test_losses_are_means_over_their_phases() -> None:
    test = fire()
    found = calibrated(test)
    loss = test.values["p_tank"] - test.values["p_run"]
    for name, start, end in (("p_loss_liquid", 0.0, test.t_v), ("p_loss_vapor", test.t_v, test.t_purge)):
        part = (test.time >= start) & (test.time < end)
        assert value(found, name) == pytest.approx(float(loss[part].mean()), rel=0.01)


def test_the_highest_flow_is_that_of_the_tank_over_a_tenth_of_a_second() -> None:
    test = fire()
    highest = float(np.convolve(test.flow, np.full(100, 0.01), "valid").max())
    assert value(calibrated(test), "oxidizer_flow_peak") == pytest.approx(highest, rel=2e-3)


def test_the_mass_at_t_feed_is_what_had_not_left_by_then() -> None:
    test = fire()
    segments = segments_of(test, t_feed=replace(segments_of(test).events["t_v"], value=1.0))
    found = calibrate(log_of(test), segments, definition(test.stand), 20).constants
    expected = float(np.interp(1.0, test.time[test.time >= 0.0], test.mass[: (test.time >= 0.0).sum()]))
    assert value(found, "mass_at_t_feed") == pytest.approx(expected, rel=2e-3)


def test_a_slow_logger_finds_the_same() -> None:
    test = fire(rate=50.0)
    found = calibrated(test)
    assert value(found, "C_i") == pytest.approx(test.stand.C_i, rel=5e-3)
    assert value(found, "K_loss") == pytest.approx(test.stand.K_loss, rel=2e-2)


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


@settings(max_examples=15, deadline=None)
@given(factor=st.floats(0.4, 2.0))
def test_C_i_goes_with_one_over_the_area(burn: Trial, factor: float) -> None:
    """What the flow says is C_i N_i A_i; with smaller holes the same flow needs a better coefficient."""
    found = []
    for area in (HOLE_AREA, factor * HOLE_AREA):
        stated = definition(burn.stand, injector=Injector(HOLES, Value(area)))
        found.append(calibrate(log_of(burn), segments_of(burn), stated, 12).constants)
    assert value(found[0], "C_i") / value(found[1], "C_i") == pytest.approx(factor, rel=1e-9)
    for name in ("m", "K_loss", "Z", "oxidizer_flow_peak"):
        assert value(found[0], name) == pytest.approx(value(found[1], name), rel=1e-6)


def test_C_i_goes_with_the_liquid_that_left(burn: Trial) -> None:
    """One kilogram more, and all of it went through the injector."""
    more = definition(burn.stand, mass=Value(burn.stand.mass + 1.0, 0.02))
    found = [calibrate(log_of(burn), segments_of(burn), d, 12).constants for d in (definition(burn.stand), more)]
    one, other = (value(f, "C_i") / value(f, "oxidizer_mass_liquid_phase") for f in found)
    assert one == pytest.approx(other, rel=1e-9)
    difference = [value(f, "oxidizer_mass_liquid_phase") for f in found]
    assert difference[1] - difference[0] == pytest.approx(1.0, rel=1e-9)


def test_the_compressibility_factor_is_that_of_the_saturated_vapor() -> None:
    from CoolProp import CoolProp

    test = fire()
    t = float(saturation().temperature(test.p_v))
    exact = CoolProp.PropsSI("Z", "T", t, "Q", 1, "NitrousOxide")
    assert value(calibrated(test), "Z") == pytest.approx(exact, rel=2e-3)


def test_the_coefficient_over_time_is_flat_where_the_tank_does_nothing_else() -> None:
    test = fire()
    history = calibrated(test).C_i_history
    assert history is not None
    assert len(history.time) > 10
    np.testing.assert_allclose(history.value, test.stand.C_i, rtol=0.02)
    assert min(history.std) > 0.0


def test_the_tanks_content_over_time_fills_it_and_weighs_what_it_should() -> None:
    test = fire()
    history = calibrated(test).tank_history
    assert history is not None
    nitrous = saturation()
    liquid, vapor = (np.array(n) * OXIDIZER_MOLAR_MASS / 1e3 for n in (history.liquid, history.vapor))
    temperature = np.array(history.temperature)
    filled = liquid / nitrous.liquid_density(temperature) + vapor / nitrous.vapor_density(temperature)
    np.testing.assert_allclose(filled, test.stand.volume, rtol=1e-4)
    after = test.time >= 0.0
    truth = np.interp(history.time, test.time[after], test.mass)
    np.testing.assert_allclose(liquid + vapor, truth, rtol=3e-3)
    assert history.liquid[-1] < 0.02 * history.liquid[0]
    flow = np.interp(history.time, test.time[after], test.flow)
    np.testing.assert_allclose(history.flow[1:], flow[1:], rtol=0.01)


def test_every_quantity_of_a_good_test_has_an_answer() -> None:
    for name, quantity in calibrated(fire(rate=200.0)).quantities.items():
        assert quantity.value is not None, f"{name}: {quantity.reason}"
        assert quantity.verdict == OTHER_VERDICTS.get(name, "identified"), name
