"""What a fit to some stretches says of others: over all constants that the former leave possible."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import multivariate_normal
from tests.inference import made

from hfanalysis.inference.predictive import over_constants

Array = NDArray[np.float64]

LOG_SIZE = 0.5 * np.log(2.0 * np.pi)
"""By which a normal density is less than what is told of whitened data [natural log], for each."""


def told(residual: Array, slopes: Array, x: Array) -> float:
    """Of whitened data (observations,)."""
    observed = made.observed()
    return over_constants(residual, slopes, x, observed) + observed.log_size


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 4))
def test_of_a_linear_model_it_is_the_normal_density_of_the_data(seed: int, data: int, constants: int) -> None:
    rng = np.random.default_rng(seed)
    value, slopes, x = rng.normal(size=data), rng.normal(size=(data, constants)), rng.normal(size=constants)
    expected = multivariate_normal(np.zeros(data), np.eye(data) + slopes @ slopes.T).logpdf(value) + data * LOG_SIZE
    assert np.isclose(told(value + slopes @ x, slopes, x), expected, rtol=1e-8, atol=1e-8)


def test_a_constant_that_the_rest_leaves_open_is_no_failure_to_foretell() -> None:
    """A stretch that asks for a constant ten deviations off: at what the rest has it would be -45,000."""
    rest, both = np.zeros((1, 1)), np.array([[0.0], [30.0]])
    off = np.array([0.0, 300.0])
    foretold = told(off, both, np.zeros(1)) - told(off[:1], rest, np.zeros(1))
    assert foretold > -0.5 * 10.0**2 - 5.0
