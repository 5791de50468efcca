"""Extra gas right after ignition."""

from __future__ import annotations

from math import pi, sin

from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.sites import FUEL_SOURCE, OXIDIZER_SOURCE, RATES, term

MASS, DURATION, RATIO, SKEW = range(4)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES or t >= p[DURATION]:
        return
    if t <= 0.0:
        return
    s = t / p[DURATION]
    u = s ** p[SKEW]
    wave = sin(pi * u)
    flow = 2.0 * p[MASS] / p[DURATION] * p[SKEW] * u / s * wave * wave
    fuel = flow / (1.0 + p[RATIO])
    site[FUEL_SOURCE] += fuel
    site[OXIDIZER_SOURCE] += flow - fuel
    dx[0] = -flow


EFFECT = Effect(
    name="ignition_transient",
    plain_name="igniter's charge",
    equation="chamber_mass",
    meaning="the igniter, and fuel that it melted or broke off, add gas to the chamber for a while",
    reference="report, section 4.4: HF4's peak in chamber pressure with its abrupt fall, which the model lacks; "
    "Sutton and Biblarz, Rocket Propulsion Elements, chapters 14 and 16 (igniters, start transients)",
    formula="mdot = 2 m/tau q s^(q-1) sin^2(pi s^q), s = t/tau, for t < tau, of which 1/(1 + O/F) as fuel",
    sites=("fuel_source", "oxidizer_source"),
    parameters=(
        Parameter("mass", "kg", "gas that is added in all", typical=0.05, low=0.0, high=1.0),
        Parameter("duration", "s", "when it ends", 0.4, center=0.8, low=0.05, high=5.0),
        Parameter(
            "of_ratio", "-", "oxidizer over fuel of the added gas", 2.0, center=4.0, low=0.2, high=20.0, given=True
        ),
        Parameter(
            "skew", "-", "1: falls as long as it rises; less: falls slowly; more: abruptly", 0.35, 0.75, 0.4, 2.0
        ),
    ),
    phases=("liquid",),
    term=_term,
    states=(OwnState("igniter_mass", "kg", 1e-4, lambda engine, values: values["mass"]),),
    twins=(),
    decisive="the igniter's charge, weighed, and its pressure in a test without oxidizer",
    believable=Believable("mass", 0.15, "igniter charges weigh some ten grams", unit="g", factor=1e3),
)
