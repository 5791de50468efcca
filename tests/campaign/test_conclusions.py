"""What the tests of a stand say together, in sentences."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.campaign.rows import made
from tests.report.prose import words_of

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.page import page
from hfanalysis.products.campaign import Campaign, ParameterRow, Together
from hfanalysis.quantity import Quantity


@pytest.fixture
def product(tmp_path: Path) -> Campaign:
    return made(tmp_path)


def said(product: Campaign) -> list[str]:
    return conclusions(product.stands["cell 3"], product.tests)


def with_holes(product: Campaign, c_i: tuple[float, float, float]) -> Campaign:
    """The same with injectors of three areas."""
    rows = dict(product.tests)
    for test, area, value in zip("ABC", (1e-5, 2e-5, 3e-5), c_i, strict=True):
        calibration = {**rows[test].calibration, "C_i": Quantity(value, "", 0.002)}
        rows[test] = rows[test].but(injector_area=area, calibration=calibration)
    return product.but(tests=rows)


def test_what_agrees_and_what_differs_is_said(product: Campaign) -> None:
    same, apart, *_ = said(product)
    assert same == "The same feed loss coefficient in all 3 tests, within their deviations."
    assert apart == "The effective injector coefficient differs: 0.3000 ± 0.0020 in A, 0.3800 ± 0.0020 in C."


def test_an_effect_that_only_some_have_is_told(product: Campaign) -> None:
    assert "Heat into the tank is named in A and B, and not in C." in said(product)


def test_an_effect_that_is_far_larger_in_one_test_asks_to_be_looked_at(product: Campaign) -> None:
    stand = product.stands["cell 3"]
    heat = stand.effects["tank_heat"]
    row = heat.parameters["power"]
    assert row.together.agreement is not None
    by_test = {"A": Quantity(900.0, "W", 20.0), "B": Quantity(1800.0, "W", 20.0)}
    apart = Together(mean=row.together.mean, agreement=row.together.agreement.but(probability=1e-6), tests=("A", "B"))
    power = ParameterRow(by_test=by_test, together=apart)
    other = stand.but(effects={"tank_heat": heat.but(parameters={"power": power})})
    told = conclusions(other, product.tests)
    assert "Heat into the tank: its power in B is 2.0 times that in A; look at what changed." in told
    assert not any("look at" in sentence for sentence in said(product))


@pytest.mark.parametrize(
    ("c_i", "words"),
    [
        ((0.25, 0.27, 0.29), "C_i rises with the area of the holes: it is no property of the hole."),
        ((0.29, 0.27, 0.25), "C_i falls with the area of the holes: it is no property of the hole."),
        ((0.25, 0.31, 0.29), "C_i differs between the injectors, but not with the area of their holes."),
        ((0.27, 0.27, 0.271), "Injectors of other hole areas have the same C_i: A, B and C."),
    ],
)
def test_whether_the_injector_goes_with_its_holes(
    c_i: tuple[float, float, float], words: str, product: Campaign
) -> None:
    assert words in said(with_holes(product, c_i))


def test_of_one_test_nothing_is_concluded(product: Campaign) -> None:
    assert conclusions(product.stands["cell 3"].but(tests=("A",)), product.tests) == []


def test_the_page_says_them_in_short_sentences(product: Campaign) -> None:
    text = page(product)
    for sentence in said(product):
        assert sentence in text
        assert words_of(sentence) <= 25
