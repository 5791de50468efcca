"""How far the slopes of a fit are trusted: a region about its point, in deviations of every parameter alone.

A Gauss-Newton step leads far along what the data hardly tell, where slopes soon hold no longer. It is damped
(Levenberg, Marquardt) so as to stay within a region that grows where a step brought what the slopes promised and
shrinks where it did not, by as much as a parabola through what it did bring asks for (Moré, The Levenberg-Marquardt
algorithm: implementation and theory, Lecture Notes in Mathematics 630 (1978) 105).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array

LONGEST_STRIDE = 2.0
"""Standard deviations of its prior that a parameter moves at a time. Evidence: where a whole step was shortened for one
parameter that the data do not tell, fits from a moderate size ended 1e5 short of the base model they started beside."""

LEAST_DAMPING, MOST_DAMPING = 1e-9, 1e6
HALVINGS = 12
"""Of the logarithm of damping, to find the least that will do."""

MOST_CHANGES, AT_REST = 4, 1e-9
"""Changes of what is free in a step, for each parameter, and the part of the steepest slope that moves nothing."""

GOOD, POOR = 0.75, 0.25
"""Parts of what the slopes promised of a step: from the one on the region grows, and below the other it shrinks.
Source: Nocedal and Wright, Numerical Optimization, chapter 4."""

GROWTH = 2.0
"""Of the region, over the length of the step that was good."""

SHRINKAGE = 0.1, 0.5
"""The least and the greatest part of a step's length that the region shrinks to."""


def box_about(x: Array, least: Array, most: Array) -> tuple[Array, Array]:
    """The least and the greatest step (parameters,) from ``x`` (parameters,) that keeps bounds, no parameter farther
    than LONGEST_STRIDE; all in prior standard deviations."""
    return np.maximum(least - x, -LONGEST_STRIDE), np.minimum(most - x, LONGEST_STRIDE)


def step_within(radius: float, gradient: Array, curvature: Array, box: tuple[Array, Array]) -> Array:
    """The step (parameters,) of least damping that is no longer than ``radius`` and stays in its ``box``.

    Of an objective's gradient (parameters,) and curvature (parameters, parameters), and of the least and the greatest
    step of every parameter (parameters,); parameters in prior standard deviations, ``radius`` as :func:`length_of`.
    Damping is relative to the curvature's diagonal. It is the step in its box that is measured: where some parameters
    come to rest at their bounds, the others may go the farther for it.
    """
    step = bounded_step(gradient, curvature, box, LEAST_DAMPING)
    if length_of(step, curvature) <= radius:
        return step
    low, high = np.log(LEAST_DAMPING), np.log(MOST_DAMPING)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        tried = bounded_step(gradient, curvature, box, float(np.exp(middle)))
        if length_of(tried, curvature) > radius:
            low = middle
        else:
            high, step = middle, tried
    return step


def bounded_step(gradient: Array, curvature: Array, box: tuple[Array, Array], damping: float) -> Array:
    """The damped Gauss-Newton step (parameters,) in its box: the lowest point there of the damped parabola.

    By active sets: whatever reaches a side on the way stays there and the others go on without it; once they are at
    rest, what is drawn back inside most is set free again. All the way it is downhill.
    """
    curvature = curvature + damping * np.diag(curvature.diagonal())
    free, step = np.ones(gradient.size, dtype=bool), np.zeros(gradient.size)
    for _ in range(MOST_CHANGES * gradient.size):
        if free.any():
            part = _go_on(step, free, gradient, curvature, box)
            if part.min() < 1.0:
                free &= part > part.min()
                continue
        back = _drawn_back(step, free, gradient, curvature, box)
        if back is None:
            break
        free[back] = True
    return np.asarray(np.clip(step, *box))


def _go_on(step: Array, free: NDArray[np.bool_], gradient: Array, curvature: Array, box: tuple[Array, Array]) -> Array:
    """Lengthen a step, in place, by what is free of it: to the lowest point, or to the first side of the box.

    Returns the parts of the way (parameters,) after which each comes to its side.
    """
    least, most = box
    onward = np.zeros(gradient.size)
    pull = gradient[free] + curvature[free] @ step
    onward[free] = -np.linalg.solve(curvature[np.ix_(free, free)], pull)
    room = np.where(onward > 0.0, most, least) - step
    with np.errstate(over="ignore"):  # what hardly moves never comes to its side
        part = np.divide(room, onward, out=np.full(step.size, np.inf), where=onward != 0.0)
    step += min(1.0, max(float(part.min()), 0.0)) * onward
    return np.asarray(part)


def _drawn_back(
    step: Array, free: NDArray[np.bool_], gradient: Array, curvature: Array, box: tuple[Array, Array]
) -> int | None:
    """Which parameter at a side of the box is drawn back inside most, None if none is."""
    least, most = box
    units = np.sqrt(curvature.diagonal())
    slope = (gradient + curvature @ step) / units
    inward = np.where(free | (least == most), 0.0, np.where(step - least < most - step, -slope, slope))
    back = int(np.argmax(inward))
    return back if inward[back] > AT_REST * float(np.abs(gradient / units).max()) else None


def learnt(curvature: Array, step: Array, change: Array) -> Array:
    """The curvature (parameters, parameters) by which a ``step`` changes the gradient as it did, else nearly as it was.

    The BFGS update (Nocedal and Wright, Numerical Optimization, 2006, eq. 6.19); as it was where the gradient fell off.
    """
    along, pull = float(step @ change), curvature @ step
    if along <= LEAST_DAMPING * float(step @ pull):
        return curvature
    return curvature + np.outer(change, change) / along - np.outer(pull, pull) / float(step @ pull)


def length_of(step: Array, curvature: Array) -> float:
    """A step's length [standard deviations] in those of every parameter alone; ``step`` (parameters,), ``curvature``
    (parameters, parameters).

    >>> length_of(np.array([3.0, 4.0]), np.eye(2))
    5.0
    """
    return float(np.linalg.norm(np.sqrt(curvature.diagonal()) * step))


def shrunk(length: float, part: float) -> float:
    """The region [standard deviations] after a step of that length that brought only a ``part`` [-] of what its slopes
    promised (NaN: no run)."""
    least, most = SHRINKAGE
    return length * (least if np.isnan(part) else min(max(1.0 / (2.0 - part), least), most))


def grown(radius: float, length: float, part: float) -> float:
    """The region [standard deviations] after a step of that length that was taken and brought a ``part`` [-] of what
    was promised."""
    if part > GOOD:
        return max(radius, GROWTH * length)
    return SHRINKAGE[1] * length if part < POOR else radius
