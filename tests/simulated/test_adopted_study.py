"""The study of constants with adopted effects: what counts, and what its tables say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
from benchmarks.adopted import RUN, figures, told

from hfanalysis.quantity import Quantity


def row(true: float, regression: str) -> dict[str, Any]:
    rate = {"value": 1.0, "std": 0.05, "low": 0.9, "high": 1.1, "true": true}
    return {"told": {RUN[2]: rate}, "regression": regression}


def test_shares_are_of_what_was_told_and_by_the_law_of_regression() -> None:
    found = figures([row(1.05, "port"), row(1.2, "port"), row(1.0, "oxidizer_flux"), {"left": "not visible"}])
    assert found[0] == "4 tests with hidden effects: 3 calibrated with them, 1 left out."
    (line,) = (line for line in found if line.startswith(f"| {RUN[2]} "))
    assert [cell.strip() for cell in line.split("|")[2:4]] == ["3", "67 %"]
    assert "in 1 of 1 with a law by oxidizer flux, in 1 of 2 with a law by port" in found[-1]


@dataclass(frozen=True)
class Found:
    """A calibration of which each constant is its own."""

    C_i = Quantity(0.3, "", 0.01)
    n = Quantity(0.5, "", 0.02)
    K_loss = m = a = vapor_mass_at_t_v = oxidizer_mass_liquid_phase = Quantity.absent("not asked")
    regression_rate_reference = Quantity(1e-3, "m/s", 1e-5)

    class regression:
        reference_flux = Quantity(200.0, "kg/(m^2 s)")


def test_a_constant_counts_where_the_test_s_law_has_it_and_the_rate_is_that_at_the_reference_flux() -> None:
    laws = {"injector": "orifice", "feed": "quadratic", "vapor": "polytrope", "grain": "port"}
    run = {"flux": [400.0, 100.0], "rate": [2e-3, 1e-3], "gone_at_t_v": 5.0, "left_at_t_v": 1.0}
    truth = {"C_i": 0.31, "K_loss": 1e8, "m": 1.1, "a": 1e-4, "n": 0.5}
    made = told(Found(), {"laws": laws, "run": run, "truth": truth})
    assert set(made) == {"C_i", RUN[2]}
    assert made[RUN[2]]["true"] == pytest.approx(2e-3**0.5 * 1e-3**0.5)
