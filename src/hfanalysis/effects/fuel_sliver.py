"""A grain that does not burn through everywhere at once."""

from __future__ import annotations

from collections.abc import Mapping

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.model import OUTER_RADIUS
from hfanalysis.engine.sites import PORT_RADIUS, RATES, REGRESSION_FACTOR, term

DEPTH, WIDTH = range(2)
MOST = 0.98
"""Share of the surface that can have burnt through before the last fuel goes: the end stays within reach."""

FALL = 1.6
"""Web over which the fire goes out, in widths: the ramp that fits its surface best where depth is near one."""

SHALLOW = 0.4
"""Depth up to which what is left goes at once all the same, so that no ramp is seen."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    left = (c[OUTER_RADIUS] - env[PORT_RADIUS]) / p[WIDTH]
    if left < 1.0:
        near = min(1.0 - left, 1.0)  # beyond the wall there may be spare fuel
        site[REGRESSION_FACTOR] *= 1.0 - min(p[DEPTH], MOST) * near * near


def _fading_web(values: Mapping[str, float]) -> float:
    share = max(min(values["depth"], MOST) - SHALLOW, 0.0) / (1.0 - SHALLOW)
    return FALL * values["width"] * share * (2.0 - share)


EFFECT = Effect(
    name="fuel_sliver",
    equation="grain",
    meaning="the fuel is gone in some places before it is in others; what is left burns from a smaller surface",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapters 12 and 16: slivers at burn-out. The port's "
    "radius is that of the fuel left; a spread of local webs makes the burning surface fade before it reaches the wall",
    formula="A_burning / (2 pi r L) = 1 - d (1 - (R - r) / w)^2 for R - r < w",
    sites=("regression_factor",),
    parameters=(
        Parameter("depth", "-", "share of the surface burnt through when the last fuel goes", 0.5, low=0.0, high=0.95),
        Parameter("width", "m", "mean web left when the first wall shows", 6e-3, center=1e-3, low=3e-6, high=2e-2),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    fading_web=_fading_web,
    twins=(),
    decisive="pictures of the plume, and the slivers themselves after the test",
)
