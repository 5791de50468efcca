"""What a model's constants may be off by, drawn jointly: moves of an engine that together have their covariance.

A lower factor L of the covariance has in each column what its constants move by together, one deviation of what the
columns before leave; the squares of what these do to a result add up to its variance, correlations in.
"""

from __future__ import annotations

from math import exp, log

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Engine
from hfanalysis.products.calibration import Calibration, Joint
from hfanalysis.quantity import STATED

FIELDS = {"oxidizer_mass": "oxidizer_mass", "flow_area": "area", "K_loss": "loss_factor", "m": "polytropic_exponent",
          "fuel_mass": "fuel_mass", "throat_area": "throat_area", "n": "n", "ln_a": "a", "a": "a"}  # fmt: skip
"""What of an engine each constant is; the tank's volume moves it through the others."""

SINGULAR = 1e-9
"""Added to the correlation of each with itself, so that constants that move as one have a factor."""


def changes(engine: Engine, calibration: Calibration) -> list[dict[str, float]]:
    """The engine's fields [SI] as each column of the factor has them."""
    joint = together(engine, calibration)
    kept = [i for i, name in enumerate(joint.names) if joint.std[i] > 0.0 and _has(engine, name)]
    names = [joint.names[i] for i in kept]
    std, correlation = np.array(joint.std)[kept], np.array(joint.correlation).reshape(len(joint.std), -1)
    inner = correlation[np.ix_(kept, kept)]
    factor = lower_factor(inner) * std[:, None]
    return [{FIELDS[n]: _moved(engine, n, x) for n, x in zip(names, column, strict=True) if x} for column in factor.T]


def together(engine: Engine, calibration: Calibration) -> Joint:
    """Errors [SI] of all the constants that an engine of this calibration takes, with those of its regression law."""
    return _with_law(calibration.joint or _apart(engine, calibration), calibration)


def _has(engine: Engine, name: str) -> bool:
    return name in FIELDS and not (name == "m" and engine.polytropic_exponent is None)


def _moved(engine: Engine, name: str, by: float) -> float:
    """A field of the engine with its constant off by so much."""
    if name == "ln_a":
        return engine.a * exp(by)
    field = FIELDS[name]
    own = getattr(engine.feed, field) if field in ("area", "loss_factor") else getattr(engine, field)
    return float(own + by)


def lower_factor(correlation: Array) -> Array:
    """Lower factor (n, n) of a correlation matrix, whatever rounding has done to it."""
    values, vectors = np.linalg.eigh(correlation)
    near = (vectors * np.maximum(values, SINGULAR)) @ vectors.T
    return np.asarray(np.linalg.cholesky(near), dtype=np.float64)


def _apart(engine: Engine, calibration: Calibration) -> Joint:
    """Of constants of which only their own deviations are known."""
    relative = (calibration.C_i.std or 0.0) / (calibration.C_i.value or 1.0)
    own = {
        "oxidizer_mass": calibration.load.std or 0.0,
        "flow_area": engine.feed.area * relative,
        "K_loss": calibration.K_loss.std or 0.0,
        "m": calibration.m.std or 0.0,
    }
    return _joint(own, np.eye(len(own)))


def _with_law(joint: Joint, calibration: Calibration) -> Joint:
    """With n and ln a, where it has none, or where they are stated."""
    stated = STATED in (calibration.a.verdict, calibration.n.verdict)
    if "n" in joint.names and not stated:
        return joint
    own = [i for i, name in enumerate(joint.names) if name not in ("n", "ln_a")]
    law, block = _law(calibration, stated)
    rest = np.array(joint.correlation).reshape(len(joint.names), -1)[np.ix_(own, own)]
    zero = np.zeros((len(own), len(law)))
    std = {joint.names[i]: joint.std[i] for i in own} | law
    return _joint(std, np.block([[rest, zero], [zero.T, block]]))


def _law(calibration: Calibration, stated: bool) -> tuple[dict[str, float], Array]:
    """Deviations of n and ln a (or a), and their correlation: of the rate at the reference flux n does not hang."""
    rate, flux = calibration.regression_rate_reference, calibration.regression.reference_flux
    n = calibration.n.std or 0.0
    if stated or not rate.value or flux is None or not flux.value:
        return {"n": n, "a": calibration.a.std or 0.0}, np.eye(2)
    along, across = log(flux.value) * n, (rate.std or 0.0) / rate.value
    ln_a = float(np.hypot(along, across))
    correlation = -along / ln_a if ln_a > 0.0 else 0.0
    return {"n": n, "ln_a": ln_a}, np.array([[1.0, correlation], [correlation, 1.0]])


def _joint(std: dict[str, float], correlation: Array) -> Joint:
    rows = tuple(tuple(float(x) for x in row) for row in correlation)
    return Joint(names=tuple(std), std=tuple(std.values()), correlation=rows)
