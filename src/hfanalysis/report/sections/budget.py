"""What the standard deviations are made of: the uncertainty budgets of the test's products."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hfanalysis.errors import AbsentError
from hfanalysis.products.budgets import Made, made_of
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.flight import Flight
from hfanalysis.products.validation import Validation
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.names import plain
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words

_CAPTION = (
    "Shares of the variance (ASME PTC 19.1, GUM). Systematic: what would be the same in a repeated test; correlated "
    "inputs are one row."
)
_COLUMNS = ("quantity", ">value", ">systematic", ">random", ">share", "input")


def render(material: Material) -> Iterator[Block]:
    """A row for every input of every quantity that has a budget."""
    products = (material.get(Calibration), material.get(Validation), material.get(Flight))
    found = made_of(product for product in products if product is not None)
    if not found:
        raise AbsentError("no quantity of this test has a budget")
    yield html.table("Uncertainty budget", _CAPTION, _COLUMNS, (row for made in found for row in _rows(made)))


def _rows(made: Made) -> Iterator[tuple[Any, ...]]:
    shares = {**made.budget.shares, **({"not linear": made.budget.non_linear} if made.budget.non_linear else {})}
    unit = made.quantity.unit
    head: tuple[Any, ...] = (
        in_words(made.name), html.value(made.quantity, made.name), html.amount(made.budget.systematic, unit, 2, True),
        html.amount(made.budget.random, unit, 2, True),
    )  # fmt: skip
    for name, share in shares.items():
        yield (*head, f"{100.0 * share:.1f} %", plain(name))
        head = ("",) * len(head)


SECTION = Section("Uncertainty budget", 82, (), render, folded=True)
