"""Budgets of a tank's constants, on draws whose variance is known."""

from __future__ import annotations

import numpy as np
import pytest
from tests.products.filled import filled

from hfanalysis.calibrate.budgets import COURSE, budgets
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.products.calibration import TankConstants
from hfanalysis.quantity import Quantity

SAMPLES = 1000


@pytest.fixture(scope="module")
def draws() -> Draws:
    """C_i by holes (0.003), mass (0.004), and two times that are one row (0.001 each); m by nothing that was drawn."""
    rng = np.random.default_rng(2)
    area, mass, t_v, t_end, rest = rng.standard_normal((5, SAMPLES))
    values = {"C_i": 0.3 + 0.003 * area + 0.004 * mass + 0.001 * (t_v + t_end), "m": 1.0 + 0.01 * rest,
              "K_loss": np.full(SAMPLES, np.nan), "vapor_mass": mass}  # fmt: skip
    inputs = {"mass": 8.0 + 0.1 * mass, "systematic area": area, "systematic mass": mass, "random t_v": t_v,
              "random t_end": t_end}  # fmt: skip
    return Draws(values, inputs)


def test_the_rows_are_the_errors_by_their_plain_names(draws: Draws) -> None:
    std = float(draws.std("C_i"))
    found = budgets(draws, filled(TankConstants, {"C_i": Quantity(0.3, "", std)}))
    assert set(found) == {"C_i"}
    of = found["C_i"]
    assert of.shares == pytest.approx(
        {"loaded oxidizer": 16.0 / 27.0, "injector holes": 9.0 / 27.0, "phase times": 2.0 / 27.0}, abs=0.03
    )
    assert of.random == pytest.approx(std * np.sqrt(2.0 / 27.0), rel=0.1)
    assert sum(of.shares.values()) + of.non_linear == pytest.approx(1.0)


def test_what_the_course_is_worth_is_a_row(draws: Draws) -> None:
    std = float(np.hypot(draws.std("C_i"), 0.005))
    of = budgets(draws, filled(TankConstants, {"C_i": Quantity(0.3, "", std)}), 0.005)["C_i"]
    assert of.shares[COURSE] == pytest.approx(25e-6 / std**2)
    assert of.non_linear == pytest.approx(0.0, abs=0.02)
