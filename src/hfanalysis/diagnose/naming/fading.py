"""A surface that fades as the fuel ends, fitted from where it fades as long as the fire did.

The slopes at a small one do not lead there: no score test sees it. Where it fades so gradually that no instant tells
when the fuel is gone, the base model burns fuel that is not there to the end, and has bent a and n to that.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.engine.equations import RADIUS
from hfanalysis.inference.candidate import followed
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import faded
from hfanalysis.inference.observations.observed import FADE, Observed

STRENGTH, SHAPES = 1.2, np.linspace(-4.0, 2.0, 25)
"""Strength and first shape (as x) of the surfaces of which the one is taken that fades as long as measured."""


FROM_SHAPES = np.linspace(-3.0, 1.0, 5)
"""First shapes (as x) of the surfaces that a fit starts from where nothing says how long they take to fade."""


def fades(search: Search, name: str) -> bool:
    """Whether how long the fire took to go out tells of an effect."""
    return FADE in search.bench.observed.stated and search.catalogue.effects[name].fading_web is not None


def fading_fit(parent: Fit, search: Search, name: str, observed: Observed) -> Fit | None:
    """A fit with a surface that fades besides; None where it cannot be run."""
    made = search.catalogue.add(parent.hypothesis, name)
    starts = [_start(made, search, name, parent.x, shape) for shape in SHAPES.tolist()]
    nearest = min(starts, key=lambda x: abs(faded(observed, parent.burnt, made.at(x))))
    return followed(made, slice(parent.x.size, None), observed, nearest)


def fades_unseen(fits: Iterable[Fit], search: Search, name: str, observed: Observed) -> bool:
    """Whether one of these fits burns all of its fuel before the last that is compared, and no end of it was seen."""
    if search.catalogue.effects[name].fading_web is None or "t_fuel_out" in observed.events:
        return False
    return any(_burns_all(fit, observed.end) for fit in fits)


def _burns_all(fit: Fit, end: float) -> bool:
    radius = fit.burnt.steps.at(np.array([end]))[0][0, RADIUS]
    return bool(radius > fit.hypothesis.engine.outer_radius)


def unseen_fits(parent: Fit, search: Search, name: str, observed: Observed) -> list[Fit | None]:
    """Fits with a surface that fades besides, from the parent's constants and from those that are likely beforehand."""
    made = search.catalogue.add(parent.hypothesis, name)
    starts = [
        _start(made, search, name, constants, shape)
        for constants in (parent.x, np.zeros(parent.x.size))
        for shape in FROM_SHAPES.tolist()
    ]
    return [followed(made, slice(parent.x.size, None), observed, x) for x in starts]


def _start(made: Hypothesis, search: Search, name: str, constants: Array, shape: float) -> Array:
    """These constants with a surface that fades by STRENGTH and such a first shape."""
    strengths = search.catalogue.effects[name].strengths
    x = np.concatenate([constants, np.zeros(made.size - constants.size)])
    x[constants.size : constants.size + strengths] = STRENGTH
    x[constants.size + strengths] = shape
    return x
