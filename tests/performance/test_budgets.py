"""Budgets of what follows from an impulse and from the liquid phase: by hand, shares of a known sum of squares."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.inference.budget import Input
from hfanalysis.performance.budgets import CHAMBER, FUEL, OXIDIZER, PROPELLANT, THROAT, budgets, ratio_budgets
from hfanalysis.performance.efficiency import Spread
from hfanalysis.performance.load_cell import ROWS, CellError
from hfanalysis.products.validation import Efficiencies
from hfanalysis.quantity import Quantity

IMPULSE = [Input(ROWS["gain"], 120.0), Input(ROWS["zero"], 40.0), Input("burn time", 30.0, random=True)]


def test_a_specific_impulse_has_the_impulses_inputs_and_the_propellants() -> None:
    """12,000 N s +/- 130 and 10 kg +/- 1 %: relative variances of 1.17e-4 and 1e-4."""
    impulse = Quantity(12e3, "N s", 130.0)
    value = 12e3 / 9.80665 / 10.0
    specific = Quantity(value, "s", value * float(np.hypot(130.0 / 12e3, 0.01)))
    none = Quantity.absent("not asked")
    found = budgets({"total_impulse": impulse, "specific_impulse": specific, "specific_impulse_loaded": none}, IMPULSE)
    assert set(found) == {"total_impulse", "specific_impulse"}
    assert found["total_impulse"].shares[ROWS["gain"]] == pytest.approx(120.0**2 / 130.0**2)
    assert found["total_impulse"].random == pytest.approx(30.0)
    shares = found["specific_impulse"].shares
    assert shares[PROPELLANT] == pytest.approx(1e-4 / (1e-4 + (130.0 / 12e3) ** 2))
    assert sum(shares.values()) == pytest.approx(1.0)
    assert found["specific_impulse"].non_linear == pytest.approx(0.0, abs=1e-9)


def test_ratios_over_the_liquid_phase_have_gauge_throat_flows_and_cell() -> None:
    cell = CellError(0.01, 0.0, 0.0, 0.0).at(1.0, 0.5)
    spread = Spread(0.008, 0.006, 0.009, 0.002, tuple(cell))
    none = Quantity.absent("not asked")
    found = Efficiencies(
        c_star=Quantity(1500.0, "m/s", 1500.0 * float(np.linalg.norm([0.008, 0.006, 0.009, 0.002]))),
        thrust_coefficient=Quantity(1.3, "", 1.3 * float(np.linalg.norm([0.008, 0.006, 0.01]))),
        c_star_efficiency=none, c_star_efficiency_frozen=none, thrust_coefficient_efficiency=none,
        thrust_coefficient_efficiency_frozen=none,
    )  # fmt: skip
    made = ratio_budgets(found, spread)
    assert set(made["c_star"].shares) == {CHAMBER, THROAT, OXIDIZER, FUEL}
    assert made["c_star"].shares[OXIDIZER] == pytest.approx(81.0 / 185.0)
    assert made["thrust_coefficient"].shares == pytest.approx(
        {ROWS["gain"]: 0.5, CHAMBER: 0.32, THROAT: 0.18}, abs=1e-9
    )
    assert all(b.non_linear == pytest.approx(0.0, abs=1e-9) for b in made.values())
