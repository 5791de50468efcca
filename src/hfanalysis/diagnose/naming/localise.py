"""Localisation: at which equation, from when to when and how much, before any effect is named.

At every site of the model an unknown source over time is tried, with all calibrated parameters free: splines with a
Gaussian prior, linear in the tangents of the base fit. The evidence of each says where the source is; the best few are
fitted again with the full model, since a large source is not linear. Sensors are sites too: an offset over time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fitting.fit import Fit
from hfanalysis.diagnose.fitting.hypothesis import Block, Hypothesis
from hfanalysis.diagnose.fitting.predict import AFTER, sensor_slopes, slopes_of, with_spare_fuel
from hfanalysis.diagnose.fitting.probe import Splines, probe
from hfanalysis.diagnose.observations.observed import Observed
from hfanalysis.engine.sensitivity import run_with_tangents

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Site:
    """Where a source can be: the model's site or a sensor's channel, its equation, unit, and physical scale."""

    name: str
    equation: str
    unit: str
    typical: float
    sensor: str | None = None


SITES = (
    Site("tank_heat", "tank_energy", "W", 2000.0),
    Site("nitrogen_inflow", "tank_volume", "kg/s", 0.02),
    Site("tank_leak", "tank_volume", "kg/s", 0.05),
    Site("tank_pressure", "tank_energy", "Pa", 1e5),
    Site("injector_factor", "injector", "1", 0.1),
    Site("feed_loss", "feed", "Pa", 1e5),
    Site("regression_factor", "grain", "1", 0.2),
    Site("temperature_factor", "chamber_energy", "1", 0.1),
    Site("throat_factor", "nozzle", "1", 0.05),
    Site("thrust_factor", "nozzle", "1", 0.05),
)
BEYOND_ACCURACY = 5.0
"""Error of a pressure transducer that is typical of one that errs, in units of its stated accuracy."""

LOAD_CELL_DRIFT = 200.0
"""Typical drift of a thrust cell in the heat of a firing [N]."""

SCALES = np.geomspace(0.02, 4.0, 9)
"""Sizes of a source that are tried, in units of what is typical of its site."""

SPACING = 0.6
"""Seconds between the splines of a source."""

CORRELATION = 1.5
"""Splines over which a source is coherent."""


@dataclass(frozen=True)
class Source:
    """A source over time at a site: ``mean`` and ``std`` at ``time`` [s], in the site's unit, and its log evidence."""

    site: Site
    time: Array
    mean: Array
    std: Array
    log_evidence: float
    scale: float
    coefficients: Array
    splines: Splines
    nuisances: Array


def smooth_prior(count: int) -> Array:
    """Covariance of the coefficients of a source of size one."""
    lag = np.arange(count)[:, None] - np.arange(count)[None, :]
    return np.asarray(np.exp(-0.5 * (lag / CORRELATION) ** 2) + 1e-6 * np.eye(count))


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


def _best_scale(projected: _Projected, typical: float) -> tuple[float, float, Array, Array]:
    """Scale, log evidence against no source, coefficients and their covariance."""
    best: tuple[float, float, Array, Array] | None = None
    count = projected.pull.size
    prior = smooth_prior(count)
    root = np.linalg.cholesky(prior)
    information, pull = root.T @ projected.information @ root, root.T @ projected.pull
    for scale in SCALES * typical:
        inner = np.eye(count) + scale**2 * information
        solved = np.linalg.solve(inner, scale**2 * pull)
        gain = 0.5 * float(pull @ solved) - 0.5 * float(np.linalg.slogdet(inner)[1])
        if best is None or gain > best[1]:
            covariance = scale**2 * root @ np.linalg.inv(inner) @ root.T
            best = (float(scale), gain, np.asarray(root @ solved), np.asarray(covariance))
    assert best is not None
    return best


def linear_sources(fitted: Fit, observed: Observed) -> list[Source]:
    """The source at every site, linear about the fit, the best first."""
    splines = Splines.over(0.0, float(observed.grid[~observed.resting][-1]), SPACING)
    engine, names = fitted.hypothesis.at(fitted.x), []
    active = []
    taken = {a.effect.name for a in engine.effects}
    sites = [s for s in SITES if f"probe_{s.name}" not in taken]
    for site in sites:
        effect = probe(site.name, splines, site.typical)
        active.append(effect.at(on=1.0))
        names.append([f"{effect.name}.c{i}" for i in range(splines.count)])
    probed = replace(engine, effects=(*engine.effects, *active))
    flat = [n for group in names for n in group]
    spared = with_spare_fuel(probed, observed.fuel_out)
    tangents = run_with_tangents(spared, flat, observed.longest + AFTER, run_on=True)
    slopes = slopes_of(fitted.hypothesis, observed, tangents)
    time = np.linspace(0.0, observed.end, 200)
    found = []
    for k, site in enumerate(sites):
        columns = slopes[:, k * splines.count : (k + 1) * splines.count]
        found.append(_source(site, _project(fitted, columns), splines, time))
    found += [
        _source(*_sensor(observed, name, splines, fitted), splines, time)
        for name in observed.names
        if name not in _sensors(fitted)
    ]
    return sorted(found, key=lambda s: -s.log_evidence)


def _sensor(observed: Observed, name: str, splines: Splines, fitted: Fit) -> tuple[Site, _Projected]:
    return sensor_site(observed, name), _project(fitted, sensor_slopes(observed, name, splines))


def sensor_site(observed: Observed, name: str) -> Site:
    """A sensor as a site: an offset over time."""
    accuracy = next(c.accuracy for c in observed.channels if c.name == name)
    unit = "N" if name == "thrust" else "kg" if name == "m_tank" else "Pa"
    typical = LOAD_CELL_DRIFT if name == "thrust" else BEYOND_ACCURACY * accuracy
    return Site(f"offset of {name}", "sensor", unit, typical, sensor=name)


def _source(site: Site, projected: _Projected, splines: Splines, time: Array) -> Source:
    scale, gain, mean, covariance = _best_scale(projected, site.typical)
    basis = splines.at(time)
    std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, covariance, basis), 0.0))
    nuisances = projected.start + projected.follow @ mean
    return Source(site, time, basis @ mean, std, gain, scale, mean, splines, nuisances)


def _sensors(fitted: Fit) -> set[str]:
    return {b.sensor for b in fitted.hypothesis.blocks if b.sensor is not None}


def with_source(hypothesis: Hypothesis, source: Source) -> Hypothesis:
    """The hypothesis with an unknown source at a site, of the size that the linear search found."""
    splines, site = source.splines, source.site
    matrix = np.asarray(source.scale * np.linalg.cholesky(smooth_prior(splines.count)))
    if site.sensor is not None:
        names = tuple(f"offset_{site.sensor}.c{i}" for i in range(splines.count))
        return hypothesis.with_block(Block(names, matrix, splines, site.sensor))
    effect = probe(site.name, splines, site.typical)
    names = tuple(f"{effect.name}.c{i}" for i in range(splines.count))
    return hypothesis.with_block(Block(names, matrix, splines), effect.at(on=1.0))


def coordinates(source: Source) -> Array:
    """A source's coefficients in units of its prior."""
    root = np.linalg.cholesky(smooth_prior(source.splines.count)) * source.scale
    return np.asarray(np.linalg.solve(root, source.coefficients))


def source_of(found: Fit, name: str, observed: Observed) -> Source:
    """An unknown source as a fit has it; ``name`` is that of its site."""
    for block, place in found.hypothesis.places():
        site = _site(name, observed)
        if block.names[0].startswith(_prefix(site)):
            time = np.linspace(0.0, float(observed.grid[~observed.resting][-1]), 200)
            basis = block.splines.at(time) @ block.matrix
            covariance = found.covariance[place, place]
            std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, covariance, basis), 0.0))
            mean = basis @ found.x[place]
            return Source(site, time, mean, std, 0.0, 1.0, found.x[place], block.splines, found.x)
    raise ValueError(f"the fit has no source at {name}")


def _prefix(site: Site) -> str:
    return f"offset_{site.sensor}." if site.sensor is not None else f"probe_{site.name}."


def _site(name: str, observed: Observed) -> Site:
    if name.startswith("offset of "):
        return sensor_site(observed, name.removeprefix("offset of "))
    return next(s for s in SITES if s.name == name)
