"""Boiling that starts late: right after opening the tank's pressure dips below saturation and rebounds."""

from __future__ import annotations

from math import exp

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import AT_TANK, TANK_PRESSURE, term

DEPTH, DELAY = range(2)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_TANK:
        s = t / p[DELAY]
        site[TANK_PRESSURE] -= p[DEPTH] * s * exp(1.0 - s)


EFFECT = Effect(
    name="tank_nonequilibrium",
    equation="tank_volume",
    meaning="vapour is made late: the tank's pressure dips below that of saturation after opening, and rebounds",
    reference="Zimmerman, Waxman, Cantwell and Zilliac, Review and Evaluation of Models for Self-Pressurizing "
    "Propellant Tank Dynamics, AIAA 2013-4045: superheat of the liquid until bubbles are there. The dip is that "
    "of two equal lags in a row (bubbles, then vapour)",
    formula="p_T = p_sat - dp (t/tau) exp(1 - t/tau)",
    sites=("tank_pressure",),
    parameters=(
        Parameter("depth", "Pa", "lowest pressure below saturation", typical=2e5, low=0.0, high=2e6),
        Parameter("delay", "s", "when it is lowest", 0.15, center=0.25, low=0.02, high=3.0),
    ),
    phases=("liquid",),
    term=_term,
    twins=("tank_stratification",),
    decisive="a thermocouple in the tank's liquid, which stays warmer than saturation while the boiling lags",
)
