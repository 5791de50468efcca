"""A throat that grows while the engine burns."""

from __future__ import annotations

from math import pi, sqrt

from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.equations import THROAT_AREA
from hfanalysis.engine.sites import HOT_SHARE, IS_BURNING, P_CHAMBER, RATES, THROAT_FACTOR, term

RATE, EXPONENT, HEATING = range(3)
REFERENCE_PRESSURE = 20e5
"""Chamber pressure [Pa] at which the rate is stated. Source: by definition of the rate."""


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES:
        return
    widening = 1.0 + x[0] / sqrt(c[THROAT_AREA] / pi)
    site[THROAT_FACTOR] *= widening * widening
    if env[IS_BURNING] > 0.0:
        hot = t * t / (t * t + p[HEATING] * p[HEATING])
        dx[0] = p[RATE] * hot * env[HOT_SHARE] * (env[P_CHAMBER] / REFERENCE_PRESSURE) ** p[EXPONENT]


EFFECT = Effect(
    name="nozzle_throat_erosion",
    plain_name="throat that erodes",
    equation="nozzle",
    meaning="the throat's radius grows by chemical erosion of its graphite",
    reference="diffusion of the oxidizing species to the wall limits it, so that it goes with p_c^0.8: Bianchi and "
    "Nasuti, J. Propulsion and Power 29 (2013) 547; at a wall that is still cold "
    "kinetics limit it: Thakre and Yang, J. Propulsion and Power 24(4), 2008; onsets differ from firing to firing: "
    "Nozzle Erosion Reconstruction Model, Aerospace 13(7), 575 (2026)",
    formula="r_t = r_t0 + x,  dx/dt = s t^2 / (t^2 + tau^2) (p_c / 20 bar)^0.8 while fuel burns",
    sites=("throat_factor",),
    parameters=(
        Parameter("rate", "m/s", "growth of the throat's radius at 20 bar", typical=1e-4, low=0.0, high=2e-3),
        Parameter("exponent", "-", "power of the chamber pressure", 0.1, center=0.8, low=0.0, high=1.2, given=True),
        Parameter("heating", "s", "until the wall erodes at half its rate", 0.9, center=0.3, low=0.01, high=20.0),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    states=(OwnState("throat_growth", "m", 1e-6, lambda engine, values: 0.0),),
    twins=("chamber_tap_lag",),
    decisive="the throat's diameter after the test",
    believable=Believable("rate", 4e-4, "graphite loses some tenths of a millimetre a second", unit="mm/s", factor=1e3),
)
