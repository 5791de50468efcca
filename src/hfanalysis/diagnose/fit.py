"""Fitting a hypothesis to what a test says: damped Gauss-Newton on exact tangents, with priors.

The result is the most probable set of parameters, their covariance, and the evidence by Laplace's approximation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.hypothesis import Hypothesis
from hfanalysis.diagnose.observed import CHANNELS, Channel, Observed
from hfanalysis.diagnose.probe import Splines
from hfanalysis.engine.course import LIQUID_OUT
from hfanalysis.engine.model import RADIUS
from hfanalysis.engine.sensitivity import Tangents, run_with_tangents
from hfanalysis.engine.unsteady import Burn, Engine, burn

Array = NDArray[np.float64]

ITERATIONS = 25
CONVERGED = 1e-3
"""Change of the objective below which a fit is done: a thousandth of a unit of log probability."""

STEEPEST = 1e8
"""Standard deviations of an observation per one of a parameter beyond which a slope is none."""

AFTER = 1.0
"""Seconds that a run goes on after the last observation, for its liquid may end later than the measured."""

TICK = 1e-3
"""Seconds over which a channel's speed is a difference; blocks stay farther than that from the end of the liquid."""


@dataclass(frozen=True)
class Prediction:
    """A run of a hypothesis: whitened residuals (measured less model) and, if asked for, their slopes with ``x``."""

    residual: Array
    slopes: Array | None
    burnt: Burn


@dataclass(frozen=True)
class Fit:
    """The most probable ``x`` of a hypothesis, its covariance, the whitened residual there and the log evidence."""

    hypothesis: Hypothesis
    x: Array
    covariance: Array
    residual: Array
    slopes: Array
    burnt: Burn
    log_evidence: float
    converged: bool

    @property
    def values(self) -> dict[str, float]:
        """Parameters by name [SI]."""
        return self.hypothesis.values(self.x)

    @property
    def objective(self) -> float:
        """Minus the log of posterior density, up to a constant."""
        return 0.5 * float(self.residual @ self.residual + self.x @ self.x)


def predict(hypothesis: Hypothesis, observed: Observed, x: Array, tangents: bool) -> Prediction:
    """Run a hypothesis. Raises ValueError or ArithmeticError for an engine that cannot be run."""
    engine, longest = with_spare_fuel(hypothesis.at(x)), observed.longest + AFTER
    if not tangents:
        burnt = burn(engine, longest, run_on=True, keep_idle=True)
        return Prediction(residuals(hypothesis, observed, x, burnt), None, burnt)
    found = run_with_tangents(engine, hypothesis.of_engine, longest, run_on=True)
    slopes = _all_slopes(hypothesis, observed, slopes_of(hypothesis, observed, found)) @ hypothesis.jacobian(x)
    return Prediction(residuals(hypothesis, observed, x, found.burn), slopes, found.burn)


def with_spare_fuel(engine: Engine) -> Engine:
    """The same port in a grain that does not end.

    What is compared ends with the fuel at the latest. A model whose fuel is gone earlier would leap to cold gas, and no
    slope leads out of that; when the web is burnt is an observation of its own.
    """
    outer = 2.0 * engine.outer_radius
    mass = engine.fuel_density * pi * engine.grain_length * (outer**2 - engine.port_radius**2)
    return replace(engine, outer_radius=outer, fuel_mass=mass)


def _all_slopes(hypothesis: Hypothesis, observed: Observed, of_engine: Array) -> Array:
    """Slopes with all parameters [SI]: the engine's, and those of the sensors' sources."""
    names, out = hypothesis.of_engine, np.zeros((of_engine.shape[0], hypothesis.size))
    column = {name: i for i, name in enumerate(hypothesis.names)}
    out[:, [column[name] for name in names]] = of_engine
    for block, place in hypothesis.places():
        if block.sensor is not None:
            out[:, place] = sensor_slopes(observed, block.sensor, block.splines)
    return out


def sensor_slopes(observed: Observed, sensor: str, splines: Splines) -> Array:
    """Slopes of the residuals with the coefficients of what is added to a sensor's reading."""
    rows = [np.zeros((c.time.size, splines.count)) for c in observed.channels]
    for i, channel in enumerate(observed.channels):
        if channel.name == sensor:
            rows[i] = -channel.whiten(splines.at(channel.time))
    return np.concatenate([*rows, np.zeros((len(observed.events), splines.count))])


def residuals(hypothesis: Hypothesis, observed: Observed, x: Array, burnt: Burn) -> Array:
    """Whitened measured less model: the channels one after the other, then the events."""
    parts = []
    for channel in observed.channels:
        model = _read(burnt, channel, aligned(observed, burnt, channel.time))
        model = model + hypothesis.offset(channel.name, x, channel.time)
        parts.append(channel.whiten(channel.value - model))
    for name, (at, deviation) in observed.events.items():
        if name == "t_v":
            gone = burnt.liquid_out if burnt.liquid_out is not None else 2.0 * observed.end
            parts.append(np.array([(at - gone) / deviation]))
        else:
            states, _ = burnt.steps.at(np.array([at]))
            web = hypothesis.engine.outer_radius - states[0, RADIUS]
            parts.append(np.array([web / (deviation * _typical_regression(hypothesis, at))]))
    return np.concatenate(parts)


def aligned(observed: Observed, burnt: Burn, times: Array) -> Array:
    """Instants of the model that correspond to measured ones: stretched so that its liquid ends when the measured does.

    Between two instants of t_v the one is liquid and the other vapour, and no slope tells how to bring them together;
    how far apart they are is an observation of its own.
    """
    seen, gone = observed.events.get("t_v"), burnt.liquid_out
    if seen is None or gone is None:
        return times
    return np.where(times < seen[0], times * gone / seen[0], times + gone - seen[0])


def _read(burnt: Burn, channel: Channel, times: Array) -> Array:
    _, outputs = burnt.steps.at(times)
    return outputs[:, _column(channel.name)]


def _aligned_slopes(observed: Observed, found: Tangents, channel: Channel) -> Array:
    """Slopes of a channel's model at aligned instants, which move with the end of the liquid."""
    times = aligned(observed, found.burn, channel.time)
    slopes = found.output(CHANNELS[channel.name], times)
    seen = observed.events.get("t_v")
    if seen is None or found.burn.liquid_out is None:
        return slopes
    ahead, behind = (_read(found.burn, channel, times + s * TICK) for s in (1.0, -1.0))
    share = np.minimum(channel.time / seen[0], 1.0)
    speed = (ahead - behind) / (2.0 * TICK) * share
    return np.asarray(slopes + speed[:, np.newaxis] * np.nan_to_num(found.event(LIQUID_OUT))[np.newaxis])


def _typical_regression(hypothesis: Hypothesis, burn_time: float) -> float:
    """The web over the burn time [m/s]: what turns an instant's deviation into one of the port's radius."""
    return (hypothesis.engine.outer_radius - hypothesis.engine.port_radius) / burn_time


def slopes_of(hypothesis: Hypothesis, observed: Observed, found: Tangents) -> Array:
    """Derivatives (residuals, parameters) of :func:`residuals` with the parameters [SI]."""
    parts = [-c.whiten(_aligned_slopes(observed, found, c)) for c in observed.channels]
    for name, (at, deviation) in observed.events.items():
        if name == "t_v":
            parts.append(-np.nan_to_num(found.event(LIQUID_OUT))[np.newaxis] / deviation)
        else:
            unit = deviation * _typical_regression(hypothesis, at)
            parts.append(-found.output("port_radius", np.array([at])) / unit)
    return np.concatenate(parts)


def model_of(fitted: Fit, channel: Channel) -> Array:
    """What the fitted model reads on a channel."""
    return _read(fitted.burnt, channel, channel.time) + fitted.hypothesis.offset(channel.name, fitted.x, channel.time)


def _column(channel: str) -> int:
    from hfanalysis.engine.model import OUTPUTS

    return OUTPUTS.index(CHANNELS[channel])


def fit(hypothesis: Hypothesis, observed: Observed, start: Array | None = None) -> Fit:
    """The most probable parameters: Gauss-Newton steps, damped where one does not lower the objective."""
    x = np.zeros(hypothesis.size) if start is None else np.asarray(start, dtype=np.float64)
    here = predict(hypothesis, observed, x, tangents=True)
    if not _usable(here):
        raise ArithmeticError("the model has no slopes where its fit starts")
    damping, done = 1e-3, False
    for _ in range(ITERATIONS):
        assert here.slopes is not None
        gradient = here.slopes.T @ here.residual + x
        curvature = here.slopes.T @ here.slopes + np.eye(x.size)
        before = _objective(here, x)
        moved = False
        for _ in range(8):
            step = -np.linalg.solve(curvature + damping * np.diag(curvature.diagonal()), gradient)
            step *= min(1.0, 3.0 / max(float(np.abs(step).max()), 1e-12))
            trial = _try(hypothesis, observed, x + step)
            if trial is not None and _objective(trial, x + step) < before:
                moved = True
                break
            damping = max(10.0 * damping, 1e-3)
        if not moved:
            done = True
            break
        there = predict(hypothesis, observed, x + step, tangents=True)
        if not _usable(there):
            damping = max(100.0 * damping, 1.0)  # a point without slopes leads nowhere: a shorter step
            continue
        x, here = x + step, there
        damping = max(0.1 * damping, 1e-9)
        if before - _objective(here, x) < CONVERGED:
            done = True
            break
    assert here.slopes is not None
    curvature = here.slopes.T @ here.slopes + np.eye(x.size)
    evidence = -_objective(here, x) - 0.5 * float(np.linalg.slogdet(curvature)[1])
    covariance = np.asarray(np.linalg.inv(curvature))
    return Fit(hypothesis, x, covariance, here.residual, here.slopes, here.burnt, evidence, done)


def _usable(prediction: Prediction) -> bool:
    """Whether slopes are numbers that a step can be made from: where a run chatters they grow beyond all bounds."""
    return prediction.slopes is not None and bool((np.abs(prediction.slopes) < STEEPEST).all())


def _objective(prediction: Prediction, x: Array) -> float:
    return 0.5 * float(prediction.residual @ prediction.residual + x @ x)


def _try(hypothesis: Hypothesis, observed: Observed, x: Array) -> Prediction | None:
    try:
        found = predict(hypothesis, observed, x, tangents=False)
    except (ValueError, ArithmeticError):
        return None
    return found if np.isfinite(found.residual).all() else None
