"""A grain that does not burn through everywhere at once."""

from __future__ import annotations

from collections.abc import Mapping

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.model import OUTER_RADIUS
from hfanalysis.engine.sites import PORT_RADIUS, RATES, REGRESSION_FACTOR, switch, term

DEPTH, WIDTH, TAIL = range(3)
MOST = 0.995
"""Share of the surface that can have burnt through before the last fuel goes: the end stays within reach."""

SEEN = 0.1
"""Share of the surface up to which its fading is timed."""

SHALLOW = 0.4
"""Depth up to which what is left goes at once all the same, so that no ramp is seen."""


@switch
def _first_wall(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return c[OUTER_RADIUS] - env[PORT_RADIUS] - p[WIDTH]


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    left = max(c[OUTER_RADIUS] - env[PORT_RADIUS], 0.0) / p[WIDTH]  # beyond the wall there may be spare fuel
    if left < 1.0:
        last = (1.0 - min(p[DEPTH], MOST)) ** (1.0 / p[TAIL])
        site[REGRESSION_FACTOR] *= (last + (1.0 - last) * left) ** p[TAIL]


def _fading_web(values: Mapping[str, float]) -> float:
    """The web over which the surface goes down to a tenth, as in an even fall, where it is deep enough to be seen to.

    It is w / (1 - d / 2) where webs are spread evenly.
    """
    depth, tail = min(values["depth"], MOST), values["tail"]
    if depth <= SHALLOW:
        return 0.0
    least = max(1.0 - depth, SEEN)
    last = (1.0 - depth) ** (1.0 / tail)
    even = (1.0 - least ** ((1.0 - tail) / tail)) / (1.0 - tail) * depth / ((1.0 - least) * (1.0 - last))
    share = (depth - SHALLOW) / (1.0 - SHALLOW)
    return float(values["width"] * even * share * (2.0 - share))


EFFECT = Effect(
    name="fuel_sliver",
    equation="grain",
    meaning="the fuel is gone in some places before it is in others; what is left burns from a smaller surface",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapters 12 and 16: slivers at burn-out. The port's "
    "radius is that of the fuel left; where the webs of a share d of the surface are spread evenly, it shrinks in "
    "proportion to time as the walls show, which is the root of the fuel left (k = 1/2); where remainders of any "
    "thinness go on, each as the last, it falls as the fuel left (k = 1), which fades exponentially",
    formula="(A_burning / (2 pi r L))^(1/k) = (1 - d)^(1/k) + (1 - (1 - d)^(1/k)) (R - r) / w for R - r < w",
    sites=("regression_factor",),
    parameters=(
        Parameter("depth", "-", "share of the surface burnt through when the last fuel goes", 0.5, low=0.0, high=1.0),
        Parameter("width", "m", "mean web left when the first wall shows", 6e-3, center=1e-3, low=3e-6, high=2e-2),
        Parameter("tail", "-", "power with which the surface falls as the fuel left", 0.2, 0.65, low=0.5, high=0.97),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    switch=_first_wall,
    fading_web=_fading_web,
    twins=(),
    decisive="pictures of the plume, and the slivers themselves after the test",
)
