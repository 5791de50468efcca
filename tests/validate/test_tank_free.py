"""The tank alone: from the calibrated constants and the measured chamber pressure back to the tank's own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.products.filled import filled
from tests.segment.stand import Stand, Trial, definition, fire, log_of, segments_of

from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.validate.residuals import PHASES, Residual, gaps
from hfanalysis.validate.tank_free import run_tank_free

T_FEED = Quantity(0.4, "s", 0.01)


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=500.0)


def mass_at(test: Trial, time: float) -> float:
    after = test.time >= 0.0
    return float(np.interp(time, test.time[after], test.mass[: after.sum()]))


def true_calibration(test: Trial, **change: Any) -> Calibration:
    """What calibration.json holds where the calibration has found the truth."""
    s = test.stand
    loss = test.values["p_tank"] - test.values["p_run"]
    liquid, vapor = (
        float(loss[(test.time >= a) & (test.time < b)].mean()) for a, b in ((0.4, test.t_v), (test.t_v, test.t_purge))
    )
    values = {"C_i": s.C_i, "m": s.m, "K_loss": s.K_loss, "p_loss_liquid": liquid, "p_loss_vapor": vapor}
    values["mass_at_t_feed"] = mass_at(test, 0.4)
    return filled(Calibration, {name: Quantity(value) for name, value in values.items()} | change)


def run(test: Trial, calibration: Calibration | None = None, white: float = 0.0, **change: Any) -> Residual:
    without = change.pop("without", ())
    log = log_of(test, white=white, without=without)
    segments = segments_of(test, t_feed=T_FEED)
    found = run_tank_free(log, segments, calibration or true_calibration(test), definition(test.stand, **change))
    return found[0]


def test_the_line_follows_with_the_flow(burn: Trial) -> None:
    log, stated = log_of(burn), definition(burn.stand)
    tank, line = run_tank_free(log, segments_of(burn, t_feed=T_FEED), true_calibration(burn), stated)
    assert (tank.channel, line.channel) == ("p_tank", "p_run")
    assert np.abs(part(line, "liquid")).max() < 0.1e5  # of 35 bar
    assert np.abs(line.model - tank.model).max() > 2e5


def part(found: Residual, name: str) -> np.ndarray[Any, Any]:
    return found.residual[found.phase == PHASES.index(name)]


@pytest.mark.parametrize("stand", [Stand(), Stand(C_i=0.5, m=1.25, source="report")], ids=["coolprop", "report"])
def test_true_constants_leave_no_residual_until_nitrogen_enters(stand: Stand) -> None:
    found = run(fire(stand, rate=500.0))
    assert found.time[0] >= 0.4
    for name in ("liquid", "vapor"):
        assert part(found, name).size > 200
        assert np.abs(part(found, name)).max() < 0.03e5  # of 40 bar
    assert part(found, "nitrogen").mean() > 0.3e5  # nitrogen is what the tank alone does not have


def test_a_residual_has_the_sign_of_the_measurement(burn: Trial) -> None:
    high = replace(burn, values={**burn.values, "p_tank": burn.values["p_tank"] + 2e5 * (burn.time > 2.0)})
    found = run(high)
    late = (found.time > 2.0) & (found.time < burn.t_v)
    assert found.residual[late].mean() == pytest.approx(2e5, rel=0.05)


def test_noise_is_that_of_a_sample_and_shows_as_the_floor_of_the_gap(burn: Trial) -> None:
    found = run(burn, white=2e4)
    gap = gaps([found])["p_tank"]["liquid"]
    assert gap.noise == pytest.approx(2e4, rel=0.1)
    assert gap.rms == pytest.approx(2e4, rel=0.3)
    assert found.unit == "Pa"


def test_a_C_i_that_is_too_small_empties_the_tank_too_late(burn: Trial) -> None:
    found = run(burn, true_calibration(burn, C_i=Quantity(0.9 * burn.stand.C_i)))
    assert part(found, "vapor").mean() < -2e5


def test_the_reports_conventions_take_constant_losses(burn: Trial) -> None:
    """The mean loss is not the loss at each instant: the same calibration leaves more behind, but not much."""
    quadratic, constant = run(burn), run(burn, conventions="report")
    size = [float(np.abs(part(r, "vapor")).max()) for r in (quadratic, constant)]
    assert size[1] > 3.0 * size[0]
    assert np.abs(part(constant, "liquid")).max() < 1.5e5


def test_without_an_m_the_run_ends_with_the_liquid(burn: Trial) -> None:
    missing = true_calibration(burn, m=Quantity.absent("nitrogen"))
    found = run(burn, missing)
    assert found.time[-1] == pytest.approx(burn.t_v, abs=0.05)
    assert found.notes == ("m is not identified: the tank-alone run ends with the liquid",)
    assert run(burn).notes == ()


def test_without_a_C_i_there_is_no_model_to_run(burn: Trial) -> None:
    missing = true_calibration(burn, C_i=Quantity.absent("p_run is not above p_chamber"))
    with pytest.raises(AbsentError, match=r"test T: no tank model to run: C_i is missing \(p_run is not above"):
        run(burn, missing)


def test_a_negative_C_i_runs_nothing(burn: Trial) -> None:
    negative = true_calibration(burn, C_i=Quantity(-0.1, why="less than the vapor left"))
    with pytest.raises(AbsentError, match="C_i is not positive"):
        run(burn, negative)


def test_a_mass_that_does_not_fit_at_that_pressure_runs_nothing(burn: Trial) -> None:
    overfull = true_calibration(burn, mass_at_t_feed=Quantity(14.0))
    with pytest.raises(AbsentError, match=r"the tank cannot be saturated at 0\.40 s: 14\.00 kg do not fit 16\.5 L"):
        run(burn, overfull)


def test_a_log_that_ends_before_t_feed_runs_nothing(burn: Trial) -> None:
    keep = burn.time < 0.401
    short = replace(burn, time=burn.time[keep], values={n: v[keep] for n, v in burn.values.items()})
    with pytest.raises(AbsentError, match="too few good samples of p_tank after t_feed"):
        run(short, true_calibration(burn))


def test_without_a_chamber_pressure_the_tank_empties_against_the_air() -> None:
    cold = fire(Stand(chamber=0.0), rate=500.0)
    found = run(cold, without=("p_chamber",))
    assert np.abs(part(found, "liquid")).max() < 0.03e5
