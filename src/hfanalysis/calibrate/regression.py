"""a and n of the fuel's regression r = a G^n fitted to a test (report, section 4.3.1, as one estimate).

The report finds n for the burn time at a fixed a, and a for the chamber pressure of the full run. Here both are fitted
at once to burn time (or fuel left) and chamber pressure. A burn sees only a narrow range of oxidizer flux: what it
tells well is the rate at one flux in the middle of that range, ln a + n ln G_ref; whether it tells a and n apart is
part of the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.descent import least
from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.likelihood import Surface, Weights, first_guess, surface, weights_from
from hfanalysis.engine.grain import USUAL_N, oxidizer_flux
from hfanalysis.engine.injector import mass_flow_with_feed
from hfanalysis.errors import AbsentError

RANGE_N = (-0.3, 1.3)
"""Where n [-] is looked for. Evidence: HF4 has 0.04, whose interval reaches -0.02 (docs/calibration.md); a start beyond
is moved to the border (test_regression.py)."""
RANGE_RATE = (1e-5, 5e-2)
"""Regression rate [m/s] at the middle flux within which a and n are looked for: beyond it no fuel of a grain burns.
Source: 0.1 mm/s of polymers at low flux to some mm/s of paraffin (report, 4.3.1), a decade of room on both sides."""
SCAN_N = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Exponents [-] from which the best start is taken."""
RESTARTS = (0.15, 0.45, 0.75)
"""Other exponents [-] that a fit starts from. Evidence: the valley of a and n may have several minima."""
SCAN_RATE = (0.6, 0.85, 1.2, 1.7)
"""Rates, over that which burns the web in the burn time [-], from which the best start is taken."""

LARGEST_STEP = 0.2
"""Standard deviation of n [-] to which the likelihood's surface is followed at most."""
LARGEST_RATE_STEP = 1.0
"""The same of the logarithm of the rate [-], which is let grow to this where nothing tells it."""

ROUNDS = 2
"""Times that the weights follow from what a fit leaves, and the fit from the weights."""
RESURVEYS = 3
"""Times the surface is followed from a lower point that it has shown. Evidence: without it values lay outside their own
intervals."""
NEGLIGIBLE = 0.05
"""Misfit [-] by which such a point has to be lower."""

NEAR, EXACT = 1e-4, 1e-7
"""To what ln r and n are found of a minimum that is one of several, and of the one that is told. Evidence: along a
valley, steps are short before its end is reached, and where a fit stood followed the last digits of a log."""

FLOOR = 1e-2
"""To what ln r is found at an exponent that a fit starts from."""

SAME = 0.01
"""Of ln r and n [-], within which two minima are one: they are found to far less, and are told to far more."""

FAILED = 1e12
"""Misfit [-] of constants with which the engine cannot be run: above any other."""


@dataclass(frozen=True)
class Fitted:
    """a and n with their likelihood.

    ``best`` is (ln r at ``flux``, n); ``flux`` [kg/m^2/s] a flux of the burn. ``covariance`` is of ``best``; ``misfit``
    r'Pr at the best; ``rivals``: other points that explain the test as well.
    """

    evidence: Evidence
    weights: Weights
    flux: float
    best: Array
    surface: Surface
    misfit: float
    rivals: tuple[Array, ...] = ()

    def interval(self, weights: Array) -> tuple[float, float]:
        """95 % interval of ``weights`` (2,) times the parameters [-], as far as its rivals."""
        ends = [*self.surface.interval(weights), *(float(r @ weights) for r in self.rivals)]
        return min(ends), max(ends)

    @property
    def law(self) -> Regression:
        """The best a and n."""
        return law_at(self.best, self.flux)

    @property
    def reference_flux(self) -> float:
        """The flux [kg/m^2/s] of the burn at which the rate is known best and does not depend on n."""
        burnt = self.evidence.burnt(self.law)
        flux = oxidizer_flux(burnt.output("oxidizer_flow"), burnt.state("port_radius"))
        burn = flux[burnt.time > 0.1]
        covariance = self.surface.covariance
        # in logarithms: a valley that hardly shows n may point beyond any number
        shift = -covariance[0, 1] / covariance[1, 1] if covariance[1, 1] > 0.0 else 0.0
        low, high = max(burn.min(), 0.05 * self.flux), burn.max()
        return float(exp(np.clip(log(self.flux) + shift, log(low), log(max(low, high)))))


def law_at(point: Array, flux: float) -> Regression:
    """a [SI] and n [-] from ``point``: (ln of the rate r [m/s] at ``flux`` [kg/m^2/s], n).

    r = a G^n (report, 4.3.1).

    >>> law = law_at(np.array([log(1e-3), 0.5]), 100.0)
    >>> round(law.a, 6), law.n
    (0.0001, 0.5)
    """
    return Regression(exp(float(point[0]) - float(point[1]) * log(flux)), float(point[1]))


def fit(evidence: Evidence) -> Fitted:
    """a and n of a test. Raises AbsentError where no engine with any constants runs."""
    flux = middle_flux(evidence)
    weights = first_guess(evidence.time.size, float(evidence.chamber.mean()), evidence.scales)
    best = _minimum(evidence, weights, flux, _scan(evidence, weights, flux))
    for _ in range(ROUNDS):
        law = law_at(best, flux)
        evidence = evidence.with_regression(law)
        weights = weighed(evidence, law)
        best, *rivals = _likeliest(evidence, _minima(evidence, weights, flux, best), flux)
    found = _surveyed(evidence, weights, flux, best)
    return replace(found, rivals=tuple(r for r in rivals if abs(r[1] - found.best[1]) > SAME))


def _surveyed(evidence: Evidence, weights: Weights, flux: float, best: Array) -> Fitted:
    """The fit with its likelihood's surface."""
    objective, threshold = _objective(evidence, weights, flux), weights.threshold
    for _ in range(RESURVEYS):
        best = _minimum(evidence, weights, flux, best, EXACT)
        found = surface(objective, best, _covariance(evidence, weights, flux, best), threshold)
        lower = _minimum(evidence, weights, flux, found.lowest)
        if objective(lower) > objective(best) - NEGLIGIBLE:
            break
        best = lower
    return Fitted(evidence, weights, flux, best, found, objective(best))


def middle_flux(evidence: Evidence) -> float:
    """Oxidizer flux [kg/m^2/s] of the first flow at the port's mean radius: where the rate is parametrized."""
    engine = evidence.engine
    drop = float(engine.saturation.pressure(engine.temperature)) - float(evidence.chamber.mean())
    density = float(engine.saturation.liquid_density(engine.temperature))
    flow = mass_flow_with_feed(engine.feed.area, engine.feed.loss_factor, density, max(drop, 1e5))
    return float(oxidizer_flux(flow, 0.5 * (engine.port_radius + engine.outer_radius)))


def _scan(evidence: Evidence, weights: Weights, flux: float) -> Array:
    """The best of a coarse grid of exponents and rates."""
    engine, objective = evidence.engine, _objective(evidence, weights, flux)
    rate = (engine.outer_radius - engine.port_radius) / evidence.end
    points = [np.array([log(rate * f), n]) for n in SCAN_N for f in SCAN_RATE]
    misfits = [objective(p) for p in points]
    if min(misfits) >= FAILED:
        raise AbsentError("the engine's model cannot be run with any a and n")
    return points[int(np.argmin(misfits))]


def _minimum(
    evidence: Evidence,
    weights: Weights,
    flux: float,
    start: Array,
    within: float = NEAR,
    range_n: tuple[float, float] = RANGE_N,
) -> Array:
    """The least misfit from ``start``; a start beyond the range of n is moved to its border.

    ``within``: to what ln r and n are found.
    """

    def residual(point: Array) -> Array | None:
        predicted = evidence.predict(law_at(point, flux)) if possible(point) else None
        return None if predicted is None else evidence.observed - predicted

    box = np.array([start[0] - 2.0, range_n[0]]), np.array([start[0] + 2.0, range_n[1]])
    return least(residual, weights.precision, start, box, within)


def _minima(evidence: Evidence, weights: Weights, flux: float, best: Array) -> list[Array]:
    """The minima found from the best so far and from other exponents, each once: the valley may have several.

    On each side of the best the farthest exponent is the first; where its descent comes to a minimum that is known, it
    has passed the nearer ones.
    """
    out = [_minimum(evidence, weights, flux, best)]
    others = sorted((n for n in RESTARTS if abs(n - best[1]) > 0.1), key=lambda n: abs(n - best[1]))
    for side in ([n for n in others if n < best[1]], [n for n in others if n > best[1]]):
        for floor in reversed(_floors(evidence, weights, flux, out[0], side)):
            found = _minimum(evidence, weights, flux, floor)
            if any(np.abs(found - other).max() < SAME for other in out):
                break
            out.append(found)
    return out


def _floors(evidence: Evidence, weights: Weights, flux: float, best: Array, exponents: Sequence[float]) -> list[Array]:
    """The valley's floor at ``exponents``, which lead away from its ``best`` point, each along the line so far."""
    if not exponents:
        return []
    covariance, out = _covariance(evidence, weights, flux, best), [best]
    slope = covariance[0, 1] / covariance[1, 1]
    for n in exponents:
        start = np.array([out[-1][0] + slope * (n - out[-1][1]), n])
        out.append(_minimum(evidence, weights, flux, start, FLOOR, (n, n)))
        slope = (out[-1][0] - out[-2][0]) / (n - out[-2][1])
    return out[1:]


def _likeliest(evidence: Evidence, minima: Sequence[Array], flux: float) -> list[Array]:
    """The minima that the test does not tell apart, the most usual first.

    Each is judged with the weights that follow from what it leaves itself. Where several are as likely, what is known
    of fuels decides which is told.
    """
    if len(minima) == 1:
        return list(minima)
    laws = [law_at(point, flux) for point in minima]
    weights = [weighed(evidence, law) for law in laws]
    count = min(w.effective for w in weights)
    deviances = [w.deviance(residual_of(evidence, law), count) for law, w in zip(laws, weights, strict=True)]
    usual = [d + ((law.n - USUAL_N[0]) / USUAL_N[1]) ** 2 for law, d in zip(laws, deviances, strict=True)]
    best = int(np.argmin(usual))
    limit = min(deviances) + weights[best].threshold
    order = sorted((k for k in range(len(minima)) if k == best or deviances[k] <= limit), key=usual.__getitem__)
    return [minima[k] for k in order]


def _objective(evidence: Evidence, weights: Weights, flux: float) -> Any:
    def misfit(point: Array) -> float:
        if not possible(point):
            return FAILED
        predicted = evidence.predict(law_at(point, flux))
        return FAILED if predicted is None else weights.misfit(evidence.observed - predicted)

    return misfit


def possible(point: Array) -> bool:
    """Whether a rate (ln r [m/s], n) is one that a fuel may have.

    >>> possible(np.array([log(1e-3), 0.5])), possible(np.array([-177.0, 0.5]))
    (True, False)
    """
    return bool(log(RANGE_RATE[0]) <= point[0] <= log(RANGE_RATE[1]))


def residual_of(evidence: Evidence, law: Regression) -> Array:
    """What a law leaves of the observations, each in its SI unit; AbsentError where it cannot be run."""
    predicted = evidence.predict(law)
    if predicted is None:
        raise AbsentError("the engine's model cannot be run with the a and n that fit best so far")
    return evidence.observed - predicted


def weighed(evidence: Evidence, law: Regression) -> Weights:
    """The weights that follow from what a ``law`` leaves of the evidence."""
    size, residual = evidence.time.size, residual_of(evidence, law)
    wander = np.zeros((residual.size, residual.size))
    wander[:size, :size] = evidence.wander
    return weights_from(residual, size, evidence.scales, _by_nuisances(evidence, law), wander, evidence.least)


def _by_nuisances(evidence: Evidence, law: Regression) -> Array:
    """Covariance of the observations by what is not known of tank, grain, nozzle and sensors."""
    std = np.sqrt(np.diag(evidence.covariance))
    scale = np.where(std > 0.0, std, 1.0)
    slopes = evidence.sensitivities(law)
    return np.asarray(slopes @ (evidence.covariance / np.outer(scale, scale)) @ slopes.T)


def _covariance(evidence: Evidence, weights: Weights, flux: float, best: Array) -> Array:
    """Of (ln r, n) from the model's slopes; a direction hardly seen is cut at LARGEST_STEP."""
    along = slopes(evidence, flux, best)
    information = along.T @ weights.precision @ along
    information[0, 0] = max(information[0, 0], LARGEST_RATE_STEP**-2)
    return np.asarray(np.linalg.inv(information + np.diag([0.0, LARGEST_STEP**-2])), dtype=np.float64)


def slopes(evidence: Evidence, flux: float, best: Array, step: float = 0.01) -> Array:
    """Change of what is observed [Pa, s, kg] with ln r and n, (observations, 2), about ``best`` (2,) at ``flux``
    [kg/m^2/s].

    Raises AbsentError where the model cannot be run there.
    """
    columns = []
    for axis in np.eye(2) * step:
        after, before = (evidence.predict(law_at(best + s * axis, flux)) for s in (1.0, -1.0))
        if after is None or before is None:
            raise AbsentError("the engine's model cannot be run about the best a and n")
        columns.append((after - before) / (2.0 * step))
    return np.column_stack(columns)
