"""An unknown source over time, as a fit has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fitting.fit import Fit
from hfanalysis.diagnose.fitting.late import delay_name
from hfanalysis.diagnose.fitting.pulse import START, has_pulse, parameters_of, pulse_in
from hfanalysis.diagnose.naming.sites import CLOCK, Site, site_of
from hfanalysis.diagnose.observations.observed import Observed

Array = NDArray[np.float64]

POINTS = 200
"""Instants at which a source is given."""

STEP = 1e-3
"""Of x, for the slopes of a pulse."""


@dataclass(frozen=True)
class Course:
    """A source over time as a fit has it: ``mean`` and ``std`` at ``time`` [s] in the site's unit.

    ``blur``: the standard deviation of the instants at which it begins and ends [s].
    """

    site: Site
    time: Array
    mean: Array
    std: Array
    blur: float


def course_of(found: Fit, name: str, observed: Observed) -> Course:
    """An unknown source as a fit has it; ``name`` is that of its site."""
    site, time = site_of(name, observed), np.linspace(0.0, float(observed.grid[~observed.resting][-1]), POINTS)
    if name.startswith(CLOCK):
        return _course_of_delay(found, site, time)
    if has_pulse(found.hypothesis, name):
        return _course_of_pulse(found, site, time)
    for block, place in found.hypothesis.places():
        if block.names[0].startswith(_prefix(site)):
            basis = block.splines.at(time) @ block.matrix
            covariance = found.covariance[place, place]
            std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, covariance, basis), 0.0))
            return Course(site, time, basis @ found.x[place], std, 0.5 * block.splines.spacing)
    raise ValueError(f"the fit has no source at {name}")


def _course_of_delay(found: Fit, site: Site, time: Array) -> Course:
    assert site.sensor is not None
    name = delay_name(site.sensor)
    return Course(site, time, np.full_like(time, found.values[name]), np.full_like(time, found.stds[name]), 0.0)


def _course_of_pulse(found: Fit, site: Site, time: Array) -> Course:
    names = [f.name for f in found.hypothesis.free]
    own = [names.index(name) for name in parameters_of(site.name)]
    mean = pulse_in(found.hypothesis, found.x, site.name, time)
    slopes = np.empty((time.size, len(own)))
    for column, k in enumerate(own):
        moved = found.x.copy()
        moved[k] += STEP
        slopes[:, column] = (pulse_in(found.hypothesis, moved, site.name, time) - mean) / STEP
    covariance = found.covariance[np.ix_(own, own)]
    std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, covariance, slopes), 0.0))
    return Course(site, time, mean, std, found.stds[parameters_of(site.name)[START]])


def _prefix(site: Site) -> str:
    return f"offset_{site.sensor}." if site.sensor is not None else f"probe_{site.name}."
