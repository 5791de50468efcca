"""Probabilities that a calibration takes from formulas of its own, beside scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline
from scipy.special import stdtrit

from hfanalysis.calibrate.likelihood import _cubic
from hfanalysis.calibrate.student import limit


@pytest.mark.parametrize("freedom", [1.0, 1.37, 2.0, 3.9, 10.0, 57.3, 1000.0])
def test_the_limit_is_students(freedom: float) -> None:
    assert limit(freedom) == pytest.approx(float(stdtrit(freedom, 0.975)), rel=1e-10)


def test_a_surface_is_followed_by_the_bicubic_spline_through_its_nodes() -> None:
    nodes, axis = np.linspace(-1.0, 1.0, 7), np.linspace(-1.0, 1.0, 23)
    values = np.random.default_rng(3).standard_normal((7, 7))
    between = _cubic(nodes, axis)
    expected = RectBivariateSpline(nodes, nodes, values)(axis, axis)
    assert between @ values @ between.T == pytest.approx(expected, abs=1e-9)
