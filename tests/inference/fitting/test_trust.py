"""How far slopes are trusted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.inference import made

from hfanalysis.inference.fitting import fit as fits
from hfanalysis.inference.fitting.fit import CONVERGED, fit
from hfanalysis.inference.fitting.predict import Prediction, predict
from hfanalysis.inference.fitting.trust import (
    LEAST_DAMPING,
    LONGEST_STRIDE,
    bounded_step,
    box_about,
    grown,
    length_of,
    shrunk,
    step_within,
)

Array = NDArray[np.float64]

SEEDS = some.integers(0, 2**31)


@given(seed=SEEDS, damping=some.sampled_from((0.0, 1e-3, 1.0)), room=some.floats(0.05, 3.0))
def test_a_step_goes_downhill_within_bounds(seed: int, damping: float, room: float) -> None:
    """Also where parameters do nearly the same, and the best point of all lies far beyond what several may be."""
    slopes, residual, x, box = valley(seed, room)
    gradient, curvature = slopes.T @ residual + x, slopes.T @ slopes + np.eye(5)
    step = bounded_step(gradient, curvature, box, damping)
    assert ((step >= box[0] - 1e-12) & (step <= box[1] + 1e-12)).all()

    def objective(at: Array) -> float:
        left = residual + slopes @ (at - x)
        return 0.5 * float(left @ left + at @ at)

    assert objective(x + step) <= objective(x) * (1.0 + 1e-12)
    pull = gradient + (curvature + damping * np.diag(curvature.diagonal())) @ step
    at_rest = 1e-6 * np.abs(gradient).max()
    assert (pull[step > box[0] + 1e-9] < at_rest).all()  # what is not at its least does not want down
    assert (pull[step < box[1] - 1e-9] > -at_rest).all()
    if damping == 0.0 and ((step > box[0] + 1e-9) & (step < box[1] - 1e-9)).all():
        assert objective(x + step) == pytest.approx(objective(x - np.linalg.solve(curvature, gradient)), rel=1e-6)


def test_a_parameter_that_the_data_do_not_tell_does_not_hold_the_others_back() -> None:
    """It would move 50 deviations; the others go as far as they want to beside where it stays."""
    gradient, curvature = np.array([-30.0, -50.0]), np.array([[100.0, 1.0], [1.0, 1.02]])
    step = bounded_step(gradient, curvature, box_about(np.zeros(2), np.full(2, -np.inf), np.full(2, np.inf)), 0.0)
    assert step[1] == LONGEST_STRIDE
    assert curvature[0] @ step == pytest.approx(-gradient[0])


@given(seed=SEEDS, part=some.floats(0.01, 2.0), room=some.floats(0.05, 3.0))
def test_a_damped_step_is_as_long_as_the_region_is_wide(seed: int, part: float, room: float) -> None:
    """Whatever units parameters have, and also where some of them rest at their bounds and the others go farther for
    it; a step that is inside as it is, is not damped."""
    slopes, residual, x, box = valley(seed, room)
    gradient, curvature = slopes.T @ residual + x, slopes.T @ slopes + np.eye(5)
    whole = bounded_step(gradient, curvature, box, LEAST_DAMPING)
    radius = part * length_of(whole, curvature)
    step = step_within(radius, gradient, curvature, box)
    if part >= 1.0 or not whole.any():  # in a corner that leads nowhere down, there is no step
        assert (step == whole).all()
    else:
        assert 0.9 * radius < length_of(step, curvature) <= radius


def valley(seed: int, room: float) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Slopes (12, 5) and a residual (12,) at ``x`` (5,), and the box about it."""
    rng = np.random.default_rng(seed)
    slopes = rng.normal(size=(12, 5)) * 10.0 ** rng.uniform(-1.0, 2.0, 5)
    slopes[:, 1] = slopes[:, 0] + 1e-2 * slopes[:, 1]
    residual, x = rng.normal(size=12) * 10.0 ** rng.uniform(0.0, 2.0), rng.uniform(-1.0, 1.0, 5)
    least, most = np.minimum(x, -room * rng.uniform(size=5)), np.maximum(x, room * rng.uniform(size=5))
    return slopes, residual, x, box_about(x, least, most)


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

    def run(_: object, __: object, x: Array, tangents: bool, accuracy: float = 0.0) -> Prediction:
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
