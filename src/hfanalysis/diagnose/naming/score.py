"""Score tests: how much an effect more would explain, from the slopes at a small strength of it.

The calibrated constants are projected out: only what they cannot take over counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.variants import Settings
from hfanalysis.inference.fitting.fit import Fit, usable
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.observations.observed import Observed

STARTS = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Standard deviations from its prior's center at which the parameter of an effect's shape may start, if it has one."""

FEW_STARTS = (-1.2, 0.0, 1.2)
"""The same of each parameter if there are more."""

FIRST_STEP = 0.05
"""Strength, in units of the typical one (as x), at which slopes of an effect are taken."""

MOST_FIRST = 1.5
"""The largest strength (as x) at which a fit starts."""


Test = tuple[float, Array]
"""The gain in log probability that a start promises, and that start."""


def score_tests(
    parent: Fit,
    slopes: Sequence[Array],
    catalogue: Catalogue,
    name: str,
    forms: Sequence[Observed],
    settings: Settings,
    shape_starts: Sequence[float] = (),
) -> tuple[Hypothesis, list[list[Test]]]:
    """The parent with an effect more, and for each form the starts (parameters,), in prior standard deviations, with
    the gain [natural log] that they promise, the best first.

    ``slopes`` (observations, parameters), whitened, of the parent at each form, which hardly change by a small effect.
    The starts are those of the shape (each of its parameters at ``shape_starts``, in standard deviations of its prior,
    where they are given), the strengths as the score test sees them.
    """
    made = catalogue.add(parent.hypothesis, name)
    least, most = made.bounds
    size = parent.x.size
    own = slice(size, size + catalogue.effects[name].strengths)
    shapes = [i for i in range(own.stop, made.size) if made.free[i].shape == "positive" and made.free[i].unsure]
    found: list[list[Test]] = [[] for _ in forms]
    for choice in product(shape_starts or (STARTS if len(shapes) == 1 else FEW_STARTS), repeat=len(shapes)):
        start = np.concatenate([parent.x, np.zeros(made.size - size)])
        start[shapes] = choice
        start[own] = FIRST_STEP
        start = np.clip(start, least, most)
        try:
            there = predict(made, forms[0], start, tangents=True, only=own)
        except (ValueError, ArithmeticError):
            continue
        if there.slopes is None or not usable(there) or not np.isfinite(there.residual).all():
            continue
        for tests, observed, of_parent in zip(found, forms, slopes, strict=True):
            residual, by_strength = there.residual, there.slopes
            if observed is not forms[0]:
                residual, by_strength = (observed.rewhitened(rows, forms[0]) for rows in (residual, by_strength))
            both = np.column_stack([of_parent, by_strength])
            gain, strength = score(both, residual, start, own, (least, most), settings.projection)
            promising = start.copy()
            promising[own] = np.clip(strength, -MOST_FIRST, MOST_FIRST)
            tests.append((gain, promising))
    return made, [sorted(tests, key=lambda test: -test[0]) for tests in found]


def score(
    slopes: Array, residual: Array, x: Array, own: slice, bounds: tuple[Array, Array], projection: bool = True
) -> tuple[float, Array]:
    """Gain in log probability [natural log] by strengths ``own``, with the parameters before them projected out, and
    the strengths (strengths,) in prior standard deviations.

    ``slopes`` (observations, parameters) of the whitened ``residual`` (observations,) at ``x`` (parameters,), whose
    prior is N(0, 1); ``bounds``: least and most of x (parameters,).
    """
    a, b = slopes[:, : own.start], slopes[:, own]
    still = residual - b @ x[own]
    still_x = x[: own.start]
    if projection:
        curvature = a.T @ a + np.eye(a.shape[1])
        through = np.linalg.solve(curvature, a.T)
        start = still - a @ still_x  # the parameters at their prior's center
        clear = b - a @ (through @ b)
        information, pull = b.T @ clear, -(clear.T @ start)
    else:
        information, pull = b.T @ b, -(b.T @ still)
    strength = np.linalg.solve(information + np.eye(pull.size), pull)
    strength = np.clip(strength, bounds[0][own], bounds[1][own])
    gain = float(pull @ strength - 0.5 * strength @ (information + np.eye(pull.size)) @ strength)
    return gain, strength
