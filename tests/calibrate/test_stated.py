"""What test.toml states of the constants is held, and what the log says stands beside it."""

from __future__ import annotations

from typing import Any

import pytest
from tests.segment.stand import HOLE_AREA, HOLES, Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.fuel_law import contradiction, held
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import UNIT_OF_FLUX, FuelLaw, RegressionBasis, TankConstants
from hfanalysis.quantity import CONDITIONAL, DERIVED, IDENTIFIED, STATED, Quantity
from hfanalysis.record.sections import Feed, GrainSection, Injector, Tank
from hfanalysis.units import Value
from hfanalysis.validate.tank_free import run_tank_free

STAND = Stand()


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(test: Trial, **change: Any) -> TankConstants:
    return calibrate(log_of(test, white=1e3), segments_of(test), definition(test.stand, **change), 40).constants


def injector(discharge: Value) -> Injector:
    return Injector(HOLES, Value(HOLE_AREA, 0.0), C_i=discharge)


def test_a_stated_C_i_is_held_and_the_log_that_bears_it_out_is_beside(burn: Trial) -> None:
    found = calibrated(burn, injector=injector(Value(STAND.C_i, 0.01)))
    assert (found.C_i.value, found.C_i.std, found.C_i.verdict) == (STAND.C_i, 0.01, STATED)
    assert "the log says 0.3" in (found.C_i.why or "")
    assert not any("but the log says" in w for w in found.warnings)
    assert found.oxidizer_flow_peak.verdict == DERIVED


def test_a_log_that_contradicts_a_stated_constant_says_so_with_both_values(burn: Trial) -> None:
    tank = Tank(Value(STAND.volume), Value(STAND.mass, 0.02), polytropic_exponent=Value(1.3))
    found = calibrated(burn, injector=injector(Value(0.5)), tank=tank, feed=Feed(K_loss=Value(9e8, 1e7)))
    said = [w for w in found.warnings if "but the log says" in w]
    for key, value in (("[injector] C_i", "0.5"), ("[tank] polytropic_exponent", "1.3"), ("[feed] K_loss", "9e+08")):
        assert any(w.startswith(f"{key} states {value}") for w in said), key
    assert (found.m.value, found.K_loss.value) == (1.3, 9e8)


def test_what_is_stated_of_a_constant_goes_into_what_follows(burn: Trial) -> None:
    sure, unsure = (calibrated(burn, injector=injector(Value(STAND.C_i, std))) for std in (1e-3, 0.02))
    for name in ("oxidizer_flow_peak", "K_loss"):
        assert (unsure.quantities[name].std or 0.0) > 2.0 * (sure.quantities[name].std or 0.0)


def test_the_ratio_of_heat_capacities_may_be_stated_in_words(burn: Trial) -> None:
    tank = Tank(Value(STAND.volume), Value(STAND.mass, 0.02), polytropic_exponent="c_p/c_v")
    found = calibrated(burn, tank=tank).m
    assert found.verdict == STATED
    assert 1.3 < (found.value or 0.0) < 2.5  # real vapor near saturation


def test_a_load_that_nobody_weighed_follows_from_a_stated_C_i(burn: Trial) -> None:
    found = calibrated(burn, mass=None, injector=injector(Value(STAND.C_i, 0.01)))
    assert found.oxidizer_mass.verdict == DERIVED
    assert found.oxidizer_mass.value == pytest.approx(STAND.mass, rel=0.02)
    assert "follows from it" in (found.C_i.why or "")


def law(flux: float = 200.0) -> FuelLaw:
    a, n = 1e-4, 0.5
    return FuelLaw(
        a=Quantity(a, "m/s", 0.1 * a, verdict=IDENTIFIED),
        n=Quantity(n, "", 0.05, verdict=IDENTIFIED),
        regression_rate_reference=Quantity(a * flux**n, "m/s", 0.01 * a * flux**n, verdict=IDENTIFIED),
        regression=RegressionBasis(reference_flux=Quantity(flux, UNIT_OF_FLUX)),
    )


def test_a_and_n_are_held_and_one_of_them_alone_gives_the_other() -> None:
    both = held(definition(grain=GrainSection(a=Value(2e-4), n=Value(0.4, 0.01))), law())
    assert (both.a.value, both.n.value, both.a.verdict, both.n.std) == (2e-4, 0.4, STATED, 0.01)
    for stated, other, true in (({"n": Value(0.5)}, "a", 1e-4), ({"a": Value(1e-4)}, "n", 0.5)):
        found = held(definition(grain=GrainSection(**stated)), law()).quantities[other]
        assert found.value == pytest.approx(true, rel=1e-6)
        assert found.verdict == CONDITIONAL


@pytest.mark.parametrize(("a", "says"), [(1e-4, False), (1.01e-4, False), (2e-4, True)])
def test_a_stated_law_whose_rate_is_not_the_logs_is_said(a: float, says: bool) -> None:
    found = contradiction(definition(grain=GrainSection(a=Value(a), n=Value(0.5))), law())
    assert (found is not None) == says
    assert not says or ("2.828 mm/s" in str(found) and "1.414" in str(found))


@pytest.mark.parametrize("missing", [{"tank": None}, {"injector": Injector(C_i=Value(0.3))}])
def test_a_stated_C_i_of_an_engine_that_is_not_stated_is_held_and_runs_no_tank(
    burn: Trial, missing: dict[str, Any]
) -> None:
    stated = definition(burn.stand, **{"injector": injector(Value(0.3)), **missing})
    log, segments = log_of(burn, white=1e3), segments_of(burn)
    found = calibrate(log, segments, stated, 20).constants
    assert (found.C_i.value, found.C_i.verdict) == (0.3, STATED)
    with pytest.raises(AbsentError, match="no tank model to run"):
        run_tank_free(log, segments, found, stated)
