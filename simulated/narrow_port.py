"""An engine whose port is as wide as its throat, and what a gauge at its head reads.

The port's flow is followed from its end to its head with mass, heat and friction along the way, which
:mod:`hfanalysis.engine.port` does not do: there the port's ends are enough. Oxidizer comes in as a cool, dense gas that
is already moving, fuel with the wall's velocity, none.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import pi, sqrt

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from simulated.engines import engine_on_stand

from hfanalysis.arrays import Array
from hfanalysis.engine.nozzle import mach_at_area, pressure_ratio
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.budget import Input
from hfanalysis.performance.efficiency import Ideal, Spread, efficiencies, ideal, means
from hfanalysis.performance.flows import HISTORY_STEP, Flows
from hfanalysis.performance.measured import Fire
from hfanalysis.products.validation import Efficiencies

FIRE = Fire(4.4, 0.01, "simulated")
STEADY = 0.4
"""[s] from which on means are taken: the chamber is filled."""

SURE = Spread(pressure=0.002, throat=0.003, oxidizer=0.002, fuel=0.0, cell=(Input("load cell", 0.003),))
"""Relative deviations of gauge, throat, flow of oxidizer and cell [-] that the analysis is told."""

FRICTION = 0.003
"""Fanning's factor of the port's wall [-]. Source: turbulent pipes at a Reynolds number of 1e6."""

COOL = 0.08
"""R T of the oxidizer where it enters the port, over that of the burnt gas [-]. Source: nitrous oxide at 400 K."""

POINTS = 40
"""Instants at which the port's flow is followed."""


@dataclass(frozen=True)
class Fired:
    """A burn: its flows, what gauge and cell read, and what is true before the nozzle; (n,) each on the flows' time."""

    engine: Engine
    flows: Flows
    nozzle: Array
    head: Array
    thrust: Array


def judged(test: Fired, tap: str | None, read: str) -> tuple[Efficiencies, Ideal]:
    """Efficiencies as validate takes them, of a gauge at ``tap`` that reads the ``head`` or the ``nozzle``."""
    measured = {"p_chamber": getattr(test, read), "thrust_corrected": test.thrust}
    ambient = test.engine.ambient_pressure
    assert ambient is not None
    found = ideal(measured, test.flows, test.engine, ambient, FIRE, None, tap)
    assert found is not None
    part = found.counted & (test.flows.time > STEADY)
    return means(efficiencies(measured, test.flows, test.engine, found), found, part, SURE), found


@cache
def fired(recovery: float, seconds: float = 4.5) -> Fired:
    """The hot fires' engine for some seconds; behind the grain the flow widens with this ``recovery`` [-]."""
    made = burn(engine_on_stand(oxidizer_enthalpy=engine_on_stand().oxidizer_enthalpy), seconds + 0.5)
    engine = engine_on_stand(oxidizer_enthalpy=float(np.median(made.output("oxidizer_enthalpy"))))
    time = np.arange(0.0, seconds, HISTORY_STEP)
    found = {
        n: np.interp(time, made.time, made.output(n))
        for n in ("chamber_pressure", "thrust", "oxidizer_flow", "fuel_flow")
    }
    port = np.interp(time, made.time, made.state("port_radius"))
    rate = np.gradient(port, time)
    flows = Flows(time, found["oxidizer_flow"], found["fuel_flow"], rate, port)
    p = found["chamber_pressure"]
    return Fired(engine, flows, p, p * heads(made, engine, time, recovery), found["thrust"])


def heads(made: Burn, engine: Engine, time: Array, recovery: float) -> Array:
    """Pressure at the head over the stagnation pressure before the nozzle [-], (n,) at ``time`` (n,) [s]."""
    where = np.linspace(0.2, time[-1], POINTS)
    names = ("gamma", "oxidizer_flow", "fuel_flow")
    gamma, oxidizer, fuel = (np.interp(where, made.time, made.output(n)) for n in names)
    port = np.interp(where, made.time, made.state("port_radius"))
    given = zip(gamma, port, fuel / oxidizer, strict=True)
    return np.interp(time, where, [_head(engine, g, r, share, recovery) for g, r, share in given])


def _head(engine: Engine, gamma: float, radius: float, fuel: float, recovery: float) -> float:
    """By marching; pressures over the nozzle's stagnation pressure, lengths over the port's length."""
    area, chamber = pi * radius**2 / engine.throat_area, pi * engine.outer_radius**2 / engine.throat_area
    smooth, mixed = _end_smooth(gamma, area), _end_mixed(gamma, area, chamber)
    mach, pressure = (recovery * a + (1.0 - recovery) * b for a, b in zip(smooth, mixed, strict=True))
    # flow per area and R T in units in which p = rho (R T), both 1 for the burnt gas at rest
    hot = 1.0 / (1.0 + 0.5 * (gamma - 1.0) * mach * mach)
    flux = pressure / hot * mach * sqrt(gamma * hot)
    perimeter = 2.0 * engine.grain_length / radius

    def state(x: float, thrust: float) -> tuple[float, float]:
        """Pressure and velocity where a share x of the port is passed, of p + G u."""
        flow = flux * (1.0 + fuel * x) / (1.0 + fuel)
        heat = hot * (COOL + (1.0 - COOL) * x)
        p = 0.5 * (thrust + sqrt(max(thrust * thrust - 4.0 * flow * flow * heat, 0.0)))
        return p, flow * heat / p

    def friction(x: float, thrust: Array) -> list[float]:
        p, velocity = state(x, float(thrust[0]))
        heat = hot * (COOL + (1.0 - COOL) * x)
        return [-FRICTION * 0.5 * p / heat * velocity**2 * perimeter]

    end = pressure + flux * flux * hot / pressure
    first = float(solve_ivp(friction, (1.0, 0.0), [end], rtol=1e-8).y[0, -1])
    p, velocity = state(0.0, first)
    return p + 0.5 * p / (hot * COOL) * velocity**2


def _end_smooth(gamma: float, area: float) -> tuple[float, float]:
    """Mach number and static pressure at the port's end, where the flow behind it loses nothing."""
    mach = mach_at_area(max(area, 1.0), gamma, False)
    return mach, pressure_ratio(mach, gamma) / min(area, 1.0)


def _end_mixed(gamma: float, area: float, chamber: float) -> tuple[float, float]:
    """The same, where the port's jet mixes with what is in the post-chamber: mass and momentum, by a root."""
    third = mach_at_area(chamber, gamma, False)

    def flow(mach: float) -> float:
        return mach * sqrt(1.0 + 0.5 * (gamma - 1.0) * mach * mach)

    def lacking(mach: float) -> float:
        p = flow(third) * chamber / (flow(mach) * area)
        return p * (chamber + gamma * mach * mach * area) - chamber * (1.0 + gamma * third * third)

    mach = float(brentq(lacking, 0.05, 1.0)) if lacking(1.0) < 0.0 else 1.0
    return mach, flow(third) * chamber / (flow(mach) * area) * pressure_ratio(third, gamma)
