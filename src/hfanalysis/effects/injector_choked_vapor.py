"""Vapor that expands, and chokes, on its way through the injector."""

from __future__ import annotations

from math import sqrt

from hfanalysis.compiled import Real, compiled, law
from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, IS_LIQUID, P_CHAMBER, P_TANK, term

WEIGHT, GAMMA = range(2)
LEAST_DROP = 1e-4
"""Relative pressure drop [-] below which the two laws agree."""


@law
def critical_ratio(gamma: Real) -> Real:
    """p / p_0 [-] at and below which a gas of isentropic exponent ``gamma`` [-] chokes (Sutton and Biblarz, chapter 3).

    >>> round(critical_ratio(1.4), 4)
    0.5283
    """
    return (2.0 / (gamma + 1.0)) ** (gamma / (gamma - 1.0))


@compiled
def expanding_flow(ratio: float, gamma: float) -> float:
    """Flow of a gas that expands to p / p_0, or chokes, over that of an incompressible fluid of the density at p_0 [-].

    ``ratio`` p / p_0 [-], ``gamma`` [-] (Sutton and Biblarz, Rocket Propulsion Elements, chapter 3).

    >>> round(expanding_flow(0.9, 1.2), 4)
    0.9361
    """
    ratio = min(max(ratio, 0.0), 1.0 - LEAST_DROP)
    # at the critical ratio the flow is stationary: holding it there leaves no corner
    throat = max(ratio, critical_ratio(gamma))
    square = gamma / (gamma - 1.0) * (throat ** (2.0 / gamma) - throat ** ((gamma + 1.0) / gamma)) / (1.0 - ratio)
    return sqrt(square)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != AT_FLOW or env[IS_LIQUID] > 0.0:
        return
    flow = expanding_flow(env[P_CHAMBER] / env[P_TANK], p[GAMMA])
    site[INJECTOR_FACTOR] *= 1.0 + p[WEIGHT] * (flow - 1.0)


EFFECT = Effect(
    name="injector_choked_vapor",
    plain_name="vapor that chokes in the injector",
    equation="injector",
    meaning="the vapor flows through the injector as a gas that expands and chokes, not as an incompressible fluid",
    reference="isentropic orifice flow: Sutton and Biblarz, Rocket Propulsion Elements, chapter 3; Hill and Peterson, "
    "Mechanics and Thermodynamics of Propulsion, chapter 3. The report's eq. 3.2 is incompressible in both phases; "
    "line and injector are taken as one restriction between tank and chamber",
    formula="mdot = mdot_base (1 + w (psi / sqrt(2 (1 - eta)) - 1)),  eta = p_c / p_T,  "
    "psi^2 = 2 g/(g-1) (eta^(2/g) - eta^((g+1)/g)), held below the critical eta",
    sites=("injector_factor",),
    parameters=(
        Parameter("weight", "-", "0 incompressible, 1 isentropic orifice", typical=1.0, low=0.0, high=1.0),
        Parameter("gamma", "-", "isentropic exponent of the vapor", 0.1, center=1.2, low=1.02, high=1.5, given=True),
    ),
    phases=("vapor", "nitrogen"),
    term=_term,
    twins=(),
    decisive="cold flow of the vapor through the injector at two back pressures",
    believable=Believable("weight", 1.0, "1 is compressible flow, choked where it must be"),
)
