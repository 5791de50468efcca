"""Localisation: at which equation, from when to when and how much, before any effect is named.

At every site of the model an unknown source over time is tried, with all calibrated parameters free: splines with a
Gaussian prior, linear in the tangents of the base fit, or a pulse, which comes and goes at once. The evidence of each
says where the source is; the best few are fitted again with the full model, since a large source is not linear.
Sensors are sites too: an offset over time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.naming.places import SITES, Site, sensor_site
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Block, Hypothesis
from hfanalysis.inference.fitting.predict import AFTER, sensor_slopes, slopes_of, with_spare_fuel
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknowns.pulse import Pulse, with_pulse
from hfanalysis.inference.unknowns.smooth_source import Splines, probe

Array = NDArray[np.float64]

SCALES = np.geomspace(0.02, 4.0, 9)
"""Sizes of a source that are tried, in units of what is typical of its site."""

SPACING = 0.6
"""Seconds between the splines of a source."""

WINDY, WIND_SPACING = ("thrust",), 0.25
"""Channels in which wind on the stand may be read, and the spacing of its splines [s]: it is faster than what an engine
does. What is slow in a sensor does not go with the flow: one that has drifted reads as much too much at rest."""

WETTED = tuple(site for site in SITES if site.name in ("tank_pressure", "injector_factor", "feed_loss"))
"""Sites at which a source may end with the liquid: what it does in tank, line and injector ends at once."""

FINE = 200
"""Instants at which pulses are laid over the splines."""

CORRELATIONS = 1.5, 5.0
"""Splines over which a source may be coherent: what changes slowly needs few numbers, and is found when it is weak."""


@dataclass(frozen=True)
class Smooth:
    """A smooth source as the linear search sees it: coefficients of splines, their ``scale``, and the log evidence.

    ``correlation``: splines over which it is coherent; ``nuisances``: where the calibrated constants then are (x).
    """

    site: Site
    log_evidence: float
    scale: float
    correlation: float
    coefficients: Array
    splines: Splines
    nuisances: Array

    def added_to(self, hypothesis: Hypothesis, share: float = 1.0) -> tuple[Hypothesis, Array]:
        """The hypothesis with this source, and the x of its parameters at a ``share`` of its size."""
        matrix = np.asarray(self.scale * np.linalg.cholesky(smooth_prior(self.splines.count, self.correlation)))
        start = np.asarray(share * np.linalg.solve(matrix, self.coefficients))
        if self.site.sensor is not None:
            names = tuple(f"offset_{self.site.sensor}.c{i}" for i in range(self.splines.count))
            return hypothesis.with_block(Block(names, matrix, self.splines, self.site.sensor)), start
        effect = probe(self.site.name, self.splines, self.site.typical)
        names = tuple(f"{effect.name}.c{i}" for i in range(self.splines.count))
        return hypothesis.with_block(Block(names, matrix, self.splines), effect.at(on=1.0)), start


@dataclass(frozen=True)
class Sudden:
    """A source that comes and goes at once, as the linear search sees it; ``end``: of what is compared [s]."""

    site: Site
    log_evidence: float
    pulse: Pulse
    end: float
    nuisances: Array

    def added_to(self, hypothesis: Hypothesis, share: float = 1.0) -> tuple[Hypothesis, Array]:
        """The hypothesis with this pulse, and the x of its parameters at a ``share`` of its size."""
        return with_pulse(hypothesis, self.site.name, replace(self.pulse, size=share * self.pulse.size), self.end)


Source = Smooth | Sudden


def smooth_prior(count: int, correlation: float) -> Array:
    """Covariance of the coefficients of a source of size one that is coherent over so many splines."""
    lag = np.arange(count)[:, None] - np.arange(count)[None, :]
    return np.asarray(np.exp(-0.5 * (lag / correlation) ** 2) + 1e-6 * np.eye(count))


@dataclass(frozen=True)
class _Projected:
    """Slopes and residual with the nuisances projected out, their priors counted; ``follow`` is how these then move."""

    information: Array
    pull: Array
    start: Array
    follow: Array


def _project(fitted: Fit, columns: Array) -> _Projected:
    a = fitted.slopes
    through = np.linalg.solve(a.T @ a + np.eye(a.shape[1]), a.T)
    # the fit has already moved the nuisances: what is left of the data is the residual less what they still explain
    r = fitted.residual - a @ fitted.x
    clear = columns - a @ (through @ columns)
    # (1 + A A^T)^-1 applied to columns and residual
    return _Projected(columns.T @ clear, -(clear.T @ r), -(through @ r), -(through @ columns))


class _Size(NamedTuple):
    """Of a smooth source: log evidence against none, scale, splines over which it is coherent, coefficients."""

    log_evidence: float
    scale: float
    correlation: float
    mean: Array


def _sizes(projected: _Projected, typical: float, correlation: float) -> list[_Size]:
    """A smooth source at every scale."""
    count, found = projected.pull.size, []
    root = np.linalg.cholesky(smooth_prior(count, correlation))
    information, pull = root.T @ projected.information @ root, root.T @ projected.pull
    for scale in SCALES * typical:
        inner = np.eye(count) + scale**2 * information
        solved = np.linalg.solve(inner, scale**2 * pull)
        gain = 0.5 * float(pull @ solved) - 0.5 * float(np.linalg.slogdet(inner)[1])
        found.append(_Size(gain, float(scale), correlation, np.asarray(root @ solved)))
    return found


def linear_sources(fitted: Fit, observed: Observed) -> list[Source]:
    """The smooth source and the sudden one at every site, linear about the fit, the best first."""
    end = float(observed.grid[~observed.resting][-1])
    splines = Splines.over(0.0, end, SPACING)
    found: list[Source] = []
    for site, projected in _projected(fitted, observed, SITES, splines):
        found += [_smooth(site, projected, splines), _sudden(site, projected, splines, end)]
    if "t_v" in observed.events:
        wet = Splines.over(0.0, observed.events["t_v"][0], SPACING, wet=True)
        found += [_smooth(site, projected, wet) for site, projected in _projected(fitted, observed, WETTED, wet)]
    slow, fast = replace(splines, held=True), Splines.over(0.0, end, WIND_SPACING)
    for name, own in [*((name, slow) for name in observed.names), *((name, fast) for name in WINDY)]:
        if name in observed.names and name not in _sensors(fitted):
            slopes_of_sensor = sensor_slopes(observed, name, own)
            found.append(_smooth(sensor_site(observed, name), _project(fitted, slopes_of_sensor), own))
    return sorted(found, key=lambda s: -s.log_evidence)


def _projected(
    fitted: Fit, observed: Observed, sites: Sequence[Site], splines: Splines
) -> list[tuple[Site, _Projected]]:
    """What splines at these sites change in the observations; none at a site that has a source."""
    engine = fitted.hypothesis.at(fitted.x)
    taken = {a.effect.name for a in engine.effects}
    probes = {site: probe(site.name, splines, site.typical) for site in sites}
    probes = {site: effect for site, effect in probes.items() if effect.name not in taken}
    probed = replace(engine, effects=(*engine.effects, *(effect.at(on=1.0) for effect in probes.values())))
    names = [f"{effect.name}.c{i}" for effect in probes.values() for i in range(splines.count)]
    tangents = run_with_tangents(
        with_spare_fuel(probed, observed.fuel_out), names, observed.longest + AFTER, run_on=True
    )
    slopes = slopes_of(fitted.hypothesis, observed, tangents)
    columns = np.split(slopes, len(probes), axis=1) if probes else []
    return [(site, _project(fitted, own)) for site, own in zip(probes, columns, strict=True)]


def _smooth(site: Site, projected: _Projected, splines: Splines) -> Smooth:
    sizes = [size for c in CORRELATIONS for size in _sizes(projected, site.typical, c)]
    best = max(sizes, key=lambda size: size.log_evidence)
    nuisances = projected.start + projected.follow @ best.mean
    return Smooth(site, best.log_evidence, best.scale, best.correlation, best.mean, splines, nuisances)


def _sudden(site: Site, projected: _Projected, splines: Splines, end: float) -> Sudden:
    """The best pulse among those that begin and end on a grid of half the splines' spacing.

    The price of each is that it is one of many.
    """
    grid = np.arange(0.0, end + splines.spacing, 0.5 * splines.spacing)
    first, last = (grid[i] for i in np.triu_indices(grid.size, 1))
    time = np.linspace(0.0, end, FINE)
    inside = (time >= first[:, None]) & (time < last[:, None])
    boxes = inside @ np.linalg.pinv(splines.at(time)).T  # the splines that come nearest to each
    information = np.einsum("ij,jk,ik->i", boxes, projected.information, boxes)
    pull = boxes @ projected.pull
    scales = SCALES[:, None] * site.typical
    gains = 0.5 * pull**2 / (information + scales**-2) - 0.5 * np.log1p(scales**2 * information)
    k, i = np.unravel_index(int(np.argmax(gains)), gains.shape)
    scale = float(scales[k, 0])
    size = float(pull[i] / (information[i] + scale**-2))
    pulse = Pulse(size, float(first[i]), float(last[i] - first[i]), scale)
    nuisances = projected.start + projected.follow @ (size * boxes[i])
    return Sudden(site, float(gains[k, i]) - float(np.log(first.size)), pulse, end, nuisances)


def _sensors(fitted: Fit) -> set[str]:
    return {b.sensor for b in fitted.hypothesis.blocks if b.sensor is not None}
