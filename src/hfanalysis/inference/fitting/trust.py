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
from hfanalysis.compiled import compiled, inner
from hfanalysis.engine.rosenbrock import factorize, substitute

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
    return _step_within(radius, gradient, curvature, *box)


@compiled(nogil=True)
def _step_within(radius: float, gradient: Array, curvature: Array, least: Array, most: Array) -> Array:
    units = np.sqrt(np.diag(curvature))
    step = _bounded_step(gradient, curvature, least, most, LEAST_DAMPING)
    if np.sqrt(np.sum((units * step) ** 2)) <= radius:
        return step
    low, high = np.log(LEAST_DAMPING), np.log(MOST_DAMPING)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        tried = _bounded_step(gradient, curvature, least, most, np.exp(middle))
        if np.sqrt(np.sum((units * tried) ** 2)) > radius:
            low = middle
        else:
            high, step = middle, tried
    return step


def bounded_step(gradient: Array, curvature: Array, box: tuple[Array, Array], damping: float) -> Array:
    """The damped Gauss-Newton step (parameters,) in its box: the lowest point there of the damped parabola.

    By active sets: whatever reaches a side on the way stays there and the others go on without it; once they are at
    rest, what is drawn back inside most is set free again. All the way it is downhill.
    """
    return np.asarray(_bounded_step(gradient, curvature, *box, damping))


@compiled(nogil=True)
def _bounded_step(gradient: Array, curvature: Array, least: Array, most: Array, damping: float) -> Array:
    size = gradient.size
    damped = curvature.copy()
    for i in range(size):
        damped[i, i] += damping * curvature[i, i]
    free, step, part = np.ones(size, dtype=np.bool_), np.zeros(size), np.zeros(size)
    for _ in range(MOST_CHANGES * size):
        if free.any():
            _go_on(step, free, gradient, damped, least, most, part)
            if part.min() < 1.0:
                nearest = part.min()
                for i in range(size):
                    free[i] = free[i] and part[i] > nearest
                continue
        back = _drawn_back(step, free, gradient, damped, least, most)
        if back < 0:
            break
        free[back] = True
    return np.minimum(np.maximum(step, least), most)


@inner
def _go_on(
    step: Array, free: NDArray[np.bool_], gradient: Array, curvature: Array, least: Array, most: Array, part: Array
) -> None:
    """Lengthen a step, in place, by what is free of it: to the lowest point, or to the first side of the box.

    ``part`` (parameters,): the parts of the way after which each comes to its side.
    """
    places = np.flatnonzero(free)
    onward, matrix = np.zeros(places.size), np.zeros((places.size, places.size))
    for k in range(places.size):
        onward[k] = -gradient[places[k]]
        for j in range(step.size):
            onward[k] -= curvature[places[k], j] * step[j]
        for j in range(places.size):
            matrix[k, j] = curvature[places[k], places[j]]
    pivots = np.zeros(places.size, dtype=np.int64)
    factorize(matrix, pivots)
    substitute(matrix, pivots, onward)
    part[:] = np.inf
    for k in range(places.size):
        i = places[k]
        if onward[k] != 0.0:  # what hardly moves never comes to its side
            part[i] = ((most[i] if onward[k] > 0.0 else least[i]) - step[i]) / onward[k]
    way = min(1.0, max(part.min(), 0.0))
    for k in range(places.size):
        step[places[k]] += way * onward[k]


@inner
def _drawn_back(
    step: Array, free: NDArray[np.bool_], gradient: Array, curvature: Array, least: Array, most: Array
) -> int:
    """Which parameter at a side of the box is drawn back inside most, -1 if none is."""
    back, strongest, steepest = -1, 0.0, 0.0
    for i in range(step.size):
        unit = np.sqrt(curvature[i, i])
        steepest = max(steepest, abs(gradient[i]) / unit)
        if not free[i] and least[i] != most[i]:
            slope = gradient[i]
            for j in range(step.size):
                slope += curvature[i, j] * step[j]
            inward = (-slope if step[i] - least[i] < most[i] - step[i] else slope) / unit
            if inward > strongest:
                back, strongest = i, inward
    return back if strongest > AT_REST * steepest else -1


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
