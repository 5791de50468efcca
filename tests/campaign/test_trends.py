"""Constants over the conditions of tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.campaign.rows import made

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.page import page
from hfanalysis.campaign.trends import STEADY, trends
from hfanalysis.products.campaign import Campaign, TestRow
from hfanalysis.quantity import Quantity


@pytest.fixture
def product(tmp_path: Path) -> Campaign:
    return made(tmp_path)


def rows(product: Campaign, over: list[float], values: list[float]) -> dict[str, TestRow]:
    """Tests of one injector with C_i = ``values`` at back pressures ``over``."""
    return {
        f"T{i}": product.tests["A"].but(
            injector_area=4e-5, calibration={"C_i": Quantity(value, "", 0.002, verdict="identified")},
            conditions={"back_pressure": Quantity(ratio, "", 0.01)},
        )
        for i, (ratio, value) in enumerate(zip(over, values, strict=True))
    }  # fmt: skip


def found(tests: dict[str, TestRow]) -> dict[str, dict[str, Quantity]]:
    return {"C_i": {t: row.calibration["C_i"] for t, row in tests.items()}, "K_loss": {}, "m": {}}


def test_a_coefficient_that_falls_with_the_back_pressure_is_told_with_what_else_it_may_be(product: Campaign) -> None:
    ratios = [0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7]
    tests = rows(product, ratios, [0.4 - 0.2 * x for x in ratios])
    (one,) = trends(tests, found(tests))
    assert (one.of, one.over) == ("C_i", "back_pressure")
    assert one.slope.value == pytest.approx(-0.2)
    assert one.probability < STEADY
    stand = product.stands["cell 3"].but(tests=tuple(tests), trends=(one,), constants={}, effects={})
    (said,) = conclusions(stand, tests)
    assert said.startswith("C_i falls with the pressure behind the injector over that before it over 7 tests")
    assert said.endswith("or a pressure's sensor moves both.")
    text = page(product.but(tests=tests, stands={"cell 3": stand.but(trends=(one.but(probability=1e-5),))}))
    assert 'aria-label="Trends: table"' in text
    assert '<td class="r">less than 0.001</td>' in text


def test_by_chance_one_is_told_as_rarely_as_stated(product: Campaign) -> None:
    rng = np.random.default_rng(3)
    told = 0
    for _ in range(300):
        tests = rows(product, list(rng.uniform(0.4, 0.7, 8)), list(rng.normal(0.3, 0.01, 8)))
        told += sum(one.probability < STEADY for one in trends(tests, found(tests)))
    assert told <= 15


def test_another_injector_is_no_trend(product: Campaign) -> None:
    """C_i goes with the ratio only because the injector was changed with it."""
    tests = rows(product, [0.4, 0.41, 0.42, 0.43, 0.7, 0.71, 0.72], [0.3, 0.31, 0.29, 0.3, 0.2, 0.21, 0.19])
    changed = {t: row.but(injector_area=8e-5) if i > 3 else row for i, (t, row) in enumerate(tests.items())}
    assert trends(changed, found(changed)) == ()
    assert len(trends(tests, found(tests))) == 1
