"""Least squares of two parameters in a box: damped Gauss-Newton steps, with slopes by differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hfanalysis.arrays import Array

STEP = 1e-3
"""Of a parameter, for a slope [-]. Evidence: ln r and n are told to 0.01 at best, and burns are smooth to far less."""

HELD = 2e-3
"""Step [-] from which on slopes are those of the step before. Evidence: what the slopes change by moves the end by less
than a hundredth of its standard deviation (test_descent.py)."""

LONGEST = 0.5
"""Step [-] beyond which no slope is believed."""

MOST = 60
"""Steps at most."""

DAMPING = 1e-2
"""What a step that leads up is damped by at first, relative to the curvature [-]. Source: Marquardt, SIAM Journal 11,
1963; ten times as much at each further one."""

Residuals = Callable[[Array], Array | None]


def least(residual: Residuals, precision: Array, start: Array, box: tuple[Array, Array], within: float) -> Array:
    """Where r' P r is least in a ``box`` (low (2,), high (2,)), found from ``start`` (2,) to ``within`` [-].

    ``residual`` (n,) is None where there is no model; ``precision`` is P (n, n). A start without a model stays.

    >>> line = lambda x: np.array([x[0] + x[1] - 3.0, x[0] - x[1] - 1.0])
    >>> found = least(line, np.eye(2), np.zeros(2), (np.full(2, -9.0), np.full(2, 9.0)), 1e-6)
    >>> found.round(6).tolist()
    [2.0, 1.0]
    """
    x = np.clip(start, *box)
    left = residual(x)
    if left is None:
        return x
    misfit, slopes, of, damping = left @ precision @ left, _slopes(residual, x, left), x, 0.0
    for _ in range(MOST):
        trial = x + _step(slopes, precision, left, (box[0] - x, box[1] - x), damping)
        there, size = residual(trial), float(np.abs(trial - x).max())
        if there is not None and (value := there @ precision @ there) <= misfit:
            x, left, misfit, damping = trial, there, value, 0.1 * damping
            renewed = size >= HELD
        else:
            renewed = of is not x  # slopes of another point may lead up where this point's do not
            damping = damping if renewed else max(10.0 * damping, DAMPING)
        if size < within and not (renewed and of is not x):
            break
        if renewed:
            slopes, of = _slopes(residual, x, left), x
    return x


def _slopes(residual: Residuals, x: Array, here: Array) -> Array:
    """Change of the residuals by each parameter (n, 2); none where there is no model on either side."""
    columns = []
    for axis in np.eye(2) * STEP:
        after = residual(x + axis)
        before = here if after is not None else residual(x - axis)
        after = here if after is None else after
        columns.append((after - (after if before is None else before)) / STEP)
    return np.column_stack(columns)


def _step(slopes: Array, precision: Array, left: Array, room: tuple[Array, Array], damping: float) -> Array:
    """The damped step (2,); where it would leave the box, along its side."""
    weighed = precision @ slopes
    curvature, down = slopes.T @ weighed, -(left @ weighed)
    curvature = curvature + np.diag(damping * np.diag(curvature) + 1e-12 * np.trace(curvature) + 1e-300)
    step = np.linalg.solve(curvature, down)
    step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
    for i, j in ((0, 1), (1, 0)):
        if not room[0][i] <= step[i] <= room[1][i]:
            step[i] = np.clip(step[i], room[0][i], room[1][i])
            step[j] = (down[j] - curvature[j, i] * step[i]) / curvature[j, j]
    return np.clip(step, *room)
