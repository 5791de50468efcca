"""What the deviations of the measured performance are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hfanalysis.inference.budget import Input, by_inputs, relative, total
from hfanalysis.performance.efficiency import Spread
from hfanalysis.products.budget import Budget
from hfanalysis.products.validation import Efficiencies
from hfanalysis.quantity import Quantity

PROPELLANT, CHAMBER, THROAT, OXIDIZER, FUEL = (
    "propellant mass", "p_chamber: zero and span", "throat", "oxidizer flow", "fuel flow"
)  # fmt: skip
"""Rows of budgets."""


def budgets(measured: Mapping[str, Quantity], impulse: Sequence[Input]) -> dict[str, Budget]:
    """By name, of the total impulse and of what follows from it.

    Args:
        measured: the measured column of the performance table.
        impulse: what the total impulse may be off by [N s].
    """
    whole = measured["total_impulse"]
    found = {"total_impulse": by_inputs(impulse, whole.std)}
    for name in ("specific_impulse", "specific_impulse_loaded"):
        specific = measured[name]
        if whole.value and specific.value is not None and specific.std:
            own = relative(impulse, whole.value / specific.value)
            rest = max(specific.std**2 - total(own) ** 2, 0.0) ** 0.5
            found[name] = by_inputs([*own, Input(PROPELLANT, rest)], specific.std)
    return {name: made for name, made in found.items() if made is not None}


def ratio_budgets(found: Efficiencies, spread: Spread) -> dict[str, Budget]:
    """Of c* and of the thrust coefficient, means over the liquid phase, by name."""
    shared = [Input(CHAMBER, spread.pressure), Input(THROAT, spread.throat)]
    flows = [Input(OXIDIZER, spread.oxidizer), Input(FUEL, spread.fuel)]
    inputs = {"c_star": [*shared, *flows], "thrust_coefficient": [*shared, *spread.cell]}
    out = {}
    for name, own in inputs.items():
        quantity: Quantity = getattr(found, name)
        if quantity.value is not None and quantity.std:
            out[name] = by_inputs(relative(own, 1.0 / quantity.value), quantity.std)
    return {name: made for name, made in out.items() if made is not None}
