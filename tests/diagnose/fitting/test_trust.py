"""How far slopes are trusted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.diagnose import made

from hfanalysis.diagnose.fitting import fit as fits
from hfanalysis.diagnose.fitting.fit import CONVERGED, fit
from hfanalysis.diagnose.fitting.predict import Prediction, predict
from hfanalysis.diagnose.fitting.trust import LEAST_DAMPING, damping_within, grown, length_of, shrunk

Array = NDArray[np.float64]

SEEDS = some.integers(0, 2**31)


@given(seed=SEEDS, part=some.floats(0.01, 2.0))
def test_a_damped_step_is_as_long_as_the_region_is_wide(seed: int, part: float) -> None:
    """Whatever units parameters have; a step that is inside as it is, is not damped."""
    rng = np.random.default_rng(seed)
    slopes = rng.normal(size=(12, 5)) * 10.0 ** rng.uniform(-1.0, 2.0, 5)
    slopes[:, 1] = slopes[:, 0] + 1e-2 * slopes[:, 1]
    curvature, gradient = slopes.T @ slopes + np.eye(5), 10.0 * rng.normal(size=5)
    free = rng.uniform(size=5) < 0.8

    def step(damping: float) -> Array:
        damped = curvature + damping * np.diag(curvature.diagonal())
        out = np.zeros(5)
        out[free] = -np.linalg.solve(damped[np.ix_(free, free)], gradient[free])
        return out

    whole = length_of(step(0.0), curvature)
    damping = damping_within(curvature, gradient, free, part * whole)
    if part > 1.01 or not free.any():
        assert damping == LEAST_DAMPING
    else:
        assert length_of(step(damping), curvature) == pytest.approx(min(part, 1.0) * whole, rel=0.02)


@given(length=some.floats(1e-3, 1e3), part=some.floats(-1e6, 0.1))
def test_a_region_shrinks_the_more_the_worse_a_step_was(length: float, part: float) -> None:
    assert 0.1 * length <= shrunk(length, part) <= 0.5 * length
    assert shrunk(length, part) <= shrunk(length, part + 0.5)
    assert shrunk(length, np.nan) == 0.1 * length  # where there was nothing to be run


def test_a_region_grows_with_the_length_of_a_good_step() -> None:
    assert grown(4.0, 3.0, 1.0) == 6.0
    assert grown(4.0, 1.0, 1.0) == 4.0
    assert grown(4.0, 3.0, 0.5) == 4.0
    assert grown(4.0, 3.0, 0.2) == 1.5
    assert grown(np.inf, 3.0, 1.0) == np.inf


@pytest.mark.parametrize("bend", [0.3, 1.0, 3.0])
def test_a_fit_follows_a_valley_that_bends(monkeypatch: pytest.MonkeyPatch, bend: float) -> None:
    """Slopes that hold for a little way only: few runs find out how far that is."""
    hypothesis, observed, runs, slopes = made.hypothesis(), made.observed(), [], []
    burnt = predict(hypothesis, observed, made.truth(), tangents=False).burnt

    def residual(x: Array) -> Array:
        return np.array([100.0 * (x[1] - bend * x[0] ** 2), 5.0 * (1.0 - x[0])])

    def run(_: object, __: object, x: Array, tangents: bool) -> Prediction:
        runs.append(x)
        there = Prediction(residual(x), None, burnt)
        return with_slopes(hypothesis, observed, x, there) if tangents else there

    def with_slopes(_: object, __: object, x: Array, there: Prediction) -> Prediction:
        slopes.append(x)
        out = np.zeros((2, x.size))
        out[:, :2] = [[-200.0 * bend * x[0], 100.0], [-5.0, 0.0]]
        return replace(there, slopes=out)

    monkeypatch.setattr(fits, "predict", run)
    monkeypatch.setattr(fits, "with_slopes", with_slopes)
    monkeypatch.setattr(fits, "log_evidence", lambda *_: 0.0)
    start = np.zeros(hypothesis.size)
    start[0] = -0.6
    found = fit(hypothesis, observed, start, most=100)
    gradient = found.slopes.T @ found.residual + found.x
    assert found.converged
    assert 0.5 * gradient @ found.covariance @ gradient < CONVERGED
    assert len(runs) < 1.7 * len(slopes)
