"""How well a and n are known: a likelihood whose noise is what the fit leaves, counted by its own correlation.

Residuals of a chamber pressure are no white noise: the sensor wanders, the model has another shape than the fire.
Neighboring block means then say the same thing again, and only as many as are independent are counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.calibrate.student import limit
from hfanalysis.quantity import NORMAL_95

Misfit = Callable[[Array], float]

FEWEST = 3.0
"""Independent residuals that are counted at least. Evidence: test_regression.py: a constant misfit is one value and not
many."""

WANDER_FREEDOM = 10.0
"""Degrees of freedom of the wander's size. Evidence: read off a few seconds before the opening it is known to a factor
of two or so."""

NODES = 7
"""Runs of the model per direction of the likelihood's surface. Evidence: HF4's and HF5's intervals are those of 9 to
every digit; of 60 curved valleys the worst is off by 4 % of its half (with 9: by 8 %), the median by 0.1 %."""
REACH = 1.6
"""How far the surface is followed, as a multiple of the 95 % limit [-]."""

CEILING = 20.0
"""Multiple of the 95 % limit at which the misfit is cut off, so that what is far away does not bend what is near."""

SURFACE_POINTS = 161
"""Points per direction at which the surface is read."""


def effective_samples(residual: Array) -> float:
    """How many of the residuals (n,), in any unit, are independent [-]: n / (1 + 2 sum rho_k), to the first rho_k <= 0.

    The mean is not taken out: a constant misfit is one, not many.

    >>> effective_samples(np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))
    6.0
    """
    n = residual.size
    power = float(residual @ residual)
    if n < 4 or power == 0.0:
        return float(n)
    total = 0.0
    for lag in range(1, n):
        rho = float(residual[:-lag] @ residual[lag:]) / power
        if rho <= 0.0:
            break
        total += rho
    return float(np.clip(n / (1.0 + 2.0 * total), min(FEWEST, n), n))


@dataclass(frozen=True)
class Weights:
    """``precision``: the inverse covariance of all observations; ``threshold``: rise of r'Pr at the 95 % limit.

    ``scatter`` [Pa]: standard deviation of a block mean of the chamber pressure about the model; ``effective``: number
    of independent ones of the ``samples`` that there are.
    """

    precision: Array
    threshold: float
    scatter: float
    effective: float
    samples: int

    def misfit(self, residual: Array) -> float:
        """r' P r [-] of the ``residual`` (n,) [Pa, s, kg], as :attr:`Evidence.observed` has them."""
        return float(residual @ self.precision @ residual)

    def deviance(self, residual: Array, count: float) -> float:
        """-2 ln of the likelihood [-], but for a constant, by weights that follow from this very ``residual`` (n,).

        A fit that leaves more scatter has wider weights and by its misfit alone would look as good; here the scatter
        counts, as that of ``count`` independent pressures. What the scalars and the common covariance take counts once.
        """
        variance = self.scatter**2 * self.samples / self.effective
        own = variance * (self.precision @ residual)[: self.samples]
        by_scatter = float(own @ own) / variance
        return count * (2.0 * log(self.scatter) + by_scatter / self.effective) + self.misfit(residual) - by_scatter


def first_guess(samples: int, level: float, scales: Array) -> Weights:
    """Weights before anything is known of the residuals: 3 % of the pressure, one in ten independent.

    ``samples`` of the chamber pressure at a mean ``level`` [Pa]; ``scales``: standard deviations of the scalars [s,
    kg].
    """
    variances = np.concatenate((np.full(samples, (0.03 * level) ** 2 * 10.0), scales**2))
    return Weights(np.diag(1.0 / variances), 4.0, 0.03 * level, 0.1 * samples, samples)


def weights_from(residual: Array, samples: int, scales: Array, nuisance: Array, wander: Array, least: float) -> Weights:
    """Weights from what a fit leaves, ``residual`` (n,) [Pa, s, kg], the first ``samples`` of them pressures.

    ``scales`` are the standard deviations of the scalars [s, kg], ``nuisance`` (n, n) is the covariance of the
    observations by what the calibration leaves open, ``wander`` (n, n) that by the slow wander of the chamber's sensor;
    ``least`` [Pa] is the scatter that the sensor alone has. Where these explain the residual, they are its covariance.
    Where the residual is larger, the model has another shape than the fire: then it is its own measure, with as many
    independent values as its own correlation leaves.
    """
    found = _weights(residual, samples, scales, nuisance + wander, least, WANDER_FREEDOM if wander.any() else np.inf)
    if found.misfit(residual) <= residual.size + 3.0 * np.sqrt(2.0 * residual.size):
        return found
    return _weights(residual, samples, scales, nuisance, least)


def _weights(
    residual: Array, samples: int, scales: Array, common: Array, least: float, known: float = np.inf
) -> Weights:
    """Weights under a ``common`` covariance: what it can explain of the residual counts as its, the rest as scatter.

    ``known``: degrees of freedom with which the common covariance is known.
    """
    scatter, effective = least, float(samples)
    for _ in range(3):
        free = _diagonal(samples, scatter, effective, scales)
        own = residual - common @ np.linalg.solve(common + free, residual)
        pressures = own[:samples]
        effective = effective_samples(pressures)
        lost = effective / max(effective - 2.0, 1.0)
        scatter = max(float(np.sqrt(pressures @ pressures / samples * lost)), least)
    precision = np.asarray(np.linalg.inv(common + _diagonal(samples, scatter, effective, scales)), dtype=np.float64)
    freedom = min(max(effective - 2.0, 1.0) + scales.size, known)
    return Weights(precision, limit(freedom) ** 2, scatter, effective, samples)


def _diagonal(samples: int, scatter: float, effective: float, scales: Array) -> Array:
    return np.diag(np.concatenate((np.full(samples, scatter**2 * samples / effective), scales**2)))


@dataclass(frozen=True)
class Surface:
    """The misfit about its least, on a fine grid of two parameters: ``points`` (k, 2), ``rise`` (k,).

    ``edge`` tells the points on the rim; beyond it nothing is known.
    """

    points: Array
    rise: Array
    edge: NDArray[np.bool_]
    threshold: float

    def interval(self, weights: Array) -> tuple[float, float]:
        """95 % profile-likelihood interval of ``weights`` (2,) times the parameters, in their unit [-]: the region's
        projection.
        """
        inside = self.points[self.rise <= self.threshold] @ weights
        return float(inside.min()), float(inside.max())

    @property
    def covariance(self) -> Array:
        """Of the parameters [-], (2, 2), by the likelihood over the grid: smooth in it, as no point at its edge is."""
        likelihood = np.exp(-0.5 * NORMAL_95**2 * self.rise / self.threshold)
        return np.cov(self.points.T, aweights=likelihood)

    @property
    def lowest(self) -> Array:
        """Where the misfit is least: (2,) [-], as ``points``."""
        return np.asarray(self.points[int(np.argmin(self.rise))])

    @property
    def bounded(self) -> bool:
        """Whether the 95 % region ends before the rim."""
        return not bool((self.edge & (self.rise <= self.threshold)).any())


def surface(misfit: Misfit, best: Array, covariance: Array, threshold: float) -> Surface:
    """Follow the misfit about ``best`` (2,) in the directions of a first ``covariance`` (2, 2), on both sides of each
    [-].

    ``threshold`` is the rise of the misfit at the 95 % limit. A bicubic spline through NODES x NODES runs of the model
    stands for it in between.
    """
    reach = REACH * float(np.sqrt(threshold))
    spread = reach * np.linalg.cholesky(covariance)
    nodes, axis = np.linspace(-1.0, 1.0, NODES), np.linspace(-1.0, 1.0, SURFACE_POINTS)
    values = np.array([[misfit(best + spread @ np.array([x, y])) for y in nodes] for x in nodes])
    values = np.minimum(values - values.min(), CEILING * threshold)
    between = _cubic(nodes, axis)
    fine = (between @ values @ between.T).ravel()
    x, y = (grid.ravel() for grid in np.meshgrid(axis, axis, indexing="ij"))
    edge = (np.abs(x) > 0.999) | (np.abs(y) > 0.999)
    return Surface(best + np.column_stack((x, y)) @ spread.T, np.maximum(fine, 0.0), edge, threshold)


def _cubic(nodes: Array, at: Array) -> Array:
    """Weights (k, n) of values at ``nodes`` (n,) in the cubic spline through them at ``at`` (k,).

    It has no knot at the second node and the last but one: as many pieces as values tell (de Boor, A Practical Guide to
    Splines, chapter IV).
    """

    def columns(x: Array) -> Array:
        powers, after = np.vander(x, 4, increasing=True), np.maximum(x[:, np.newaxis] - nodes[2:-2], 0.0)
        return np.hstack([powers, after**3])

    return np.asarray(np.linalg.solve(columns(nodes).T, columns(at).T).T)
