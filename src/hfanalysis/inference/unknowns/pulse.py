"""An unknown source that is switched on and off once: four numbers, and edges that no splines have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import tanh

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import HOOK_OF_SITE, RATES, SITES, switch, term
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis

Array = NDArray[np.float64]

SIZE, START, DURATION, EDGE, SITE, HOOK = range(6)

OWN = ("size", "start", "duration", "edge")
"""What may move in a pulse."""

TYPICAL_EDGE, SHARPEST, BLUNTEST = 0.1, 0.03, 0.5
"""Seconds in which a pulse comes and goes."""

AHEAD = 2.0
"""Edges before its middle at which an edge can be felt: a run that did not stop there would step over it."""

SHORTEST = 0.15
"""Seconds that a pulse lasts at least."""


@term
def _pulse(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == int(p[HOOK]):
        since, left = (t - p[START]) / p[EDGE], (t - p[START] - p[DURATION]) / p[EDGE]
        site[int(p[SITE])] += 0.5 * p[SIZE] * (tanh(since) - tanh(left))


@switch
def _edges(t, env, c, p, x):  # type: ignore[no-untyped-def]
    begins = p[START] - AHEAD * p[EDGE]
    return (t - begins) * (t - begins - p[DURATION])


def _name(site: str) -> str:
    return f"probe_{site}"


@lru_cache(maxsize=64)
def pulse_effect(site: str) -> Effect:
    """An effect that adds a pulse to a site."""
    return Effect(
        name=_name(site),
        equation="tank_energy",
        meaning=f"an unknown source at {site} that comes and goes",
        reference="free form",
        parameters=(
            Parameter("size", "", "of the pulse", 1.0),
            *(Parameter(name, "s", "of the pulse", 1.0, center=1.0) for name in OWN[1:]),
            Parameter("site", "", "of the pulse", 1.0, center=float(SITES.index(site)), given=True),
            Parameter("hook", "", "of the site", 1.0, center=float(HOOK_OF_SITE.get(site, RATES)), given=True),
        ),
        phases=(),
        term=_pulse,
        switch=_edges,
    )


@dataclass(frozen=True)
class Pulse:
    """A pulse of ``size`` (whose prior has the deviation ``scale``) from ``start`` on for ``duration`` [s]."""

    size: float
    start: float
    duration: float
    scale: float


def pulse_at(times: Array, size: float, start: float, duration: float, edge: float) -> Array:
    """A pulse at ``times`` [s], in the unit of its size."""
    return np.asarray(0.5 * size * (np.tanh((times - start) / edge) - np.tanh((times - start - duration) / edge)))


def with_pulse(hypothesis: Hypothesis, site: str, pulse: Pulse, end: float) -> tuple[Hypothesis, Array]:
    """The hypothesis with a pulse at a site, before ``end`` [s], and the x of its parameters to start from."""
    effect = pulse_effect(site)
    free = _free(effect.name, pulse.scale, end)
    values = (pulse.size, pulse.start, pulse.duration, TYPICAL_EDGE)
    made = hypothesis.with_active(effect.at(**dict(zip(OWN, values, strict=True))), free)
    start = np.array([f.place(v) for f, v in zip(free, values, strict=True)])
    return made, np.clip(start, [f.least for f in free], [f.most for f in free])


def _free(name: str, scale: float, end: float) -> tuple[Free, ...]:
    """A pulse may begin at any time, and last for any time."""
    middle = 0.5 * end
    return (
        Free(f"{name}.size", 0.0, scale),
        _between(Free(f"{name}.start", middle, middle), 0.0, end),
        _between(Free(f"{name}.duration", 0.5 * middle, 1.2, "positive"), SHORTEST, 2.0 * end),
        _between(Free(f"{name}.edge", TYPICAL_EDGE, 0.7, "positive"), SHARPEST, BLUNTEST),
    )


def _between(free: Free, least: float, most: float) -> Free:
    return replace(free, least=free.place(least), most=free.place(most))


def parameters_of(site: str) -> tuple[str, ...]:
    """The names of OWN in a hypothesis."""
    return tuple(f"{_name(site)}.{own}" for own in OWN)


def pulse_in(fitted: Hypothesis, x: Array, site: str, times: Array) -> Array:
    """The pulse that a hypothesis has at a site."""
    values = fitted.values(x)
    return pulse_at(times, *(values[name] for name in parameters_of(site)))


def has_pulse(hypothesis: Hypothesis, site: str) -> bool:
    """Whether a hypothesis has a pulse at a site."""
    return parameters_of(site)[SIZE] in hypothesis.names
