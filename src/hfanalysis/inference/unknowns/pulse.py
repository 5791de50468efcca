"""An unknown source that is switched on and off once: four numbers, and edges that no splines have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import tanh
from typing import ClassVar

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import HOOK_OF_SITE, RATES, SITES, switch, term
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.linear import SCALES, Linearized, Projected
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import PLACES, SourcePlace
from hfanalysis.inference.unknown import POINTS, PREFIX, History, LinearUnknown, nameless_effect, spread_of

SIZE, START, DURATION, EDGE, SITE, HOOK = range(6)

OWN = ("size", "start", "duration", "edge")
"""What may move in a pulse."""

TYPICAL_EDGE, SHARPEST, BLUNTEST = 0.1, 0.03, 0.5
"""Seconds in which a pulse comes and goes."""

AHEAD = 2.0
"""Edges before its middle at which an edge can be felt: a run that did not stop there would step over it."""

SHORTEST = 0.15
"""Seconds that a pulse lasts at least."""

FINE = 200
"""Instants at which pulses are laid over the splines."""

SLOPE_STEP = 1e-3
"""Of x, for the slopes of its history."""


@term
def _pulse(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == int(p[HOOK]):
        since, left = (t - p[START]) / p[EDGE], (t - p[START] - p[DURATION]) / p[EDGE]
        site[int(p[SITE])] += 0.5 * p[SIZE] * (tanh(since) - tanh(left))


@switch
def _edges(t, env, c, p, x):  # type: ignore[no-untyped-def]
    begins = p[START] - AHEAD * p[EDGE]
    return (t - begins) * (t - begins - p[DURATION])


@lru_cache(maxsize=64)
def pulse_effect(site: str) -> Effect:
    """An effect that adds a pulse to a site."""
    return nameless_effect(
        site,
        "tank_energy",
        f"an unknown source at {site} that comes and goes",
        (
            Parameter("size", "", "of the pulse", 1.0),
            *(Parameter(name, "s", "of the pulse", 1.0, center=1.0) for name in OWN[1:]),
            Parameter("site", "", "of the pulse", 1.0, center=float(SITES.index(site)), given=True),
            Parameter("hook", "", "of the site", 1.0, center=float(HOOK_OF_SITE.get(site, RATES)), given=True),
        ),
        term=_pulse,
        switch=_edges,
    )


@dataclass(frozen=True)
class Pulse(LinearUnknown):
    """A pulse of ``size`` (whose prior has the deviation ``scale``) from ``start`` on for ``duration`` [s]; ``end``: of
    what is compared [s]."""

    place: SourcePlace
    log_evidence: float
    nuisances: Array
    size: float
    start: float
    duration: float
    scale: float
    end: float
    price: ClassVar[float] = float(np.log(len(PLACES) * SCALES.size))
    """It is the best of all places and scales, and fits whatever else comes and goes, an ignition for one. (Smooth
    sources are as much chosen; their odds are fitted to simulated tests.)"""

    @classmethod
    def in_slopes(cls, about: Linearized) -> list[Pulse]:
        return [_best(place, projected, about) for place, projected in about.everywhere]

    def added_to(self, fitted: Fit, share: float = 1.0) -> tuple[Hypothesis, Array]:
        effect = pulse_effect(self.place.name)
        free = _free(effect.name, self.scale, self.end)
        values = (share * self.size, self.start, self.duration, TYPICAL_EDGE)
        made = fitted.hypothesis.with_active(effect.at(**dict(zip(OWN, values, strict=True))), free)
        start = np.array([f.place(v) for f, v in zip(free, values, strict=True)])
        return made, np.clip(start, [f.least for f in free], [f.most for f in free])

    def history(self, fitted: Fit, observed: Observed) -> History:
        """The pulse over time [s after the opening], in the unit of its place; its deviation to first order."""
        time = np.linspace(0.0, observed.last, POINTS)
        names = [f"{PREFIX}{self.place.name}.{own}" for own in OWN]
        own = [fitted.hypothesis.names.index(name) for name in names]

        def pulse(x: Array) -> Array:
            values = fitted.hypothesis.values(x)
            size, start, duration, edge = (values[name] for name in names)
            return np.asarray(0.5 * size * (np.tanh((time - start) / edge) - np.tanh((time - start - duration) / edge)))

        mean = pulse(fitted.x)
        slopes = np.column_stack(
            [(pulse(fitted.x + SLOPE_STEP * np.eye(fitted.x.size)[k]) - mean) / SLOPE_STEP for k in own]
        )
        std = spread_of(slopes, fitted.covariance[np.ix_(own, own)])
        whole = self.place.whole(fitted, time, observed)
        return History(self.place, time, mean, std, fitted.stds[names[START]], whole=whole)


def _free(name: str, scale: float, end: float) -> tuple[Free, ...]:
    """It may begin at any time, and last for any time."""
    middle = 0.5 * end
    return (
        Free(f"{name}.size", 0.0, scale),
        _between(Free(f"{name}.start", middle, middle), 0.0, end),
        _between(Free(f"{name}.duration", 0.5 * middle, 1.2, "positive"), SHORTEST, 2.0 * end),
        _between(Free(f"{name}.edge", TYPICAL_EDGE, 0.7, "positive"), SHARPEST, BLUNTEST),
    )


def _between(free: Free, least: float, most: float) -> Free:
    return replace(free, least=free.place(least), most=free.place(most))


def _best(place: SourcePlace, projected: Projected, about: Linearized) -> Pulse:
    """The best pulse at a place among those that begin and end on a grid of half the splines' spacing.

    The price of each is that it is one of many.
    """
    splines, end = about.splines, about.observed.last
    grid = np.arange(0.0, end + splines.spacing, 0.5 * splines.spacing)
    first, last = (grid[i] for i in np.triu_indices(grid.size, 1))
    time = np.linspace(0.0, end, FINE)
    inside = (time >= first[:, None]) & (time < last[:, None])
    boxes = inside @ np.linalg.pinv(splines.at(time)).T  # the splines that come nearest to each
    information = np.einsum("ij,jk,ik->i", boxes, projected.information, boxes)
    pull = boxes @ projected.pull
    scales = SCALES[:, None] * place.typical
    gains = 0.5 * pull**2 / (information + scales**-2) - 0.5 * np.log1p(scales**2 * information)
    k, i = np.unravel_index(int(np.argmax(gains)), gains.shape)
    scale = float(scales[k, 0])
    size = float(pull[i] / (information[i] + scale**-2))
    gain, duration = float(gains[k, i]) - float(np.log(first.size)), float(last[i] - first[i])
    nuisances = projected.start + projected.follow @ (size * boxes[i])
    return Pulse(place, gain, nuisances, size, float(first[i]), duration, scale, end)


UNKNOWN = Pulse
