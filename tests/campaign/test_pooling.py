"""The mean of several tests' numbers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.campaign.pooling import pooled
from hfanalysis.quantity import Quantity


def by_test(values: list[float], stds: list[float]) -> dict[str, Quantity]:
    return {f"T{i}": Quantity(v, "K", s) for i, (v, s) in enumerate(zip(values, stds, strict=True))}


def test_one_test_has_no_mean() -> None:
    assert pooled(by_test([1.0], [0.1])) is None
    assert pooled({**by_test([1.0], [0.1]), "X": Quantity.absent("no flow"), "Y": Quantity(1.0, "K")}) is None


def test_tests_that_agree_have_the_weighted_mean() -> None:
    found = pooled(by_test([10.0, 10.3], [0.1, 0.2]))
    assert found is not None
    assert found.agree
    assert found.between == pytest.approx(np.sqrt((9.0 / 5.0 - 1.0) / (125.0 - (100.0**2 + 25.0**2) / 125.0)))
    weights = 1.0 / (np.array([0.1, 0.2]) ** 2 + found.between**2)
    assert found.mean.value == pytest.approx(weights @ [10.0, 10.3] / weights.sum())
    assert found.mean.unit == "K"
    assert found.tests == ("T0", "T1")


def test_tests_that_differ_by_far_more_than_they_state_disagree_and_the_mean_knows() -> None:
    found = pooled(by_test([1.0, 2.0, 3.0], [0.01, 0.01, 0.01]))
    assert found is not None
    assert not found.agree
    assert found.between == pytest.approx(1.0, rel=0.01)
    assert found.mean.std == pytest.approx(1.0 / np.sqrt(3.0), rel=0.01)


@given(
    st.lists(st.tuples(st.floats(-1e3, 1e3), st.floats(1e-3, 1e2)), min_size=2, max_size=6),
    st.floats(1e-6, 1e6),
)
def test_the_mean_is_among_the_values_and_scales_with_them(found: list[tuple[float, float]], factor: float) -> None:
    values, stds = map(list, zip(*found, strict=True))
    one = pooled(by_test(values, stds))
    other = pooled(by_test([factor * v for v in values], [factor * s for s in stds]))
    assert one is not None
    assert other is not None
    assert one.mean.value is not None
    assert min(values) - 1e-9 <= one.mean.value <= max(values) + 1e-9
    assert one.mean.std is not None
    assert one.mean.std >= 0.99 / np.sqrt(sum(1.0 / s**2 for s in stds))
    assert other.mean.value == pytest.approx(factor * one.mean.value, rel=1e-6, abs=1e-6 * factor)
    assert other.mean.std == pytest.approx(factor * one.mean.std, rel=1e-6)


@pytest.mark.parametrize("between", [0.0, 3.0])
def test_intervals_hold_the_truth_about_as_often_as_they_say(between: float) -> None:
    rng = np.random.default_rng(7)
    held = 0
    for _ in range(400):
        stds = rng.uniform(0.5, 1.5, 4)
        values = 20.0 + between * rng.standard_normal(4) + stds * rng.standard_normal(4)
        found = pooled(by_test(list(values), list(stds)))
        assert found is not None
        assert found.mean.interval is not None
        held += found.mean.interval[0] <= 20.0 <= found.mean.interval[1]
    assert 0.92 <= held / 400 <= 0.995


def test_tests_of_one_value_rarely_disagree() -> None:
    rng = np.random.default_rng(8)
    found = [pooled(by_test(list(rng.standard_normal(3)), [1.0] * 3)) for _ in range(1000)]
    assert sum(not one.agree for one in found if one is not None) <= 22
