"""Regression that depends on the chamber's pressure.

In one firing pressure and flux fall together: n takes the place of nearly any power of the pressure, and what can be
seen is how that power changes with it.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import P_CHAMBER, RATES, REGRESSION_FACTOR, term

EXPONENT, BEND, REFERENCE = range(3)

LEAST_BENT = 1e-5
"""Value [-] below which the series of (exp(x) - 1)/x is as good as the quotient."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == RATES:
        above = np.log(env[P_CHAMBER] / p[REFERENCE])
        bent = p[BEND] * above
        share = np.expm1(bent) / bent if abs(bent) > LEAST_BENT else 1.0 + 0.5 * bent
        site[REGRESSION_FACTOR] *= np.exp(p[EXPONENT] * above * share)


EFFECT = Effect(
    name="grain_pressure_regression",
    plain_name="regression that depends on the pressure",
    equation="grain",
    meaning="the fuel regresses faster at higher chamber pressure",
    reference="Zilliac and Karabeyoglu, Hybrid Rocket Fuel Regression Rate Data and Modeling, AIAA 2006-4504; "
    "the entrained share of a melting fuel depends on the gas's dynamic pressure: Karabeyoglu, Altman and Cantwell, "
    "J. Propulsion and Power 18 (2002) 610",
    formula="dr/dt = a G^n exp(k ((p_c/p_ref)^b - 1) / b), for b = 0 a G^n (p_c / p_ref)^k",
    sites=("regression_factor",),
    parameters=(
        Parameter("exponent", "-", "power of the chamber pressure at p_ref", typical=0.2, low=-0.5, high=1.5),
        Parameter("bend", "-", "power of the pressure with which that power grows", typical=0.7, low=-1.0, high=1.5),
        Parameter("reference", "Pa", "pressure at which a holds", 10e5, center=10e5, low=1e5, high=100e5, given=True),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    far_starts=(0.6, 0.9),
    twins=(),
    decisive="the port's radius over time (ultrasound), or firings at two chamber pressures of one oxidizer flow",
    believable=Believable("exponent", 0.6, "paraffin's regression hardly knows the pressure"),
)
