"""A smooth source at a site of the model, or an offset of a sensor over time: splines with a Gaussian prior."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Block, Hypothesis
from hfanalysis.inference.linear import SCALES, SPACING, Linearized, Projected
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import PLACES, SourcePlace
from hfanalysis.inference.splines import Splines, probe
from hfanalysis.inference.unknown import POINTS, PREFIX, History, LinearUnknown, spread_of
from hfanalysis.record.channels import unit_of

OFFSET = "offset of "
"""How the names of places begin that are sensors."""

BEYOND_ACCURACY = 5.0
"""Error of a pressure transducer that is typical of one that errs, in units of its stated accuracy."""

LOAD_CELL_DRIFT = 200.0
"""Typical drift of a thrust cell in the heat of a firing [N]."""

WINDY, WIND_SPACING = ("thrust",), 0.25
"""Channels in which wind on the stand may be read, and the spacing of its splines [s]: it is faster than what an engine
does. What is slow in a sensor does not go with the flow: one that has drifted reads as much too much at rest."""

WETTED = tuple(place for place in PLACES if place.name in ("tank_pressure", "injector_factor", "feed_loss"))
"""Places at which a source may end with the liquid: what it does in tank, line and injector ends at once."""

CORRELATIONS = 1.5, 5.0
"""Splines over which a source may be coherent: what changes slowly needs few numbers, and is found when it is weak."""

GONE, ONE_SIDED = 0.2, 0.4
"""Part of its largest size below which a source is gone, and goes to one side."""


@dataclass(frozen=True)
class SmoothSource(LinearUnknown):
    """``coefficients`` (n,) of splines and their ``scale``; ``correlation``: splines over which it is coherent.

    ``coefficients`` and ``scale`` are in the unit of the place; ``nuisances`` in prior standard deviations.
    """

    place: SourcePlace
    log_evidence: float
    nuisances: Array
    scale: float
    correlation: float
    coefficients: Array
    splines: Splines

    @classmethod
    def in_slopes(cls, about: Linearized) -> list[SmoothSource]:
        """The best at every place of the model, also of those that end with the liquid, and in every sensor."""
        splines, observed = about.splines, about.observed
        found = [_best(place, projected, splines) for place, projected in about.everywhere]
        if "t_v" in observed.events:
            wet = Splines.over(0.0, observed.events["t_v"][0], SPACING, wet=True)
            found += [_best(place, projected, wet) for place, projected in about.at(WETTED, wet)]
        slow, fast = replace(splines, held=True), Splines.over(0.0, observed.last, WIND_SPACING)
        taken = {block.sensor for block in about.fitted.hypothesis.blocks}
        for name, own in [*((name, slow) for name in observed.names), *((name, fast) for name in WINDY)]:
            if name in observed.names and name not in taken:
                found.append(_best(sensor_place(observed, name), about.read_by(name, own), own))
        return found

    @property
    def equations(self) -> set[str]:
        """What thrust is misread by may be the nozzle's."""
        return {self.place.equation, "nozzle"} if self.place.sensor == "thrust" else {self.place.equation}

    def added_to(self, fitted: Fit, share: float = 1.0) -> tuple[Hypothesis, Array]:
        matrix = np.asarray(self.scale * np.linalg.cholesky(smooth_prior(self.splines.count, self.correlation)))
        block = Block(self._names, matrix, self.splines, self.place.sensor)
        in_engine = self.place.sensor is None
        active = probe(self.place.name, self.splines, self.place.typical).at(on=1.0) if in_engine else None
        start = np.asarray(share * np.linalg.solve(matrix, self.coefficients))
        return fitted.hypothesis.with_block(block, active), start

    def history(self, fitted: Fit, observed: Observed) -> History:
        """The source over time [s after the opening], in the unit of its place."""
        time = np.linspace(0.0, observed.last, POINTS)
        mean, slopes, covariance = self.course(fitted, time)
        std = spread_of(slopes, covariance)
        place, whole = seen_at(self.place, mean, std), self.place.whole(fitted, time, observed)
        return History(place, time, mean, std, 0.5 * self.splines.spacing, whole=whole)

    def course(self, fitted: Fit, time: Array) -> tuple[Array, Array, Array]:
        """Its mean (n,) at ``time`` (n,) [s] as a fit has it, in the unit of the place, its slopes (n, m) with its own
        numbers, and their covariance (m, m)."""
        block, own = next(it for it in fitted.hypothesis.places() if it[0].names == self._names)
        basis = block.splines.at(time) @ block.matrix
        return basis @ fitted.x[own], basis, fitted.covariance[own, own]

    @property
    def _names(self) -> tuple[str, ...]:
        """Of its coefficients: parameters of the effect that it is, or of none where it is in a sensor."""
        owner = f"offset_{self.place.sensor}" if self.place.sensor is not None else PREFIX + self.place.name
        return tuple(f"{owner}.c{i}" for i in range(self.splines.count))


def sensor_place(observed: Observed, name: str) -> SourcePlace:
    """A sensor as a place: an offset over time, with the size [SI] that is typical of it."""
    accuracy = next(c.accuracy for c in observed.channels if c.name == name)
    typical = LOAD_CELL_DRIFT if name == "thrust" else BEYOND_ACCURACY * accuracy
    return SourcePlace(OFFSET + name, "sensor", unit_of(name), typical, sensor=name)


def seen_at(place: SourcePlace, mean: Array, std: Array) -> SourcePlace:
    """The place of a source by its history: ``mean`` and ``std`` (n,) in the unit of the place.

    What the thrust departs by to one side and is gone, or not seen any more, as the flow ends is the nozzle's: a cell
    that has drifted does not come back at that instant, and gusts blow to and fro.
    """
    low, high, last = float(mean.min()), float(mean.max()), abs(float(mean[-1]))
    largest, other = max(high, -low), min(max(high, 0.0), max(-low, 0.0))
    gone = last < max(GONE * largest, float(std[-1]))
    in_nozzle = place.sensor == "thrust" and gone and other < ONE_SIDED * largest
    return replace(place, equation="nozzle") if in_nozzle else place


def smooth_prior(count: int, correlation: float) -> Array:
    """Covariance (count, count) [-] of the coefficients of a source of size one that is coherent over so many splines.

    >>> smooth_prior(2, 1.5).round(3).tolist()
    [[1.0, 0.801], [0.801, 1.0]]
    """
    lag = np.arange(count)[:, None] - np.arange(count)[None, :]
    return np.asarray(np.exp(-0.5 * (lag / correlation) ** 2) + 1e-6 * np.eye(count))


def _best(place: SourcePlace, projected: Projected, splines: Splines) -> SmoothSource:
    """The most probable scale and correlation of a source at a place."""
    tried = [source for c in CORRELATIONS for source in _of_scales(place, projected, splines, c)]
    return max(tried, key=lambda source: source.log_evidence)


def _of_scales(place: SourcePlace, projected: Projected, splines: Splines, correlation: float) -> list[SmoothSource]:
    """A source at every scale."""
    found = []
    root = np.linalg.cholesky(smooth_prior(splines.count, correlation))
    information, pull = root.T @ projected.information @ root, root.T @ projected.pull
    for scale in SCALES * place.typical:
        inner = np.eye(splines.count) + scale**2 * information
        solved = np.linalg.solve(inner, scale**2 * pull)
        gain = 0.5 * float(pull @ solved) - 0.5 * float(np.linalg.slogdet(inner)[1])
        mean = np.asarray(root @ solved)
        nuisances = projected.start + projected.follow @ mean
        found.append(SmoothSource(place, gain, nuisances, float(scale), correlation, mean, splines))
    return found


UNKNOWN = SmoothSource
