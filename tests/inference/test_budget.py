"""Budgets of quantities whose variances are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.inference.budget import Input, by_draws, by_inputs

COUNT = 2000


def test_effects_of_one_name_are_correlated_and_may_cancel() -> None:
    found = by_inputs([Input("area", 2.0), Input("mass", 3.0), Input("mass", -3.0)])
    assert found is not None
    assert found.shares == {"area": 1.0}
    assert (found.systematic, found.random, found.non_linear) == (2.0, 0.0, 0.0)


def test_what_a_stated_deviation_has_beyond_its_inputs_is_shown() -> None:
    found = by_inputs([Input("gain", 3.0), Input("noise", 4.0, random=True)], std=10.0)
    assert found is not None
    assert found.shares == pytest.approx({"noise": 0.16, "gain": 0.09})
    assert found.non_linear == pytest.approx(0.75)
    assert found.systematic**2 + found.random**2 == pytest.approx(100.0)


def test_nothing_uncertain_has_no_budget() -> None:
    assert by_inputs([]) is None
    assert by_inputs([Input("gain", 0.0)]) is None


def test_draws_of_a_linear_quantity_give_its_shares() -> None:
    """Variance 9 by x, 4 by noise, and 1 + 4 + 2 * 0.5 * 1 * 2 = 7 by a pair correlated at one half."""
    rng = np.random.default_rng(3)
    x, noise, a, b = rng.standard_normal((4, COUNT))
    pair = np.column_stack([a, 0.5 * a + np.sqrt(0.75) * b])
    found = by_draws(3.0 * x + 2.0 * noise + pair @ [1.0, 2.0], {"x": x, "noise": noise, "pair": pair}, ["noise"])
    assert found is not None
    assert found.shares == pytest.approx({"x": 0.45, "pair": 0.35, "noise": 0.2}, abs=0.02)
    assert found.non_linear == pytest.approx(0.0, abs=1e-6)
    assert found.random == pytest.approx(2.0, rel=0.06)


def test_what_is_not_linear_is_the_remainder() -> None:
    """x + x^2 / 2 of a normal x has the variance 1 + 1/2, of which the slope explains 1."""
    x, idle = np.random.default_rng(4).standard_normal((2, COUNT))
    found = by_draws(x + 0.5 * x**2, {"x": x, "idle": idle})
    assert found is not None
    assert found.non_linear == pytest.approx(1.0 / 3.0, abs=0.06)
    assert sum(found.shares.values()) + found.non_linear == pytest.approx(1.0)


def test_inputs_that_say_nothing_explain_nothing() -> None:
    rng = np.random.default_rng(5)
    found = by_draws(rng.standard_normal(400), {str(i): rng.standard_normal(400) for i in range(14)})
    assert found is not None
    assert found.non_linear > 0.93


def test_draws_too_few_for_their_inputs_have_no_budget() -> None:
    x = np.linspace(0.0, 1.0, 30)
    assert by_draws(x, {"x": x, "y": x**2}) is None
