"""A grain that does not burn through everywhere at once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.equations import OUTER_RADIUS
from hfanalysis.engine.sites import PORT_RADIUS, RATES, REGRESSION_FACTOR, term

DEPTH, WIDTH, TAIL = range(3)
LARGEST_DEPTH = 0.995
"""Share of the surface that can have burnt through before the last fuel goes [-]: the end stays within reach."""

WHOLE = 20.0
"""Webs left, in units of the width [-], from which on no wall shows. Evidence: exp(-40) is then left of the surface's
square."""

TIMED = 0.8, 0.1
"""Shares of the surface [-] between which its fading is timed; it is the fall of a ramp that goes on at that rate."""

SHALLOW = 0.4
"""Depth [-] up to which what is left goes at once all the same, so that no ramp is seen."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
"""Of the quadrature over the web. Source: Gauss and Legendre's, of 40 points."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    web = max(c[OUTER_RADIUS] - env[PORT_RADIUS], 0.0) / p[WIDTH]  # beyond the wall there may be spare fuel
    if web < WHOLE:
        last = 1.0 - min(p[DEPTH], LARGEST_DEPTH)
        site[REGRESSION_FACTOR] *= np.sqrt(1.0 - (1.0 - last**2) * np.exp(-2.0 * web ** (2.0 * p[TAIL])))


def _fading_web(values: Mapping[str, float]) -> float:
    """The web over which the surface goes, where it is deep enough to be seen to: the integral of dw / A between the
    shares of TIMED, as if all of it went at that rate."""
    depth, power = min(values["depth"], LARGEST_DEPTH), 2.0 * values["tail"]
    if depth <= SHALLOW:
        return 0.0
    shown = 1.0 - (1.0 - depth) ** 2

    def surface(web: np.ndarray) -> np.ndarray:
        return np.sqrt(1.0 - shown * np.exp(-2.0 * web**power))

    def web_at(share: float) -> float:
        return float((0.5 * np.log(shown / (1.0 - share**2))) ** (1.0 / power))

    high, low = TIMED[0], max(TIMED[1], 1.0 - depth)
    first, last = web_at(low) if low > 1.0 - depth else 0.0, web_at(high)
    webs = first + (last - first) * 0.5 * (1.0 + NODES)
    ramp = 0.5 * (last - first) * float(WEIGHTS @ (1.0 / surface(webs))) * depth / (high - low)
    share = (depth - SHALLOW) / (1.0 - SHALLOW)
    return values["width"] * ramp * share * (2.0 - share)


EFFECT = Effect(
    name="fuel_sliver",
    plain_name="fuel that ends unevenly",
    equation="grain",
    meaning="the fuel is gone in some places before it is in others; what is left burns from a smaller surface",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapters 12 and 16: slivers at burn-out. The port's "
    "radius is that of the fuel left. Where webs are spread evenly, the square of the burning share falls as the fuel "
    "left (k = 1/2); where remainders of any thinness go on, each as the last, the share itself does (k = 1), which "
    "fades exponentially. No web is the first of all for certain, so that the walls show one after another from the "
    "beginning: the share leaves 1 without a corner",
    formula="(A_burning / (2 pi r L))^2 = 1 - d (2 - d) exp(-2 ((R - r) / w)^(2 k))",
    sites=("regression_factor",),
    parameters=(
        Parameter("depth", "-", "share of the surface burnt through when the last fuel goes", 0.5, low=0.0, high=1.0),
        Parameter(
            "width",
            "m",
            "web left, over the whole surface, at which many walls show",
            6e-3,
            center=1e-3,
            low=3e-6,
            high=2e-2,
        ),
        Parameter("tail", "-", "power with which the surface falls as the fuel left", 0.2, 0.65, low=0.5, high=0.97),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    fading_web=_fading_web,
    twins=(),
    decisive="pictures of the plume, and the slivers themselves after the test",
    believable=Believable("depth", 0.95, "beyond that the end would not be seen at all", unit="%", factor=100.0),
)
