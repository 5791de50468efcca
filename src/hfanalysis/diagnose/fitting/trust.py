"""How far the slopes of a fit are trusted: a region about its point, in deviations of every parameter alone.

A Gauss-Newton step leads far along what the data hardly tell, where slopes soon hold no longer. It is damped
(Levenberg, Marquardt) so as to stay within a region that grows where a step brought what the slopes promised and
shrinks where it did not, by as much as a parabola through what it did bring asks for (Moré, The Levenberg-Marquardt
algorithm: implementation and theory, Lecture Notes in Mathematics 630 (1978) 105).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_DAMPING = 1e-9
DAMPINGS = np.geomspace(LEAST_DAMPING, 1e6, 91)

GOOD, POOR = 0.75, 0.25
"""Parts of what the slopes promised of a step: from the one on the region grows, and below the other it shrinks."""

GROWTH = 2.0
"""Of the region, over the length of the step that was good."""

SHRINKAGE = 0.1, 0.5
"""The least and the greatest part of a step's length that the region shrinks to."""


def damping_within(curvature: Array, gradient: Array, free: NDArray[np.bool_], radius: float) -> float:
    """The least damping whose step stays within ``radius``, with the parameters that are not ``free`` at rest.

    Of a curvature (parameters, parameters) and a gradient (parameters,); damping is relative to the curvature's
    diagonal.
    """
    if not free.any() or radius == np.inf:
        return LEAST_DAMPING
    units = np.sqrt(curvature.diagonal()[free])
    values, vectors = np.linalg.eigh(curvature[np.ix_(free, free)] / np.outer(units, units))
    pull = vectors.T @ (gradient[free] / units)
    lengths = np.linalg.norm(pull / (np.maximum(values, 0.0) + DAMPINGS[:, np.newaxis]), axis=1)
    if lengths[0] <= radius:
        return LEAST_DAMPING
    return float(np.exp(np.interp(-np.log(radius), -np.log(lengths), np.log(DAMPINGS))))


def length_of(step: Array, curvature: Array) -> float:
    """A step's length in deviations of every parameter alone."""
    return float(np.linalg.norm(np.sqrt(curvature.diagonal()) * step))


def shrunk(length: float, part: float) -> float:
    """The region after a step of that length that brought only a ``part`` of what its slopes promised (NaN: no run)."""
    least, most = SHRINKAGE
    return length * (least if np.isnan(part) else min(max(1.0 / (2.0 - part), least), most))


def grown(radius: float, length: float, part: float) -> float:
    """The region after a step that was taken."""
    if part > GOOD:
        return max(radius, GROWTH * length)
    return SHRINKAGE[1] * length if part < POOR else radius
