"""How large the slow noise of each sensor is: a quiet time of four seconds tells it to a factor of 1.4.

Noise that is correlated over half a second shows a few independent values in the quiet time before the opening, and
some ten times as many in a firing. So its size is an unknown of every hypothesis, one factor per channel with a
log-normal prior; an explanation that leaves little open is believed to be read by sensors that are quiet. The evidence
is Laplace's, about the best factors, with the parameters of the fit integrated over where their slopes hold.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky, solve_triangular

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.noise import SlowNoise

FARTHEST_FACTOR = 1.2
"""Log of a factor of the slow noise [natural log] beyond which none is thought of."""

STEPS, STRIDE, CONVERGED = 12, 0.5, 1e-2
"""Of Fisher's scoring: its steps, the longest of them, and the shortest that is worth one, in logs of factors: what is
left beyond it is worth some 1e-3 of log evidence."""


def louder_or_quieter(residual: Array, slopes: Array, x: Array, noise: SlowNoise) -> float:
    """What the log evidence gains [natural log] where the slow noise of each channel is as large as the residual asks
    for.

    Args:
        residual: whitened (observations,), about the most probable parameters; blocks come first.
        slopes: of the residual (observations, parameters).
        x: the parameters (parameters,) in prior standard deviations, whose priors are N(0, 1).
        noise: what of the whitened noise is slow.
    """
    if noise.shares.size == 0:
        return 0.0
    blocks = noise.patterns.shape[0]
    level = _Level(
        noise.patterns.T @ residual[:blocks],
        noise.patterns.T @ slopes[:blocks],
        slopes.T @ slopes + np.eye(x.size),
        slopes.T @ residual + x,
        noise.shares,
        noise.unsure,
    )
    log_factor = np.zeros(noise.shares.shape[0])
    here = level.at(log_factor)
    for _ in range(STEPS):
        step = np.linalg.solve(here.information, here.gradient)
        step *= min(1.0, STRIDE / max(float(np.abs(step).max()), 1e-12))
        moved = None
        while moved is None and float(np.abs(step).max()) > CONVERGED:
            trial = level.at(np.clip(log_factor + step, -FARTHEST_FACTOR, FARTHEST_FACTOR))
            if trial.gain > here.gain:
                log_factor, moved = np.clip(log_factor + step, -FARTHEST_FACTOR, FARTHEST_FACTOR), trial
            step = 0.3 * step
        if moved is None:
            break
        here = moved
    return here.gain - 0.5 * float(np.linalg.slogdet(here.information * noise.unsure[:, None] ** 2)[1])


@dataclass(frozen=True)
class _At:
    """Log posterior density of factors relative to factors of one, its gradient, and Fisher's information."""

    gain: float
    gradient: Array
    information: Array


@dataclass(frozen=True)
class _Level:
    """What the patterns of slow noise hold: of the residual (patterns,), of its slopes (patterns, parameters), with the
    ``curvature`` that all observations give the parameters, the ``gradient`` there, which is none where a fit has come
    to its end, the ``shares`` of channels (channels, patterns), and how ``unsure`` their factors are (channels,)."""

    left: Array
    slopes: Array
    curvature: Array
    gradient: Array
    shares: Array
    unsure: Array

    @cached_property
    def _as_it_is(self) -> tuple[float, float]:
        """With factors of one: log of the curvature's determinant, and what a last step would take off chi-square."""
        root = cholesky(self.curvature, lower=True)
        last = solve_triangular(root, self.gradient, lower=True)
        return 2.0 * float(np.log(root.diagonal()).sum()), float(last @ last)

    @cached_property
    def _own(self) -> list[NDArray[np.intp]]:
        """Patterns that hold anything of a channel's slow noise."""
        return [np.flatnonzero(share) for share in self.shares]

    def at(self, log_factor: Array) -> _At:
        """With these factors of the channels' slow noise (logs).

        The noise in a pattern is then of variance v instead of 1, and the parameters follow by a step.
        """
        squares = np.exp(2.0 * log_factor)
        variance = 1.0 + (squares - 1.0) @ self.shares
        extra = 1.0 / variance - 1.0
        root = cholesky(self.curvature + self.slopes.T @ (extra[:, None] * self.slopes), lower=True)
        step = -cho_solve((root, True), self.gradient + self.slopes.T @ (extra * self.left))
        size, lower = self._as_it_is
        grown = 2.0 * float(np.log(root.diagonal()).sum()) - size
        misfit = float(extra @ self.left**2 - np.sum((root.T @ step) ** 2)) + lower
        prior = float(np.sum((log_factor / self.unsure) ** 2))
        gain = -0.5 * (float(np.log(variance).sum()) + grown + misfit + prior)
        # R, the inverse of the marginal covariance, in the patterns: 1 / v less what the parameters take, a matrix of
        # low rank; and traces of R dV/df R dV/dg
        known = 1.0 / variance
        taken = solve_triangular(root, (self.slopes * known[:, None]).T, lower=True)
        lost = np.sum(taken**2, axis=0)
        pull = (self.left + self.slopes @ step) * known
        speed = 2.0 * squares[:, None] * self.shares
        gradient = 0.5 * speed @ (pull**2 - known + lost) - log_factor / self.unsure**2
        of_channels = np.array(
            [(taken[:, own] * part[own]) @ taken[:, own].T for part, own in zip(speed, self._own, strict=True)]
        )
        information = speed @ ((known * (known - 2.0 * lost))[:, None] * speed.T)
        information += np.tensordot(of_channels, of_channels, axes=([1, 2], [1, 2]))
        return _At(gain, gradient, 0.5 * information + np.diag(self.unsure**-2.0))
