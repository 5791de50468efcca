"""What the model may lack that has no name: one file each, found by its name; a further one is one file more.

Such a file holds an ``UNKNOWN``: a class of :class:`hfanalysis.inference.unknown.Unknown`.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules

from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.linear import Linearized
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import Described, LinearUnknown, Samples, Unknown
from hfanalysis.products.diagnosis import Place


@lru_cache(maxsize=1)
def kinds() -> tuple[type[Unknown], ...]:
    """Every kind of unknown, in the order of their files' names."""
    return tuple(import_module(f"{__name__}.{m.name}").UNKNOWN for m in iter_modules(__path__))


def in_samples(samples: Samples) -> tuple[Unknown, ...]:
    """What the samples show without any model."""
    found = (kind.in_samples(samples) for kind in kinds())
    return tuple(unknown for unknown in found if unknown is not None)


def in_slopes(fitted: Fit, observed: Observed) -> list[LinearUnknown]:
    """What a fit leaves open, linear about it, the best first.

    Raises ValueError or ArithmeticError where the engine cannot be run with all places open.
    """
    about = Linearized(fitted, observed)
    return sorted((unknown for kind in kinds() for unknown in kind.in_slopes(about)), key=lambda u: -u.log_evidence)


def kind_of(row: Place) -> type[Described] | None:
    """The kind that has words of its own for a row of the localisation."""
    described = (kind for kind in kinds() if issubclass(kind, Described))
    return next((kind for kind in described if row.known_by(kind.known_by) is not None), None)
