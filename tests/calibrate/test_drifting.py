"""An injector that drifts moves n; what the log tells of its course, and what is believed without one."""

from __future__ import annotations

import numpy as np
import pytest
from tests.calibrate.engine_sample import TRUTH, evidence

from hfanalysis.calibrate.course import Course
from hfanalysis.calibrate.drifting import USUAL, by_drift, drift_std
from hfanalysis.calibrate.evidence import NUISANCES
from hfanalysis.calibrate.law_errors import LawErrors
from hfanalysis.calibrate.regression import fit
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.quantity import CONDITIONAL


def course(drift: float, std: float) -> Course:
    """Of C_i [1/s]."""
    return Course(drift, std, 0.0, 10.0, 10.0, 8)


def test_without_a_course_the_usual_drift_is_believed() -> None:
    assert drift_std(None, 0.3, 6.0) == USUAL


@pytest.mark.parametrize(
    ("seen", "std", "believed"),
    [(0.0, 1e-6, 0.0), (0.04, 1e-6, 0.04), (0.0, 10.0, USUAL), (0.04, 0.05, np.hypot(0.02, 0.05 / np.sqrt(2.0)))],
)
def test_what_is_believed_of_a_drift_is_between_what_is_usual_and_what_is_seen(
    seen: float, std: float, believed: float
) -> None:
    """Relative changes over 6 s of a C_i of 0.3; normal prior and measurement by hand."""
    per_second = 0.3 / 6.0
    assert drift_std(course(seen * per_second, std * per_second), 0.3, 6.0) == pytest.approx(believed, abs=1e-4)


def test_a_drift_that_no_injector_has_is_the_balances() -> None:
    """A third, to a hundredth: the tank is stratified."""
    assert drift_std(course(0.33 * 0.05, 0.01 * 0.05), 0.3, 6.0) == USUAL


def test_a_drift_moves_n_by_what_the_law_is_told_for_it() -> None:
    """The log of an injector that drifts by 2 %, fitted without one."""
    plain = evidence(noise=0.01e5)
    lasts = 6.0
    drifting = plain.moved(by_drift(plain, TRUTH.a, TRUTH.n, 0.02, lasts))
    before, after = fit(plain), fit(drifting)
    law = result(before)
    wider = LawErrors(before, np.zeros((len(NUISANCES),) * 2)).drifting(law, 0.02, lasts).n
    moved = abs(after.law.n - before.law.n)
    assert moved > 2.0 * (law.n.std or 0.0)
    assert np.sqrt((wider.std or 0.0) ** 2 - (law.n.std or 0.0) ** 2) == pytest.approx(moved, rel=0.35)


def test_an_n_that_hangs_on_it_is_conditional() -> None:
    found = fit(evidence(noise=0.01e5))
    told = LawErrors(found, np.zeros((len(NUISANCES),) * 2)).drifting(result(found), 0.05, 6.0)
    assert told.n.verdict == told.a.verdict == CONDITIONAL
    assert "a C_i that drifts by 5 % while the liquid lasts moves n by" in str(told.n.why)
