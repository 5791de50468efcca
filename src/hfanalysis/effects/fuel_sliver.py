"""A grain that does not burn through everywhere at once."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.model import OUTER_RADIUS
from hfanalysis.engine.sites import PORT_RADIUS, RATES, REGRESSION_FACTOR, switch, term

DEPTH, WIDTH = range(2)
MOST = 0.995
"""Share of the surface that can have burnt through before the last fuel goes: the end stays within reach."""

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
        last = 1.0 - min(p[DEPTH], MOST)
        site[REGRESSION_FACTOR] *= sqrt(last * last + (1.0 - last * last) * left)


def _fading_web(values: Mapping[str, float]) -> float:
    """The spread of the webs, w / (1 - d / 2), where it is deep enough to be seen to fade."""
    depth = min(values["depth"], MOST)
    share = max(depth - SHALLOW, 0.0) / (1.0 - SHALLOW)
    return values["width"] / (1.0 - 0.5 * depth) * share * (2.0 - share)


EFFECT = Effect(
    name="fuel_sliver",
    equation="grain",
    meaning="the fuel is gone in some places before it is in others; what is left burns from a smaller surface",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapters 12 and 16: slivers at burn-out. The port's "
    "radius is that of the fuel left; where the webs of a share d of the surface are spread evenly, it shrinks in "
    "proportion to time as the walls show, which is the root of the fuel left",
    formula="(A_burning / (2 pi r L))^2 = (1 - d)^2 + d (2 - d) (R - r) / w for R - r < w",
    sites=("regression_factor",),
    parameters=(
        Parameter("depth", "-", "share of the surface burnt through when the last fuel goes", 0.5, low=0.0, high=1.0),
        Parameter("width", "m", "mean web left when the first wall shows", 6e-3, center=1e-3, low=3e-6, high=2e-2),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    switch=_first_wall,
    fading_web=_fading_web,
    twins=(),
    decisive="pictures of the plume, and the slivers themselves after the test",
)
