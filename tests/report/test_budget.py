"""The folded table of budgets, and what hfa budget makes of the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from tests.report.sample import material

from hfanalysis.cli.budget import headline, rows
from hfanalysis.errors import AbsentError
from hfanalysis.products.budget import Budget
from hfanalysis.products.budgets import made_of
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.validation import Validation
from hfanalysis.report.material import Material
from hfanalysis.report.sections.budget import SECTION

OF_C_I = Budget(systematic=0.004, random=0.003, shares={"injector holes": 0.6, "phase times": 0.397}, non_linear=0.003)
OF_IMPULSE = Budget(systematic=150.0, random=0.0, shares={"load cell: gain": 1.0}, non_linear=0.0)


@pytest.fixture
def made(tmp_path: Path) -> Material:
    """The sample's products with budgets of two of their quantities."""
    sample = material(tmp_path)
    found = (sample.need(Calibration).but(budget={"C_i": OF_C_I}),
             sample.need(Validation).but(budget={"total_impulse": OF_IMPULSE, "not there": OF_C_I}))  # fmt: skip
    return replace(sample, products={**sample.products, "calibration": found[0], "validation": found[1]})


def test_the_page_has_a_row_for_every_input(made: Material) -> None:
    (table,) = SECTION.render(made)
    text = str(table)
    assert "injector coefficient" in text
    for words in (
        "60.0 %",
        "injector holes",
        "39.7 %",
        "phase times",
        "0.3 %",
        "not linear",
        "100.0 %",
        "load cell: gain",
    ):
        assert words in text
    assert text.count("injector coefficient") == 1
    assert SECTION.folded


def test_a_test_without_budgets_says_so(tmp_path: Path) -> None:
    with pytest.raises(AbsentError, match="no quantity of this test has a budget"):
        list(SECTION.render(material(tmp_path)))


def test_the_command_collects_what_the_products_have(made: Material) -> None:
    found = made_of((made.need(Calibration), made.need(Validation)))
    assert [(one.name, one.product) for one in found] == [
        ("C_i", "calibration.json"),
        ("total_impulse", "validation.json"),
    ]
    assert rows(found[0]) == [("injector holes", 0.6), ("phase times", 0.397)]
    stated = replace(found[0], quantity=replace(found[0].quantity, std=0.005))
    assert headline(stated).endswith("(64 % of the variance systematic, 36 % random)")
