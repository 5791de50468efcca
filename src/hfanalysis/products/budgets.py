"""The budgets of several products, each with the quantity whose deviation it is of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hfanalysis.products.budget import Budget
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.flight import Flight
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity


@dataclass(frozen=True)
class Made:
    """A quantity with its budget and the product that has both."""

    name: str
    quantity: Quantity
    budget: Budget
    product: str


def made_of(products: Iterable[Calibration | Validation | Flight]) -> list[Made]:
    """All budgets of the products, in their order."""
    found = []
    for product in products:
        own = _quantities(product)
        found += [Made(n, own[n], b, product.file) for n, b in product.budget.items() if n in own]
    return found


def _quantities(product: Calibration | Validation | Flight) -> dict[str, Quantity]:
    if not isinstance(product, Validation):
        return product.quantities
    ratios = product.efficiencies.quantities if product.efficiencies is not None else {}
    return product.performance.measured.quantities | ratios
