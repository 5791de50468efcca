"""On what a law holds, by hand and on burns whose law is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.calibrate.engine_sample import evidence

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.conditions import conditioned, conditions, variance_of_n
from hfanalysis.calibrate.fuel_law import _conditional
from hfanalysis.calibrate.regression import fit
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.quantity import CONDITIONAL, DOUBTED, IDENTIFIED, UNPHYSICAL, Quantity

WINDOW = (120.0, 500.0)


def at(rate: float, n: float, flux: float = 200.0) -> Regression:
    """The law with this rate [mm/s] at a flux."""
    return Regression(1e-3 * rate / flux**n, n)


@pytest.mark.parametrize(
    ("law", "flux", "said"),
    [
        (at(2.2, 0.5), 200.0, []),
        (at(2.2, 0.2), 200.0, ["n is outside what paraffin is known for, 0.4 to 0.8 [Karabeyoglu 2004"]),
        (at(2.2, 0.9), 200.0, ["n is outside"]),
        (at(0.6, 0.5), 200.0, ["a is outside what paraffin is known for: 0.60 mm/s at 200"]),
        (at(9.0, 0.5), 200.0, ["a is outside"]),
        (at(2.2, 0.5), 100.0, ["the rate is known best at a flux of 100 kg/(m^2 s), outside the 120 to 500"]),
        (at(0.6, 0.1), 200.0, ["n is outside", "a is outside"]),
    ],
)  # fmt: skip
def test_what_a_law_holds_on(law: Regression, flux: float, said: list[str]) -> None:
    found = list(conditions(law, flux, WINDOW))
    assert len(found) == len(said)
    assert all(told.startswith(words) for told, words in zip(found, said, strict=True))


def test_only_what_is_identified_becomes_conditional() -> None:
    """An n outside the range is not unphysical for that, and what is not told apart stays so."""
    assert conditioned((IDENTIFIED, "w"), (0.1, 0.2), ["n is outside"]) == (CONDITIONAL, "n is outside")
    assert conditioned((IDENTIFIED, "w"), (0.4, 0.5), []) == (IDENTIFIED, "w")
    assert conditioned((UNPHYSICAL, "w"), (1.2, 1.3), ["n is outside"]) == (UNPHYSICAL, "w")
    assert "n's 95 % interval holds zero" in conditioned((IDENTIFIED, "w"), (-0.02, 0.1), ["n is outside"])[1]


def test_the_variance_of_n_is_that_of_a_line() -> None:
    """Of a slope by n equally sure points: s^2 over the sum of squares about their mean."""
    x = np.array([-1.0, 0.0, 1.0, 4.0])
    slopes = np.column_stack([np.ones(4), x])
    assert variance_of_n(slopes, 0.09 * np.eye(4)) == pytest.approx(0.09 / np.sum((x - x.mean()) ** 2))
    assert variance_of_n(np.ones((4, 2)), np.eye(4)) == np.inf


def test_a_burn_time_on_vapor_that_carries_the_fit_is_a_condition() -> None:
    """The burn ends two seconds after the liquid. Pressures of little noise tell n without it; of much they do not."""
    fine, rough = (result(fit(evidence(noise=noise, burn_time_std=0.05))).n for noise in (0.01e5, 0.2e5))
    assert fine.verdict == IDENTIFIED
    assert rough.verdict == CONDITIONAL
    assert "the burn time carries the fit" in str(rough.why)
    assert "a trickle of vapor sets it" in str(rough.why)


def test_a_doubt_of_the_injector_is_worse_than_a_condition() -> None:
    law = result(fit(replace(evidence(Regression(3.2e-4, 0.3)), burn_time=None)))
    assert law.n.verdict == CONDITIONAL
    doubted = _conditional(law, Quantity(0.3, "", 0.01, verdict=DOUBTED, why="p_run may be off"))
    assert doubted.n.verdict == DOUBTED
    assert str(doubted.n.why).startswith("p_run may be off; n is outside")
