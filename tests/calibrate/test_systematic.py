"""What is off in every repetition alike: it widens intervals by what it is worth, all constants together, and moves
nothing."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import log
from typing import Any

import numpy as np
import pytest
from tests.calibrate.engine_sample import engine, evidence
from tests.segment.stand import EXACT, HOLE_AREA, HOLES, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.course import Course, with_course, with_drift
from hfanalysis.calibrate.evidence import NUISANCES
from hfanalysis.calibrate.law_errors import LawErrors
from hfanalysis.calibrate.regression import Fitted, fit
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import CoefficientHistory, TankConstants
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.record.default_deviations import Deviation, Deviations
from hfanalysis.record.sections import Injector
from hfanalysis.units import Value

SAMPLES = 60
NAMES = ("C_i", "m", "K_loss", "m_choked", "vapor_C_d", "vapor_mass_at_t_v")


@cache
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(**change: Any) -> TankConstants:
    stated = definition(burn().stand, **({"mass": Value(burn().stand.mass, 0.0)} | change))
    return calibrate(log_of(burn(), accuracy=1.0), segments_of(burn()), stated, SAMPLES).constants


@cache
def exact() -> TankConstants:
    """All of it stated, and exact."""
    return calibrated()


def stds(found: TankConstants) -> dict[str, float]:
    return {name: found.quantities[name].std or 0.0 for name in NAMES}


UNSTATED = {
    "volume": (
        {"volume": Value(16.5e-3, 0.02 * 16.5e-3)},
        {"volume": Value(16.5e-3), "deviations": replace(EXACT, tank_volume=Deviation(share=0.02))},
    ),
    "holes": (
        {"injector": Injector(HOLES, Value(HOLE_AREA, 0.04 * HOLE_AREA))},
        {"injector": Injector(HOLES, Value(HOLE_AREA)), "deviations": replace(EXACT, hole_diameter=Deviation(0.02))},
    ),
}
"""A deviation that is stated, and the same as a default."""


@pytest.mark.parametrize(("stated", "default"), UNSTATED.values(), ids=UNSTATED)
def test_a_default_is_worth_what_the_same_deviation_is_where_it_is_stated(
    stated: dict[str, Any], default: dict[str, Any]
) -> None:
    one, other = calibrated(**stated), calibrated(**default)
    for name in NAMES:
        assert other.quantities[name].value == one.quantities[name].value, name
        assert stds(other)[name] == pytest.approx(stds(one)[name], rel=0.35, abs=2e-4 * abs(one.quantities[name].value))


def test_an_interval_holds_what_the_other_table_has() -> None:
    open_, other = calibrated(deviations=Deviations(line_volume=Deviation())), calibrated(model=other_model())
    for name in ("C_i", "m", "Z", "vapor_mass_at_t_v"):
        low, high = open_.quantities[name].interval or (0.0, 0.0)
        told = other.quantities[name].value
        assert told is not None
        assert low < told < high
        narrow = exact().quantities[name].interval or (0.0, 0.0)
        assert not narrow[0] < told < narrow[1]


def other_model() -> Any:
    return replace(definition().model, properties="report")


def test_a_long_line_leaves_the_vapor_open() -> None:
    """One tenth of the volume: the tank's vapor is a tenth less, and expands before t_v."""
    sure, long = exact(), calibrated(deviations=replace(EXACT, line_volume=Deviation(share=0.1)))
    vapor = long.vapor_mass_at_t_v
    assert vapor.value is not None
    assert 0.005 < (vapor.std or 0.0) / vapor.value < 0.1 / np.sqrt(3.0)
    for name in ("C_i", "m", "K_loss"):
        assert stds(long)[name] > 3.0 * stds(sure)[name], name
    assert stds(long)["C_i"] * vapor.value == pytest.approx(  # what is not vapor has left as liquid
        (long.C_i.value or 0.0) * (vapor.std or 0.0) * vapor.value / (burn().stand.mass - vapor.value), rel=0.1
    )


def test_holes_that_are_not_known_leave_the_flow_as_it_is() -> None:
    """The joint errors are those of C_i N_i A_i."""
    sure = exact()
    wide = calibrated(injector=Injector(HOLES, Value(HOLE_AREA)))
    assert (wide.C_i.std or 0.0) > 10.0 * (sure.C_i.std or 0.0)
    assert wide.joint is not None
    assert sure.joint is not None
    assert wide.joint.std == pytest.approx(sure.joint.std, rel=1e-6)


def history(value: Any, std: float = 0.01) -> CoefficientHistory:
    time = 1.0 + 0.25 * np.arange(16)
    return CoefficientHistory(
        time=tuple(time), value=tuple(np.broadcast_to(value(time), time.shape)), std=(std,) * time.size
    )


def test_a_drift_is_told_with_its_chi_squares_and_is_worth_what_the_mean_by_flow_is_off() -> None:
    course = with_drift(history(lambda t: 0.3 + 0.02 * (t - 3.0)))
    assert course.drift is not None
    assert course.drift.value == pytest.approx(0.02)
    assert "about a straight line" in str(course.drift.why)
    time = np.linspace(0.0, 6.0, 100)
    flow = 2.0 - time / 6.0
    told = with_course(Quantity(0.3, "", 1e-4, verdict=IDENTIFIED), 1e-4, course, time, flow)
    by_flow, by_time = np.trapezoid((0.3 + 0.02 * time) * flow, time) / np.trapezoid(flow, time), 0.3 + 0.02 * 3.0
    assert told.std == pytest.approx(abs(by_flow - by_time), rel=0.05)
    assert "drifts by +0.020 /s" in str(told.why)


def test_a_scatter_without_a_course_takes_the_errors_of_the_log_so_many_times() -> None:
    scattered = history(lambda t: 0.3 + 0.03 * (-1.0) ** np.arange(t.size))
    told = with_course(Quantity(0.3, "", 2e-3, verdict=IDENTIFIED), 1e-3, scattered, np.arange(3.0), np.ones(3))
    assert Course.of(scattered).scatter == pytest.approx(3.0, rel=0.05)  # type: ignore[union-attr]
    assert told.std == pytest.approx(np.sqrt(3e-6 + 9e-6), rel=0.05)  # 2e-3 of which 1e-3 by the log, now three times
    quiet = history(lambda t: 0.3 + 0.005 * (-1.0) ** np.arange(t.size))
    plain = Quantity(0.3, "", 2e-3, verdict=IDENTIFIED)
    assert with_course(plain, 1e-3, quiet, np.arange(3.0), np.ones(3)) == plain


@cache
def fitted() -> Fitted:
    return fit(evidence())


def test_a_and_n_follow_what_they_were_fitted_with() -> None:
    """A fit with another injector moves as its response says, and so does what is told of their joint errors."""
    found, step = fitted(), 0.001 * engine().feed.area
    std = np.array([step if name == "area" else 0.0 for name in NUISANCES])
    errors = LawErrors(found, np.diag(std**2))
    seen = evidence()
    wider = replace(seen.engine.feed, area=seen.engine.feed.area + step)
    again = fit(replace(seen, engine=replace(seen.engine, feed=wider)))
    moved = np.array([rate_at(again, found.flux) - found.best[0], again.best[1] - found.best[1]])
    response = errors._response[:, NUISANCES.index("area")]
    assert response == pytest.approx(moved, rel=0.2)

    law = result(found)
    told = errors.told(law)
    assert told.n.value == law.n.value
    assert (told.n.std or 0.0) ** 2 == pytest.approx((law.n.std or 0.0) ** 2 + response[1] ** 2, rel=0.01)
    joint = told.joint
    assert joint is not None
    place = {name: i for i, name in enumerate(joint.names)}
    covariance = (
        joint.correlation[place["flow_area"]][place["n"]] * joint.std[place["flow_area"]] * joint.std[place["n"]]
    )
    assert covariance == pytest.approx(step * response[1], rel=1e-3)


def rate_at(found: Fitted, flux: float) -> float:
    """ln of the rate at a flux."""
    return float(found.best[0] + found.best[1] * log(flux / found.flux))


def test_errors_that_the_fit_has_weighed_by_widen_nothing() -> None:
    found = fitted()
    law = result(found)
    told = LawErrors(found, found.evidence.covariance).told(law)
    assert told.quantities == law.quantities


def test_a_coefficient_that_is_rounded_to_nothing_has_no_course() -> None:
    """Holes stated in square metres: C_i of some 1e-7."""
    nothing = history(lambda t: 0.0 * t, std=0.0)
    assert Course.of(nothing) is None
    assert with_drift(nothing).drift is None
