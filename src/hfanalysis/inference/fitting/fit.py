"""Fitting a hypothesis to what a test says: Gauss-Newton steps on exact tangents, with a trust region, priors, bounds.

The result is the most probable set of parameters, their covariance, and the evidence by Laplace's approximation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.noise_level import louder_or_quieter
from hfanalysis.inference.fitting.predict import ACCURACY, FINE, Prediction, predict, with_slopes
from hfanalysis.inference.fitting.size import of_any_size
from hfanalysis.inference.fitting.trust import box_about, grown, learnt, length_of, shrunk, step_within
from hfanalysis.inference.observations.observed import Observed

ITERATIONS = 25
"""Steps that a fit makes at most, unless it is asked for more."""
CONVERGED, ENDED = 0.02, 1e-5
"""Change of the objective below which a fit that looks around is done, and one whose numbers are told, in units of log
probability: within 0.02 of its most probable value a parameter may be a fifth of its deviation away, within 1e-5 by
half a percent of it. Source: the log of a normal density falls by half the square of a deviation."""

NEAR, LAST_STEPS = 0.5, 12
"""Log probability that steps by slopes alone may promise, and steps in which a fit comes to its end by them."""

MOST_TO_AND_FRO = 3
"""Such steps one after the other of which none promises half of the least that one has promised."""

STEEPEST = 1e8
"""Standard deviations of an observation per one of a parameter beyond which a slope is none."""

TRUST = 0.1
"""Part of what the slopes promise of a step that it must bring: a step that brings less leads along a wrong valley."""

TRIALS = 12
"""Steps that are tried from one point, each shorter than the last."""


@dataclass(frozen=True)
class Fit:
    """The most probable ``x`` of a hypothesis, its covariance, the whitened residual there and the log evidence.

    The evidence is a density, in units that do not depend on the hypothesis or on the model-form error. ``within``: the
    change of the objective below which going on would bring nothing, for the slopes promise no more or no step along
    them that was tried is better; infinite where the fit was stopped on its way.
    """

    hypothesis: Hypothesis
    x: Array
    covariance: Array
    residual: Array
    slopes: Array
    burnt: Burn
    log_evidence: float
    within: float

    @property
    def converged(self) -> bool:
        """Whether it is done, if only by what is enough to look around."""
        return self.within <= CONVERGED

    @property
    def values(self) -> dict[str, float]:
        """Parameters by name, each in its SI unit."""
        return self.hypothesis.values(self.x)

    @property
    def stds(self) -> dict[str, float]:
        """Standard deviations of :attr:`values`, each in its SI unit; linear about ``x``."""
        jacobian = self.hypothesis.jacobian(self.x)
        spread = np.sqrt(np.maximum(np.diag(jacobian @ self.covariance @ jacobian.T), 0.0))
        return dict(zip(self.hypothesis.names, spread.tolist(), strict=True))

    @property
    def objective(self) -> float:
        """Minus the log of posterior density [natural log], up to a constant."""
        return 0.5 * float(self.residual @ self.residual + self.x @ self.x)


def fit(
    hypothesis: Hypothesis,
    observed: Observed,
    start: Array | None = None,
    most: int = ITERATIONS,
    within: float = CONVERGED,
) -> Fit:
    """The most probable parameters: Gauss-Newton steps, damped where one does not lower the objective.

    ``start`` (parameters,) in prior standard deviations; 0 by default. At ``most`` so many steps, and no more once one
    changes the objective by less than ``within`` [natural log]. Raises ValueError or ArithmeticError where the start
    cannot be run.
    """
    least, highest = hypothesis.bounds
    x = np.clip(np.zeros(hypothesis.size) if start is None else np.asarray(start, dtype=np.float64), least, highest)
    return _fitted(hypothesis, observed, x, predict(hypothesis, observed, x, tangents=True), most, within)


def fit_on(found: Fit, before: Observed, observed: Observed, most: int = ITERATIONS, within: float = CONVERGED) -> Fit:
    """A fit to ``before`` gone on with, to the same data with another model-form error if that is asked for.

    Where it ended its slopes are known: no run is needed to begin with. Raises as :func:`fit`. ``within``: change of
    the objective [natural log].
    """
    residual, slopes = found.residual, found.slopes
    if observed is not before:
        residual, slopes = (observed.rewhitened(rows, before) for rows in (residual, slopes))
    return _fitted(found.hypothesis, observed, found.x, Prediction(residual, slopes, found.burnt), most, within)


def _fitted(
    hypothesis: Hypothesis,
    observed: Observed,
    x: Array,
    here: Prediction,
    most: int,
    within: float,
    accuracy: float = ACCURACY,
) -> Fit:
    """From ``x``, where the prediction is ``here``."""
    if not usable(here):
        raise ArithmeticError("the model has no slopes where its fit starts")
    radius, done = np.inf, False
    for _ in range(most):
        assert here.slopes is not None
        before, moved = _objective(here, x), None
        gradient, curvature = here.slopes.T @ here.residual + x, here.slopes.T @ here.slopes + np.eye(x.size)
        box = box_about(x, *hypothesis.bounds)
        for _ in range(TRIALS):
            step = step_within(radius, gradient, curvature, box)
            expected = _expected(here, x, step)
            trial = _try(hypothesis, observed, x + step, accuracy)
            part = np.nan if trial is None else (before - _objective(trial, x + step)) / max(expected, 1e-300)
            length = length_of(step, curvature)
            if trial is not None and part > TRUST:
                moved, radius = trial, grown(radius, length, part)
                break
            if expected < within:
                break  # a shorter step brings less
            radius = shrunk(length, part)
        if moved is None:
            done = True
            break
        if before - _objective(moved, x + step) < within:
            x, here, done = x + step, replace(moved, slopes=here.slopes), True  # so near by, slopes are the same
            break
        there = with_slopes(hypothesis, observed, x + step, moved)
        if not usable(there):
            radius = shrunk(length, np.nan)  # a point without slopes leads nowhere: a shorter step
            continue
        x, here = x + step, there
    return _fit_at(hypothesis, observed, x, here, within if done else np.inf)


def _fit_at(hypothesis: Hypothesis, observed: Observed, x: Array, here: Prediction, within: float) -> Fit:
    """The fit that ends at ``x``, where the prediction is ``here``."""
    assert here.slopes is not None
    evidence = log_evidence(here.residual, here.slopes, x, observed, hypothesis)
    covariance = np.asarray(np.linalg.inv(here.slopes.T @ here.slopes + np.eye(x.size)))
    return Fit(hypothesis, x, covariance, here.residual, here.slopes, here.burnt, evidence, within)


def brought_to_end(found: Fit, observed: Observed, most: int = ITERATIONS) -> Fit:
    """A fit that is near its end, taken there with finer runs: by slopes, and where these do not lead there as before.

    An objective is rounded by as much as its residual is, many times over; the square of that is what it moves the most
    probable parameters by. So near by, slopes tell whether a step is better. At a knee they leap, and do not. Raises
    as :func:`fit`.
    """
    hypothesis, x = found.hypothesis, found.x
    here = predict(hypothesis, observed, x, tangents=True, accuracy=FINE)
    if (ended := _by_slopes(hypothesis, observed, x, here)) is not None:
        return ended
    near = _fitted(hypothesis, observed, x, here, most, ENDED, FINE)
    here = with_slopes(hypothesis, observed, near.x, Prediction(near.residual, None, near.burnt))
    return _by_slopes(hypothesis, observed, near.x, here) or near


def _by_slopes(hypothesis: Hypothesis, observed: Observed, x: Array, here: Prediction) -> Fit | None:
    """The fit to whose end whole steps by the slopes lead from ``x``; None where they lead elsewhere.

    Where much is left open the squares of slopes are not the curvature: it is learnt on the way. Where that does not
    lead to an end either, the steps go to and fro.
    """
    curvature, step, before = None, np.zeros(x.size), np.zeros(x.size)
    least, to_and_fro = np.inf, 0
    for _ in range(LAST_STEPS):
        if not usable(here):
            return None
        assert here.slopes is not None
        gradient = here.slopes.T @ here.residual + x
        if curvature is None:
            curvature = here.slopes.T @ here.slopes + np.eye(x.size)
        else:
            curvature = learnt(curvature, step, gradient - before)
        step, before = step_within(np.inf, gradient, curvature, box_about(x, *hypothesis.bounds)), gradient
        promise = -float(gradient @ step + 0.5 * step @ curvature @ step)
        if promise < ENDED:
            return _fit_at(hypothesis, observed, x, here, ENDED)
        least, to_and_fro = (promise, 0) if promise < 0.5 * least else (least, to_and_fro + 1)
        if promise > NEAR or to_and_fro > MOST_TO_AND_FRO:
            return None
        here, x = predict(hypothesis, observed, x + step, tangents=True, accuracy=FINE), x + step
    return None


def log_evidence(residual: Array, slopes: Array, x: Array, observed: Observed, hypothesis: Hypothesis) -> float:
    """Log of the probability of the data [natural log], by Laplace's approximation about the most probable ``x``.

    ``residual`` (observations,) whitened; ``slopes`` (observations, parameters) of it with ``x`` (parameters,), in
    prior standard deviations. Strengths of effects are of any size there; ``x`` may go on beyond the parameters of the
    hypothesis.
    """
    curvature = slopes.T @ slopes + np.eye(x.size)
    objective = 0.5 * float(residual @ residual + x @ x)
    size = float(np.linalg.slogdet(curvature)[1])
    noise = louder_or_quieter(residual, slopes, x, observed.slow_noise)
    return -objective - 0.5 * size - observed.log_size + noise + _of_any_size(curvature, x, hypothesis)


def _of_any_size(curvature: Array, x: Array, hypothesis: Hypothesis) -> float:
    """What the log evidence changes by as strengths, and the departures of laws, are of any size."""
    groups, laws = hypothesis.strengths, hypothesis.of_laws
    where = np.concatenate([*groups, np.array(laws, dtype=np.int64)])
    if not where.size:
        return 0.0
    columns = np.linalg.solve(curvature, np.eye(x.size)[:, where])
    return of_any_size(np.linalg.inv(columns[where]), x[where], [group.size for group in groups], len(laws))


def promised(found: Fit, observed: Observed, other: Observed, slack: Array | None = None) -> float:
    """The log evidence [natural log] that a fit to ``observed`` has at the model-form error of ``other``, if its slopes
    hold.

    ``slack`` (blocks of all channels, columns) [SI]: what may be added to what the sensors read besides, each column
    times an N(0, 1) number.
    """
    residual, slopes = (other.rewhitened(rows, observed) for rows in (found.residual, found.slopes))
    x = found.x
    if slack is not None:
        columns = np.zeros((residual.size, slack.shape[1]))
        white = other.whiten(slack)
        columns[: white.shape[0]] = -white
        slopes, x = np.hstack([slopes, columns]), np.concatenate([x, np.zeros(slack.shape[1])])
    step = -np.linalg.solve(slopes.T @ slopes + np.eye(x.size), slopes.T @ residual + x)
    return log_evidence(residual + slopes @ step, slopes, x + step, other, found.hypothesis)


def _expected(here: Prediction, x: Array, step: Array) -> float:
    """By how much a step lowers the objective if the slopes hold."""
    assert here.slopes is not None
    moved = here.residual + here.slopes @ step
    return _objective(here, x) - 0.5 * float(moved @ moved + (x + step) @ (x + step))


def usable(prediction: Prediction) -> bool:
    """Whether slopes are numbers that a step can be made from: where a run chatters they grow beyond all bounds."""
    return prediction.slopes is not None and bool((np.abs(prediction.slopes) < STEEPEST).all())


def _objective(prediction: Prediction, x: Array) -> float:
    return 0.5 * float(prediction.residual @ prediction.residual + x @ x)


def _try(hypothesis: Hypothesis, observed: Observed, x: Array, accuracy: float) -> Prediction | None:
    try:
        found = predict(hypothesis, observed, x, tangents=False, accuracy=accuracy)
    except (ValueError, ArithmeticError):
        return None
    return found if np.isfinite(found.residual).all() else None
