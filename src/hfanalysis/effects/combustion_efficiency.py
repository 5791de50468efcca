"""Combustion that falls short of equilibrium by a constant share of its characteristic velocity."""

from __future__ import annotations

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.sites import AT_CHAMBER, HOT_SHARE, TEMPERATURE_FACTOR, term


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_CHAMBER:
        site[TEMPERATURE_FACTOR] *= 1.0 - env[HOT_SHARE] * p[0] * (2.0 - p[0])


EFFECT = Effect(
    name="combustion_efficiency",
    plain_name="incomplete combustion",
    equation="chamber_energy",
    meaning="the burnt gas has a lower characteristic velocity than in equilibrium",
    reference="Sutton and Biblarz, Rocket Propulsion Elements, chapters 3 and 16: c* = eta c*_ideal, 0.90 to 0.98 in "
    "hybrids; c* goes with sqrt(R T)",
    formula="R T = (1 - e)^2 (R T)_equilibrium of the burnt gas",
    sites=("temperature_factor",),
    parameters=(
        Parameter("deficit", "-", "share of the characteristic velocity that is lost", 0.05, low=-0.05, high=0.5),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=("chamber_heat_loss",),
    decisive="the fuel's mass after a firing that is cut short, which fixes the fuel flow behind c*",
    believable=Believable(
        "deficit",
        0.25,
        "an engine that burns at all gives three quarters",
        unit="%",
        factor=100.0,
        least=-0.01,
        least_why="gas gives no more than at equilibrium, which tables know to 1 %",
    ),
)
