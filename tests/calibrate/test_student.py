"""Student's t is SciPy's."""

from __future__ import annotations

import pytest
from scipy.special import stdtrit

from hfanalysis.calibrate.student import t_95


@pytest.mark.parametrize("freedom", [1.0, 1.01, 1.5, 2.0, 3.0, 4.7, 10.0, 33.3, 100.0, 1000.0])
def test_quantiles_are_those_of_scipy(freedom: float) -> None:
    assert t_95(freedom) == pytest.approx(float(stdtrit(freedom, 0.975)), rel=1e-12)
