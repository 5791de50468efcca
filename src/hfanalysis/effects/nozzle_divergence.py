"""Thrust lost in a nozzle whose flow does not leave it along its axis."""

from __future__ import annotations

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import RATES, THRUST_FACTOR, term


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        site[THRUST_FACTOR] *= 1.0 - p[0]


EFFECT = Effect(
    name="nozzle_divergence",
    plain_name="divergence of the nozzle",
    equation="nozzle",
    meaning="the nozzle's thrust falls short of the one-dimensional one by a constant share",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapter 3: a cone of half angle alpha keeps "
    "(1 + cos alpha)/2, 0.983 at 15 degrees",
    formula="F = (1 - e) F_ideal",
    sites=("thrust_factor",),
    parameters=(Parameter("loss", "-", "share of the thrust that is lost", typical=0.02, low=-0.05, high=0.3),),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=(),
    decisive="the nozzle's contour, or thrust and chamber pressure of a firing with cold gas",
    believable=Believable(
        "loss",
        0.12,
        "a cone of 40 degrees half-angle loses 12 %",
        unit="%",
        factor=100.0,
        least=-0.01,
        least_why="no nozzle gives more than the ideal one, whose coefficient is known to 1 %",
    ),
)
