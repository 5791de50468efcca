"""What the deviations of the measured performance are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hfanalysis.inference.budget import Input, by_inputs, total
from hfanalysis.products.budget import Budget
from hfanalysis.quantity import Quantity

PROPELLANT = "propellant mass"


def budgets(measured: Mapping[str, Quantity], impulse: Sequence[Input]) -> dict[str, Budget]:
    """By name, of the total impulse and of what follows from it.

    Args:
        measured: the measured column of the performance table.
        impulse: what the total impulse may be off by [N s].
    """
    whole, specific = measured["total_impulse"], measured["specific_impulse"]
    found = {"total_impulse": by_inputs(impulse, whole.std)}
    if whole.value and specific.value is not None and specific.std:
        own = [Input(i.name, specific.value * i.effect / whole.value, i.random) for i in impulse]
        rest = max(specific.std**2 - total(own) ** 2, 0.0) ** 0.5
        found["specific_impulse"] = by_inputs([*own, Input(PROPELLANT, rest)], specific.std)
    return {name: made for name, made in found.items() if made is not None}
