"""Liquid that flashes on its way through the injector, so that its flow hardly asks for the chamber's pressure.

The vapor that follows expands on the same way: saturated vapor is where homogeneous equilibrium flow ends as the
share of liquid goes to nothing.
"""

from __future__ import annotations

from math import log, sqrt

from hfanalysis.compiled import compiled
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, FEED_FACTOR, INJECTOR_FACTOR, IS_LIQUID, P_CHAMBER, P_TANK, T_TANK, term

WEIGHT, OMEGA, LINE, VAPOR = range(4)
GAMMA = 1.2
"""Isentropic exponent of the vapor [-]. Evidence: saturated vapor has 1.21 at 278 K and 1.25 at 298 K (CoolProp)."""

OMEGA_AT, OMEGA_SLOPE, LEAST_OMEGA = 285.0, -0.032, 1.0
"""Temperature [K] at which omega is stated, its slope [1/K] for saturated nitrous oxide, and the least of it."""

LEAST_DROP = 1e-4
"""Relative pressure drop [-] below which flashing and single-phase flow agree."""


@compiled
def flashing_flow(ratio: float, omega: float) -> float:
    """G / sqrt(p_0 rho_0) [-] of homogeneous equilibrium flow that starts as saturated liquid (Leung 1986), eta = p /
    p_0.

    >>> round(flashing_flow(0.9, 1.0), 4)
    0.4131
    """
    return sqrt(-2.0 * (omega * log(ratio) + (omega - 1.0) * (1.0 - ratio))) / (omega * (1.0 / ratio - 1.0) + 1.0)


@compiled
def critical_ratio(omega: float) -> float:
    """eta = p / p_0 [-] at which flashing flow is largest: the root in (0, 1) of eta^2 + (w^2 - 2 w)(1 - eta)^2 + 2 w^2
    (ln eta + 1 - eta), by Newton's method (Leung 1986).

    >>> round(critical_ratio(1.0), 4)
    0.6065
    """
    eta, w2 = 0.55 + 0.217 * log(max(omega, 0.5)), omega * omega
    for _ in range(8):
        gap = 1.0 - eta
        value = eta * eta + (w2 - 2.0 * omega) * gap * gap + 2.0 * w2 * (log(eta) + gap)
        slope = 2.0 * eta - 2.0 * (w2 - 2.0 * omega) * gap + 2.0 * w2 * (1.0 / eta - 1.0)
        step = value / slope
        eta = min(max(eta - step, 0.5 * eta), 0.5 * (1.0 + eta))
        if abs(step) < 1e-13:
            break
    return eta


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != AT_FLOW:
        return
    ratio = min(max(env[P_CHAMBER] / env[P_TANK], 0.0), 1.0 - LEAST_DROP)
    if env[IS_LIQUID] == 0.0:
        site[INJECTOR_FACTOR] *= 1.0 + p[WEIGHT] * p[VAPOR] * (expanding_flow(ratio, GAMMA) - 1.0)
        return
    omega = max(p[OMEGA] + OMEGA_SLOPE * (env[T_TANK] - OMEGA_AT), LEAST_OMEGA)
    # at the critical ratio the flow is stationary: holding it there leaves no corner
    flashing = flashing_flow(max(ratio, critical_ratio(omega)), omega)
    share = 1.0 + p[WEIGHT] * (flashing / sqrt(2.0 * (1.0 - ratio)) - 1.0)
    site[INJECTOR_FACTOR] *= share
    site[FEED_FACTOR] *= 1.0 + p[LINE] * (1.0 / (share * share) - 1.0)


EFFECT = Effect(
    name="injector_two_phase",
    plain_name="two-phase flow in the injector",
    equation="injector",
    meaning="the liquid flashes in line and injector: less flow, which responds less to the chamber's pressure",
    reference="single-phase and homogeneous equilibrium flow blended as by Dyer et al., AIAA 2007-5702: weight "
    "1/(1 + kappa), one half for saturated liquid; equilibrium flow by Leung, AIChE Journal 32 (1986) 1743, with omega "
    "= c_p T p / v_l ((v_v - v_l) / (h_v - h_l))^2, which is 3.7 to 2.9 for nitrous oxide from 270 to 295 K",
    formula="f = 1 - w + w G_eq(max(eta, eta_c)) / sqrt(2 (1 - eta)),  eta = p_c / p_T;  mdot = f mdot_injector;  "
    "K_loss (1 + l (1 / f^2 - 1)): the line's loss grows as it flashes there too; in the vapour "
    "f = 1 + w v (psi / sqrt(2 (1 - eta)) - 1), psi of the isentropic orifice",
    sites=("injector_factor", "feed_factor"),
    parameters=(
        Parameter("weight", "-", "0 single-phase, 1 homogeneous equilibrium", typical=0.5, low=0.0, high=1.0),
        Parameter(
            "omega",
            "-",
            "compressibility of the flashing liquid at 285 K",
            0.3,
            center=3.1,
            low=1.0,
            high=8.0,
            given=True,
        ),
        Parameter("line", "-", "how far the line takes part", typical=0.5, center=0.5, low=0.0, high=1.0),
        Parameter("vapor", "-", "how far the vapour takes part", typical=0.5, center=0.5, low=0.0, high=1.0),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=(),
    decisive="cold flow of liquid through the injector at two back pressures",
    believable=Believable("weight", 1.0, "1 is equilibrium all the way"),
)
