"""Localisation: at which equation, from when to when and how much, before any effect is named.

At every site of the model an unknown source over time is tried, with all calibrated parameters free: splines with a
Gaussian prior, linear in the tangents of the base fit. The evidence of each says where the source is; the best few are
fitted again with the full model, since a large source is not linear. Sensors are sites too: an offset over time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fit import AFTER, Fit, fit, predict, sensor_slopes, slopes_of, with_spare_fuel
from hfanalysis.diagnose.hypothesis import Block, Hypothesis
from hfanalysis.diagnose.observed import Observed
from hfanalysis.diagnose.probe import Splines, probe
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.stages.base import Progress, silent

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
SENSORS = ("p_tank", "p_run", "p_chamber", "thrust")

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

LEAST_EVIDENCE = 6.0
"""Natural logarithm of the evidence against no source at all that a claim needs."""

RIVALS = 5
"""Sites that are asked once more at the end, per source."""

REFITTED = 3
"""How many of the best sites are fitted with the full model."""


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
    splines = Splines.over(0.0, observed.end, SPACING)
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
    tangents = run_with_tangents(with_spare_fuel(probed), flat, observed.longest + AFTER, run_on=True)
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
    accuracy = next(c.accuracy for c in observed.channels if c.name == name)
    unit, typical = ("N", LOAD_CELL_DRIFT) if name == "thrust" else ("Pa", BEYOND_ACCURACY * accuracy)
    site = Site(f"offset of {name}", "sensor", unit, typical, sensor=name)
    return site, _project(fitted, sensor_slopes(observed, name, splines))


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


@dataclass(frozen=True)
class Localisation:
    """The base fit, the fit with all sources, and the sources in the order in which they were found."""

    base: Fit
    final: Fit
    sources: tuple[Source, ...]
    ranking: tuple[Source, ...]
    observed: Observed


FORMS = (3e-2, 1e-2, 3e-3, 1e-3)
"""Model-form errors, from coarse to fine: what is large is placed first, so that it does not bend what is small."""

MOST_SOURCES = 3


def localise(hypothesis: Hypothesis, measured: Observed, progress: Progress = silent) -> Localisation:
    """Find sources, one at a time, from the coarsest disagreement to the finest."""
    start = np.zeros(hypothesis.size)
    found: list[Source] = []
    rivals: list[list[Source]] = []
    base: Fit | None = None
    ranking: tuple[Source, ...] = ()
    current, observed = hypothesis, measured
    for step, form in enumerate(FORMS):
        progress(f"comparing to {form:.1%} of each channel's range", step / len(FORMS))
        observed = measured.at_form(form)
        here = fit(current, observed, start)
        base = here if not found else base
        while len(found) < MOST_SOURCES:
            ranked = linear_sources(here, observed)
            ranking = ranking if found else tuple(ranked)
            better = _refit(here, observed, ranked)
            if better is None:
                break
            here, source = better
            found.append(source)
            rivals.append([r for r in ranked[:RIVALS] if r.site != source.site])
        current, start = here.hypothesis, here.x
    assert base is not None
    progress("asking whether another site does as well", 0.9)
    final, found = _swapped(hypothesis, here, observed, found, rivals)
    return Localisation(base, final, tuple(_of_fit(s, final) for s in found), ranking, observed)


def _swapped(
    hypothesis: Hypothesis, here: Fit, observed: Observed, found: list[Source], rivals: list[list[Source]]
) -> tuple[Fit, list[Source]]:
    """Each source against its rivals once more, at the finest comparison: at the coarse ones they look alike."""
    for k in range(len(found)):
        for rival in rivals[k]:
            others = [s for i, s in enumerate(found) if i != k]
            if any(s.site == rival.site for s in others):
                continue
            trial = _refit_all(hypothesis, here, observed, [*others, rival])
            if trial is not None and trial.log_evidence > here.log_evidence:
                here, found = trial, [*found[:k], rival, *found[k + 1 :]]
    return here, found


def _refit_all(hypothesis: Hypothesis, here: Fit, observed: Observed, sources: list[Source]) -> Fit | None:
    """The fit with these sources and no others, the nuisances starting where they are."""
    made = hypothesis
    for source in sources:
        made = with_source(made, source)
    linear = np.concatenate([sources[-1].nuisances[: len(hypothesis.free)], *(_coordinates(s) for s in sources)])
    still = np.concatenate([here.x[: len(hypothesis.free)], np.zeros(linear.size - len(hypothesis.free))])
    return _fit_from(made, observed, [still + share * (linear - still) for share in STRIDES])


def _refit(here: Fit, observed: Observed, ranked: list[Source]) -> tuple[Fit, Source] | None:
    """The best of the few best sources with the full model; None where none is worth it."""
    top = ranked[0].log_evidence
    best: tuple[Fit, Source] | None = None
    for source in ranked[:REFITTED]:
        if source.log_evidence < max(LEAST_EVIDENCE, 0.5 * top):
            continue
        refitted = _with_all_parameters(here, observed, source)
        if refitted is None:
            continue
        if best is None or refitted.log_evidence > best[0].log_evidence:
            best = (refitted, source)
    if best is None or best[0].log_evidence < here.log_evidence + LEAST_EVIDENCE:
        return None
    return best


def _with_all_parameters(here: Fit, observed: Observed, source: Source) -> Fit | None:
    """The full fit with a source, from its linear estimate or, where that cannot be run, from nearer to nothing."""
    made = with_source(here.hypothesis, source)
    moved = np.concatenate([source.nuisances - here.x, _coordinates(source)])
    still = np.concatenate([here.x, np.zeros(source.splines.count)])
    return _fit_from(made, observed, [still + share * moved for share in STRIDES])


STRIDES = (1.0, 0.5, 0.2, 0.0)
"""Parts of the way to the linear estimate from which a full fit may start: a large source is not linear."""


def _coordinates(source: Source) -> Array:
    """A source's coefficients in units of its prior."""
    root = np.linalg.cholesky(smooth_prior(source.splines.count)) * source.scale
    return np.asarray(np.linalg.solve(root, source.coefficients))


def _fit_from(hypothesis: Hypothesis, observed: Observed, starts: list[Array]) -> Fit | None:
    """The fit from the best of several starts; None where none can be run."""
    best: tuple[float, Array] | None = None
    for x in starts:
        try:
            found = predict(hypothesis, observed, x, tangents=False)
        except (ValueError, ArithmeticError):
            continue
        value = 0.5 * float(found.residual @ found.residual + x @ x)
        if np.isfinite(value) and (best is None or value < best[0]):
            best = (value, x)
    if best is None:
        return None
    try:
        return fit(hypothesis, observed, best[1])
    except (ValueError, ArithmeticError):
        return None


def _of_fit(source: Source, final: Fit) -> Source:
    """A source as the last fit has it."""
    for block, place in final.hypothesis.places():
        wanted = source.site.sensor
        if block.sensor == wanted and (wanted is not None or block.names[0].startswith(f"probe_{source.site.name}.")):
            basis = source.splines.at(source.time) @ block.matrix
            covariance = final.covariance[place, place]
            std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, covariance, basis), 0.0))
            return replace(source, mean=basis @ final.x[place], std=std)
    raise AssertionError(source.site.name)
