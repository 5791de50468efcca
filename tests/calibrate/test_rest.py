"""The tank at rest: does it fit, how cold is it really, and which mass does the calibration work with."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.segment.stand import Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.rest import blowdown_mass, fit_bulk, liquid_phase_heat, state_remarks
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.engine.blowdown import blow_down
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.tank import split
from hfanalysis.errors import InputError
from hfanalysis.products.calibration import TankConstants
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

VOLUME, MASS = Stand().volume, Stand().mass


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(test: Trial, scale: Any = None, **change: Any) -> TankConstants:
    log = log_of(test, white=1e3, more={"m_tank": scale} if scale else None, accuracy=change.pop("accuracy", 1e4))
    return calibrate(log, segments_of(test), definition(test.stand, **change), 20).constants


def worked_with(found: TankConstants) -> float:
    """The loaded mass that a calibration took [kg]."""
    parts = [found.quantities[n].value for n in ("oxidizer_mass_liquid_phase", "vapor_mass_at_t_v")]
    return float(np.sum(np.array(parts, dtype=float)))


def scale_of(test: Trial, mass: float) -> tuple[Any, Any]:
    return test.time, np.where(test.time < 0.0, mass, 0.0) + 1e-3 * np.sin(1e3 * test.time)


# --- state at rest ----------------------------------------------------------------------------------------------------


def test_a_tank_that_fits_needs_no_remark() -> None:
    share, remarks = state_remarks(saturation(), VOLUME, MASS, 50e5)
    assert remarks == []
    t = float(saturation().temperature(50e5))
    expected = split(saturation(), VOLUME, MASS, t).liquid / float(saturation().liquid_density(t)) / VOLUME
    assert share == pytest.approx(expected)
    assert 0.6 < expected < 0.8


def test_a_pressure_above_the_critical_one_is_no_saturated_tank() -> None:
    share, (remark,) = state_remarks(saturation(), VOLUME, MASS, 80e5)
    assert share is None
    assert "80.0 bar, above nitrous oxide's critical pressure (72.4 bar)" in remark
    assert "supercharged or its gauge is off" in remark


def test_more_than_a_tank_holds_as_liquid_is_remarked_with_the_temperature_at_which_it_fits() -> None:
    nitrous = saturation()
    mass = 0.95 * VOLUME * float(nitrous.liquid_density(273.15))
    share, (remark,) = state_remarks(nitrous, VOLUME, mass, 60e5)
    assert share is not None
    assert share > 1.0
    fits = float(remark.split("only below ")[1].split(" degC")[0]) + 273.15
    assert VOLUME * float(nitrous.liquid_density(fits)) == pytest.approx(mass, rel=0.01)


def test_less_than_the_vapor_would_weigh_is_remarked() -> None:
    share, (remark,) = state_remarks(saturation(), VOLUME, 1.0, 50e5)
    assert share is not None
    assert share < 0.0
    assert "less than the saturated vapor alone would weigh" in remark


# --- what the blowdown says -------------------------------------------------------------------------------------------


def test_the_blowdown_alone_weighs_the_tank() -> None:
    test = fire()
    t_dry = float(saturation().temperature(test.p_v))
    assert blowdown_mass(saturation(), VOLUME, test.stand.temperature, t_dry) == pytest.approx(MASS, rel=1e-3)


@pytest.mark.parametrize("bulk", [260.0, 400.0])
def test_a_bulk_that_did_not_cool_weighs_nothing(bulk: float) -> None:
    assert blowdown_mass(saturation(), VOLUME, bulk, 265.0) is None


@pytest.mark.parametrize("watts", [0.0, 30e3, -20e3])
def test_the_heat_into_the_tank_is_found_again(watts: float) -> None:
    time = np.arange(0.0, 12.0, 1e-3)
    feed = FeedSystem(VOLUME, 2.2e-5, 4e8)
    run = blow_down(saturation(), feed, MASS, 293.15, time, np.full(time.size, 12e5), 1.0, watts)
    heat = liquid_phase_heat(saturation(), VOLUME, MASS, 293.15, run.temperature[-1])
    assert heat / run.t_v == pytest.approx(watts, rel=0.05, abs=100.0)  # heated, its path is another


def test_the_bulk_is_where_the_blowdown_started() -> None:
    test = fire()
    quiet = int((test.time < 0.0).sum())
    liquid = slice(quiet + 100, quiet + int((test.t_v - 0.05) * 1000))
    left = MASS - test.mass[100 : 100 + liquid.stop - liquid.start]
    found = fit_bulk(left, saturation().temperature(test.values["p_tank"][liquid]))
    assert found is not None
    assert found.temperature == pytest.approx(test.stand.temperature, abs=0.15)  # T against mass is not quite quadratic
    assert fit_bulk(left[:5], left[:5]) is None


def test_a_tank_that_fits_itself_is_not_remarked(burn: Trial) -> None:
    found = calibrated(burn)
    assert found.rest is not None
    assert found.rest.remarks == ()
    assert found.rest.blowdown_mass.value == pytest.approx(MASS, rel=0.01)
    assert found.rest.bulk_temperature.value == pytest.approx(burn.stand.temperature, abs=0.2)
    assert abs(found.rest.liquid_phase_heat.value or np.nan) < 3e3  # of the 300 kW that boil all liquid


def test_a_warm_gauge_over_a_cold_bulk_is_stratified(burn: Trial) -> None:
    warm = np.where(burn.time < 0.0, burn.values["p_tank"] + 5e5, burn.values["p_tank"])
    found = calibrated(replace(burn, values={**burn.values, "p_tank": warm}))
    (remark,) = found.warnings
    gauge, bulk = (float(part.split(" degC")[0]) for part in (remark.split("boil: ")[1], remark.split("from ")[1]))
    assert gauge == pytest.approx(float(saturation().temperature(burn.values["p_tank"][0] + 5e5)) - 273.15, abs=0.1)
    assert bulk == pytest.approx(burn.stand.temperature - 273.15, abs=0.2)


def test_a_supercharged_tank_is_calibrated_with_a_remark(burn: Trial) -> None:
    pressed = np.where(burn.time < 0.0, 80e5, burn.values["p_tank"])
    found = calibrated(replace(burn, values={**burn.values, "p_tank": pressed}))
    assert found.quantities["C_i"].value == pytest.approx(burn.stand.C_i, rel=0.01)
    assert found.rest is not None
    assert found.rest.temperature.value is None
    assert "supercharged" in found.warnings[0]


def test_a_mass_that_does_not_fit_the_tank_at_all_is_an_error_of_the_input(burn: Trial) -> None:
    with pytest.raises(InputError, match=r"oxidizer_mass and volume: found 18\.00 kg in 16\.5 L; expected no more"):
        calibrated(burn, mass=Value(18.0, 0.1))


def test_a_mass_off_by_kilograms_is_seen_by_the_blowdown(burn: Trial) -> None:
    found = calibrated(burn, mass=Value(7.0, 0.05))
    assert any("the blowdown fits 9.9 kg, not 7.0 kg" in w for w in found.warnings)


# --- which mass -------------------------------------------------------------------------------------------------------


def test_the_stated_mass_comes_first_and_a_scale_that_disagrees_is_named(burn: Trial) -> None:
    found = calibrated(burn, scale=scale_of(burn, 8.5), accuracy=0.02)
    assert worked_with(found) == pytest.approx(MASS, rel=1e-12)
    assert "loaded mass: 10.000 +/- 0.020 kg as stated" in found.notes
    assert any("the load cell reads 8.50 kg at rest" in w for w in found.warnings)


def test_a_mass_stated_without_a_deviation_counts_as_known_to_one_per_cent(burn: Trial) -> None:
    assert "loaded mass: 10.000 +/- 0.100 kg as stated" in calibrated(burn, mass=Value(MASS)).notes


def test_without_a_stated_mass_the_scale_weighs_it(burn: Trial) -> None:
    found = calibrated(burn, scale=scale_of(burn, 9.9), mass=None, accuracy=0.05)
    assert worked_with(found) == pytest.approx(9.9, abs=1e-3)
    assert any("9.900 +/- 0.050 kg from the load cell" in n for n in found.notes)


def test_without_either_the_blowdown_itself_weighs_it(burn: Trial) -> None:
    found = calibrated(burn, mass=None)
    assert worked_with(found) == pytest.approx(MASS, rel=0.02)
    assert any("from the blowdown itself" in n for n in found.notes)
    c = found.quantities["C_i"]
    assert c.value == pytest.approx(burn.stand.C_i, rel=0.03)
    assert c.std is not None
    assert c.std > 0.05 * burn.stand.C_i


def test_an_empty_scale_weighs_nothing(burn: Trial) -> None:
    found = calibrated(burn, scale=scale_of(burn, -0.3), mass=None)
    assert any("from the blowdown itself" in n for n in found.notes)
