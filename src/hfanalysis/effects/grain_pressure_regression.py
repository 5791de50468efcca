"""Regression that depends on the chamber's pressure."""

from __future__ import annotations

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import P_CHAMBER, RATES, REGRESSION_FACTOR, term

EXPONENT, REFERENCE = range(2)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        site[REGRESSION_FACTOR] *= (env[P_CHAMBER] / p[REFERENCE]) ** p[EXPONENT]


EFFECT = Effect(
    name="grain_pressure_regression",
    equation="grain",
    meaning="the fuel regresses faster at higher chamber pressure",
    reference="Zilliac and Karabeyoglu, Hybrid Rocket Fuel Regression Rate Data and Modeling, AIAA 2006-4504; "
    "the entrained share of a melting fuel depends on the gas's dynamic pressure: Karabeyoglu, Altman and Cantwell, "
    "J. Propulsion and Power 18 (2002) 610",
    formula="dr/dt = a G^n (p_c / p_ref)^k",
    sites=("regression_factor",),
    parameters=(
        Parameter("exponent", "-", "power of the chamber pressure", typical=0.1, low=-0.5, high=1.0),
        Parameter("reference", "Pa", "pressure at which a holds", 5e5, center=15e5, low=1e5, high=100e5, given=True),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=(),
    decisive="the port's radius over time (ultrasound), or firings at two chamber pressures of one oxidizer flow",
)
