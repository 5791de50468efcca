"""A surface that fades as the fuel ends, fitted from where it fades as long as the fire did.

The slopes at a small one do not lead there: no score test sees it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fitting.fit import Fit
from hfanalysis.diagnose.fitting.predict import faded
from hfanalysis.diagnose.naming.candidate import followed
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.observations.observed import FADE, Observed

Array = NDArray[np.float64]

STRENGTH, SHAPES = 1.2, np.linspace(-4.0, 2.0, 25)
"""Strength and first shape (as x) of the surfaces of which the one is taken that fades as long as measured."""


def fades(search: Search, name: str) -> bool:
    """Whether how long the fire took to go out tells of an effect."""
    return FADE in search.bench.observed.stated and search.catalogue.effects[name].fading_web is not None


def fading_fit(parent: Fit, search: Search, name: str, observed: Observed) -> Fit | None:
    """A fit with a surface that fades besides; None where it cannot be run."""
    made = search.catalogue.add(parent.hypothesis, name)
    own, strengths = slice(parent.x.size, None), search.catalogue.effects[name].strengths

    def start(shape: float) -> Array:
        x = np.concatenate([parent.x, np.zeros(made.size - parent.x.size)])
        x[parent.x.size : parent.x.size + strengths] = STRENGTH
        x[parent.x.size + strengths] = shape
        return x

    nearest = min(map(start, SHAPES.tolist()), key=lambda x: abs(faded(observed, parent.burnt, made.at(x))))
    return followed(made, own, observed, nearest)
