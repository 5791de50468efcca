"""What is not logged is estimated where it can be, and then every number that rests on it says so."""

from __future__ import annotations

from typing import Any

import pytest
from tests.segment.stand import Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.feed_loss import USUAL_SHARE
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.engine.tank import split
from hfanalysis.products.calibration import TankConstants
from hfanalysis.quantity import CONDITIONAL, DERIVED, NOT_IDENTIFIABLE
from hfanalysis.record.sections import Feed, Tank
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

STAND = Stand()


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(test: Trial, without: tuple[str, ...] = (), **change: Any) -> TankConstants:
    log = log_of(test, white=1e3, without=without)
    return calibrate(log, segments_of(test), definition(test.stand, **change), 100).constants


def test_without_the_run_lines_pressure_its_loss_is_estimated_and_said(burn: Trial) -> None:
    found = calibrated(burn, ("p_run",))
    for name in ("C_i", "K_loss", "p_loss_liquid", "oxidizer_flow_peak"):
        quantity = found.quantities[name]
        assert quantity.verdict == CONDITIONAL, name
        assert "p_run is not logged: the feed line is taken to lose 25 +/- 12 %" in (quantity.why or "")
    assert found.C_i.interval is not None
    assert found.C_i.interval[0] < STAND.C_i < found.C_i.interval[1]
    assert found.m.verdict == NOT_IDENTIFIABLE
    assert any("p_run is not logged" in warning for warning in found.warnings)


def test_a_stated_loss_tells_more_than_what_lines_usually_lose(burn: Trial) -> None:
    found = calibrated(burn, ("p_run",), feed=Feed(K_loss=Value(STAND.K_loss)))
    assert found.C_i.value == pytest.approx(STAND.C_i, rel=0.05)
    assert (found.C_i.std or 1.0) < (calibrated(burn, ("p_run",)).C_i.std or 0.0)
    assert "from [feed] K_loss" in (found.C_i.why or "")


def test_what_lines_lose_covers_both_replicas() -> None:
    assert USUAL_SHARE.std is not None
    for share in (0.20, 0.33):
        assert abs(share - USUAL_SHARE.value) < 1.96 * USUAL_SHARE.std


def test_a_tank_that_nobody_weighed_holds_what_its_fill_says(burn: Trial) -> None:
    source = saturation()
    parts = split(source, STAND.volume, STAND.mass, STAND.temperature)
    ullage = STAND.volume * float(source.liquid_density(STAND.temperature)) / parts.liquid - 1.0
    tank = Tank(Value(STAND.volume), temperature=Value(STAND.temperature), ullage=Value(ullage, 0.01))
    found = calibrated(burn, tank=tank)
    assert found.oxidizer_mass.verdict == DERIVED
    assert found.oxidizer_mass.value == pytest.approx(STAND.mass, rel=1e-3)
    assert "volume and ullage" in (found.oxidizer_mass.why or "")
    assert found.C_i.value == pytest.approx(STAND.C_i, rel=0.01)
