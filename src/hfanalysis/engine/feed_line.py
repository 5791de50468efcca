"""The feed line between tank and injector, and the pressure that it loses (report, chapter 4)."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.compiled import Real, compiled, inlined, law
from hfanalysis.engine.equations import AREA, LIQUID_LOSS, LOSS_FACTOR, VAPOR_LOSS, Equations
from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.sites import (
    FEED_FACTOR,
    FEED_LOSS,
    INJECTOR_FACTOR,
    OXIDIZER_FLOW,
    P_CHAMBER,
    P_RUN,
    P_TANK,
    RHO_FEED,
)


@dataclass(frozen=True)
class FeedSystem:
    """Tank volume [m^3], effective injector area C_i N_i A_i [m^2], and the feed loss.

    The loss is K_loss mdot^2 / rho with ``loss_factor`` [1/m^4], or, where ``constant_losses`` is given, the report's
    constant pressure losses (liquid phase, vapor phase) [Pa].
    """

    volume: float
    area: float
    loss_factor: float = 0.0
    constant_losses: tuple[float, float] | None = None


NO_STATED_LOSSES = (-1.0, -1.0)
"""In their place where the loss is quadratic [Pa]. Source: by definition, a negative loss stands for the quadratic
law."""


@law
def line_loss(factor: Real, flow: Real, density: Real) -> Real:
    """K_loss mdot^2 / rho [Pa]; ``factor`` K_loss [1/m^4], ``flow`` [kg/s], ``density`` [kg/m^3]."""
    return factor * flow * flow / density


@compiled
def line_flow(area: float, factor: float, stated: float, density: float, drop: float) -> float:
    """mdot [kg/s] through line and injector at a ``drop`` [Pa] over both.

    The line loses what is ``stated`` [Pa], or where that is negative K_loss mdot^2 / rho, ``factor`` K_loss [1/m^4].
    """
    if stated >= 0.0:
        return mass_flow(area, density, drop - stated)
    return mass_flow_with_feed(area, factor, density, drop)


@inlined
def feed(liquid: bool, m: Equations) -> None:
    """Flow [kg/s] through feed line and injector and the pressure [Pa] between them, into ENVIRONMENT."""
    c, env, site = m.c, m.env, m.site
    drop = env[P_TANK] - env[P_CHAMBER] - site[FEED_LOSS]
    factor, stated = c[LOSS_FACTOR] * site[FEED_FACTOR], c[LIQUID_LOSS] if liquid else c[VAPOR_LOSS]
    flow = line_flow(c[AREA], factor, stated, env[RHO_FEED], drop) * site[INJECTOR_FACTOR]
    loss = stated if stated >= 0.0 else line_loss(factor, flow, env[RHO_FEED])
    env[OXIDIZER_FLOW], env[P_RUN] = flow, env[P_TANK] - loss - site[FEED_LOSS]
