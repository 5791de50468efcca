"""By how much the laws of an engine's equations may differ from the ones that the base model has.

The base model takes an orifice of one coefficient, a loss with the square of the flow, a polytrope of one exponent, a
regression with the oxidizer's flux alone, equilibrium and a one-dimensional nozzle. Right models of one engine differ
from these by some per cent. As with the tables of nitrous oxide, such a departure is a constant of every hypothesis:
no effect is named, and nothing is called unknown, for what another law of the same equation explains.
"""

from __future__ import annotations

from dataclasses import replace
from math import exp, log

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.equations import OUTER_RADIUS
from hfanalysis.engine.sites import (
    AT_CHAMBER,
    AT_FLOW,
    FEED_FACTOR,
    HOT_SHARE,
    INJECTOR_FACTOR,
    IS_LIQUID,
    OF_RATIO,
    OXIDIZER_FLOW,
    P_CHAMBER,
    P_TANK,
    PORT_RADIUS,
    RATES,
    REGRESSION_FACTOR,
    RHO_FEED,
    TANK_HEAT,
    TEMPERATURE_FACTOR,
    THRUST_FACTOR,
    term,
)
from hfanalysis.engine.unsteady import Engine

USUAL_FLOW = 20e5 * 800.0
"""Pressure times density [Pa kg/m^3] about which what goes with the flow turns. Source: an injector of 20 bar."""

USUAL_PRESSURE, USUAL_RATIO, USUAL_MIXTURE, USUAL_PORT = 20e5, 0.3, 6.0, 0.75
"""Pressure [Pa], chamber's over tank's [-], oxidizer to fuel [-] and port over grain [-] about which the others turn.
Source: engines of this class; where a departure turns is taken up by the constants."""

LEANEST, RICHEST = 30.0, 1.0
"""Oxidizer to fuel [-] between which a mixture counts. Source: beyond it hardly anything burns."""

CRACK = 0.05
"""Part of its area that a valve has from the beginning [-], for nothing flows through none. Source: by choice; the time
in which it opens further counts."""

GRUENEISEN = 0.25
"""Rise of pressure by heat in the vapor, p V over it [-]. Source: gamma - 1 of nitrous oxide's vapor at 270 K."""

(LOSS_POWER, REYNOLDS, RATIO, OF_VAPOR, MIXTURE, PRESSURE, EXPONENT, PORT, FUEL_FLUX, THRUST, OPENING) = range(11)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    liquid = env[IS_LIQUID] > 0.0
    if hook == AT_CHAMBER:
        mixture = log(min(max(env[OF_RATIO], RICHEST), LEANEST) / USUAL_MIXTURE)
        bent = p[MIXTURE] * mixture + p[PRESSURE] * log(max(env[P_CHAMBER], 1e4) / USUAL_PRESSURE)
        site[TEMPERATURE_FACTOR] *= exp(env[HOT_SHARE] * bent)
    elif hook == AT_FLOW:
        drop = max(env[P_TANK] - env[P_CHAMBER], 1e3) * env[RHO_FEED]
        flow = 0.5 * log(drop / USUAL_FLOW)
        site[FEED_FACTOR] *= exp(p[LOSS_POWER] * flow)
        behind = p[RATIO] * (env[P_CHAMBER] / max(env[P_TANK], 1e4) - USUAL_RATIO)
        site[INJECTOR_FACTOR] *= exp(p[REYNOLDS] * flow + behind + (0.0 if liquid else p[OF_VAPOR]))
        if t < p[OPENING]:
            site[INJECTOR_FACTOR] *= max(t / p[OPENING], CRACK)
    elif hook == RATES:
        if not liquid:
            work = env[OXIDIZER_FLOW] * env[P_TANK] / env[RHO_FEED]
            site[TANK_HEAT] += p[EXPONENT] * work / GRUENEISEN * log(max(env[P_TANK], 1e4) / USUAL_PRESSURE)
        fuel = log((1.0 + 1.0 / min(max(env[OF_RATIO], RICHEST), LEANEST)) / (1.0 + 1.0 / USUAL_MIXTURE))
        site[REGRESSION_FACTOR] *= exp(
            p[PORT] * log(env[PORT_RADIUS] / (USUAL_PORT * c[OUTER_RADIUS])) + p[FUEL_FLUX] * fuel
        )
        site[THRUST_FACTOR] *= 1.0 - p[THRUST]


LAWS = Effect(
    name="other_laws",
    equation="injector",
    meaning="laws of the same equations that right models of an engine may have",
    reference="see the parameters",
    sites=("feed_factor", "injector_factor", "temperature_factor", "tank_heat", "regression_factor", "thrust_factor"),
    strengths=11,
    parameters=(
        Parameter("loss", "-", "power of the flow that a line's loss goes with, less 2: turbulent flow in smooth tubes "
                  "has 1.75, through fittings 2", 0.1),
        Parameter("reynolds", "-", "power of the flow that the injector's coefficient goes with: drilled holes a few "
                  "diameters long lose some per cent where the Reynolds number falls to a third", 0.02),
        Parameter("back pressure", "-", "change of its logarithm with the chamber's pressure over the tank's, by which "
                  "a liquid near saturation flashes more or less in the holes", 0.05),
        Parameter("vapor", "-", "change of its logarithm for vapor: expansion and vena contracta of a gas", 0.03),
        Parameter("mixture", "-", "change of the gas' temperature with the logarithm of oxidizer to fuel: c* in frozen "
                  "or shifting flow, and how well it is mixed", 0.03),
        Parameter("pressure", "-", "the same with the pressure, by what dissociates less", 0.01),
        Parameter("exponent", "-", "change of the vapor's polytropic exponent with the logarithm of its pressure: heat "
                  "from the wall comes later than the expansion", 0.03),
        Parameter("port", "-", "power of the port that the regression goes with: published laws have -0.2 to 0", 0.1),
        Parameter("fuel's flux", "-", "power of the total flux over the oxidizer's that it goes with: half of the n of "
                  "a law by the total flux, for the fuel's own is half of it on the mean", 0.25),
        Parameter("boundary layer", "-", "part of the thrust that a nozzle's boundary layer takes", 0.005),
        Parameter("valve", "s", "time in which the valve opens: a solenoid or pneumatic one takes 10 to 40 ms, and an "
                  "instant that is seen late is no area that grows", 0.02),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
)  # fmt: skip
"""The ``typical`` size of each is its standard deviation, independent of the others."""


def engine_by_laws(engine: Engine, departures: Array) -> Engine:
    """An engine by laws that depart so far (laws,), in standard deviations."""
    sizes = {law.name: law.typical * float(x) for law, x in zip(LAWS.parameters, departures, strict=True)}
    return replace(engine, effects=(*engine.effects, LAWS.at(**sizes)))
