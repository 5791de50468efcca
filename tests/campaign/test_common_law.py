"""One regression law of several tests, from the law of each."""

from __future__ import annotations

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.products.filled import filled

from hfanalysis.campaign.common_law import common_law, counts
from hfanalysis.campaign.words import regression_sentence
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import UNIT_OF_FLUX, FuelLaw
from hfanalysis.quantity import CONDITIONAL, DOUBTED, IDENTIFIED, NOT_IDENTIFIABLE, Quantity

A, N = 1.1e-4, 0.55


def law(
    flux: float, off: float = 0.0, n: float = N, rate_std: float = 0.02, n_std: float = 0.03, verdict: str = IDENTIFIED
) -> FuelLaw:
    """A test's law: its rate at a flux [kg/m^2/s] off by a share, and n."""
    rate = A * flux**N * exp(off)
    return filled(FuelLaw, {
        "a": Quantity(rate / flux**n, "SI", 1e-5, verdict=verdict),
        "n": Quantity(n, "", n_std, verdict=verdict, why="w"),
        "regression_rate_reference": Quantity(rate, "m/s", rate * rate_std, verdict=IDENTIFIED),
        "regression": {"reference_flux": Quantity(flux, UNIT_OF_FLUX).to_json(), "tests": []},
    })  # fmt: skip


def test_tests_at_other_fluxes_tell_n_between_them_where_none_does_alone() -> None:
    """ln r over ln G, by hand: from 100 to 400 with 2 % each at either end, n to 0.02 sqrt(2) / ln 4 = 0.020."""
    found = common_law({
        "T1": law(100.0, n=0.3, n_std=0.8, verdict=NOT_IDENTIFIABLE),
        "T2": law(400.0, n=0.8, n_std=0.8, verdict=NOT_IDENTIFIABLE),
    })  # fmt: skip
    assert found.n.value == pytest.approx(N, abs=1e-3)
    assert found.n.std == pytest.approx(0.02 * 2**0.5 / log(4.0), rel=0.01)
    assert found.a.value == pytest.approx(A, rel=1e-2)
    assert found.n.verdict == IDENTIFIED
    assert found.agreement.verdict == "agree"


def test_two_of_another_fuel_disagree() -> None:
    found = common_law({"T1": law(200.0), "T2": law(210.0, off=0.2)})
    assert found.agreement.verdict.startswith("disagree")
    assert found.odd is None  # of two it is open which one it is


def test_one_of_another_fuel_is_named_by_its_rate_at_one_flux() -> None:
    """Of one law at several fluxes all rates are the same there; a tenth more is a tenth more."""
    laws = {f"T{i}": law(150.0 + 30.0 * i, rate_std=0.01) for i in range(5)}
    found = common_law({**laws, "X": law(205.0, log(1.1), rate_std=0.01)})
    assert found.odd is not None
    assert found.odd.test == "X"
    assert found.flux is not None
    assert found.odd.apart.value == pytest.approx(0.1 * A * found.flux**N, rel=0.01)


def test_a_test_counts_as_far_as_its_interval_reaches() -> None:
    """One whose interval is far wider than its deviation moves the law by little."""
    narrow = law(205.0, log(1.2))
    own = narrow.regression_rate_reference
    value = own.value or 0.0
    wide = narrow.but(regression_rate_reference=replace(own, ci95=(0.5 * value, 2.0 * value)))
    laws = {f"T{i}": law(150.0 + 30.0 * i) for i in range(4)}
    moved = [common_law({**laws, "X": x}).regression_rate_reference.value or 0.0 for x in (narrow, wide)]
    level = common_law(laws).regression_rate_reference.value or 0.0
    assert abs(moved[1] - level) < 0.1 * abs(moved[0] - level)


def test_tests_that_scatter_have_a_wider_interval_than_they_state() -> None:
    level = common_law({f"T{i}": law(150.0 + 20.0 * i) for i in range(6)})
    apart = common_law({f"T{i}": law(150.0 + 20.0 * i, off=0.1 * (-1) ** i) for i in range(6)})
    assert (apart.regression_rate_reference.std or 0.0) > 3.0 * (level.regression_rate_reference.std or 1.0)


def test_what_a_test_holds_on_the_law_of_all_holds_on() -> None:
    found = common_law({"T1": law(200.0), "T2": law(250.0, verdict=CONDITIONAL)})
    assert found.n.verdict == CONDITIONAL
    assert found.n.why == "as 1 of 2 tests have it; T2: w"


def test_the_sentence_of_a_law_says_on_what_it_holds() -> None:
    sure = common_law({"T1": law(200.0), "T2": law(250.0)})
    held = common_law({"T1": law(200.0), "T2": law(250.0, verdict=CONDITIONAL)})
    apart = common_law({f"T{i}": law(200.0 + i, n_std=0.9, verdict=NOT_IDENTIFIABLE) for i in range(2)})
    assert "conditional" not in regression_sentence(sure)
    assert ", conditional: as 1 of 2 tests have it; T2: w." in regression_sentence(held)
    assert ", not identifiable: a and n are not told apart" in regression_sentence(apart)
    many = common_law({f"T{i}": law(150.0 + i) for i in range(40)})
    assert regression_sentence(many).startswith("One regression law for all 40 tests: a = (")


def test_a_doubted_law_counts_for_nothing() -> None:
    assert not counts(law(200.0, verdict=DOUBTED))
    assert not counts(FuelLaw.absent("no firing"))
    with pytest.raises(AbsentError, match="two tests are needed, and the rate is identified in T1"):
        common_law({"T1": law(200.0), "T2": law(250.0, verdict=DOUBTED)})


def test_five_hundred_are_as_soon_told_as_two() -> None:
    rng = np.random.default_rng(1)
    laws = {
        f"T{i}": law(float(rng.uniform(100.0, 300.0)), 0.02 * rng.standard_normal(), N + 0.03 * rng.standard_normal())
        for i in range(500)
    }
    found = common_law(laws)
    assert found.n.value == pytest.approx(N, abs=4.0 * (found.n.std or 0.0))
    assert (found.n.std or 1.0) < 0.002
    assert found.agreement.verdict == "agree"


@given(st.lists(st.tuples(st.floats(80.0, 500.0), st.floats(-0.05, 0.05)), min_size=2, max_size=6))
def test_the_law_does_not_hang_on_the_order_of_the_tests(drawn: list[tuple[float, float]]) -> None:
    laws = {f"T{i}": law(flux, off) for i, (flux, off) in enumerate(drawn)}
    one, other = common_law(laws), common_law(dict(reversed(laws.items())))
    assert one.n.value == pytest.approx(other.n.value, rel=1e-6)
    assert one.a.std == pytest.approx(other.a.std, rel=1e-6)
    tightest = min(own.n.std or 1.0 for own in laws.values())
    assert one.agreement.verdict != "agree" or (one.n.std or 0.0) < tightest
