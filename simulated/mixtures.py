"""Burns whose mixture is known: chamber pressure and thrust of engines of many sizes, by laws of their own.

The regression goes with the oxidizer's or the total flux and may fade, the efficiency may fall, the throat may erode;
pressure, thrust, flow and masses carry errors of the size that they state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from types import SimpleNamespace
from typing import cast

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.port import stagnation_over_static
from hfanalysis.performance.reconstruction.inputs import Firing, Shape
from hfanalysis.performance.reconstruction.theory import Theory
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel
from hfanalysis.units import Value

AMBIENT, ENTHALPY, DENSITY, STEP = 1.0e5, 1.6e6, 920.0, 0.02
"""[Pa], [J/kg] of liquid nitrous oxide at 20 degC, [kg/m^3] of paraffin, [s]."""


@dataclass(frozen=True)
class Burn:
    """What was really so, (n,) at ``time`` [s], and the ``test`` as it was measured."""

    time: Array
    of_ratio: Array
    efficiency: Array
    throat: Array
    exponent: float
    test: Firing


@dataclass(frozen=True)
class World:
    """How a burn goes: throat radius [m], area ratio, time [s], mixture at first, efficiency at first and what it falls
    by, growth of the throat [m], flux exponent; what of the fuel counts in the flux and what the rate fades by through
    the burn [-]; and which measurements there are."""

    throat: float = 0.012
    area_ratio: float = 3.0
    lasts: float = 5.0
    mixture: float = 7.0
    efficiency: float = 0.93
    falls: float = 0.0
    erodes: float = 0.0
    exponent: float = 0.55
    of_fuel: float = 0.5
    fades: float = 0.0
    pressure: float = 22e5
    weighed: bool = True
    calipered: bool = True
    thrust: bool = True
    noise: float = 0.002


ERRORS = {"zero": 5e3, "gain": 5e-3, "flow": 0.012, "fuel": 4e-3, "radius": 3e-5, "thrust": 0.004, "nozzle": 0.02}
"""Standard deviations: zero [Pa], gain, flow, fuel's mass [-], radii [m], thrust of its largest, nozzle's loss [-]."""


def world(seed: int) -> World:
    """One of many."""
    r = np.random.default_rng(seed)
    return World(
        throat=float(r.uniform(0.007, 0.028)),
        area_ratio=float(r.uniform(2.0, 6.0)),
        lasts=float(r.uniform(3.0, 12.0)),
        mixture=float(r.uniform(4.5, 9.0)),
        efficiency=float(r.uniform(0.85, 1.0)),
        falls=float(r.choice([0.0, r.uniform(0.0, 0.08)])),
        erodes=float(r.choice([0.0, r.uniform(0.0, 1e-3)])),
        exponent=float(r.uniform(0.4, 0.65)),
        pressure=float(r.uniform(12e5, 40e5)),
        noise=float(r.choice([0.001, 0.003, 0.01])),
        of_fuel=float(r.choice([0.0, 0.5])),
        fades=float(r.choice([0.0, 0.0, 0.15])),
    )


def burn(of: World, seed: int) -> Burn:
    """A burn in a world, its errors drawn from ERRORS."""
    r = np.random.default_rng(seed)
    area, exit_area = pi * of.throat**2, of.area_ratio * pi * of.throat**2
    theory = Theory.of(ENTHALPY, area, exit_area)
    time = np.arange(0.0, of.lasts, STEP)
    share = time / of.lasts
    oxidizer = _first_flow(theory, of, area) * np.exp(-0.35 * share)
    throat = of.throat + of.erodes * share
    efficiency = of.efficiency - of.falls * share
    port0, length = 1.45 * of.throat, 22.0 * of.throat
    port, mixture, pressure = _run(theory, of, time, oxidizer, pi * throat**2, efficiency, (port0, length))
    fuel = oxidizer / mixture
    thrust = (1.0 - 0.5 * ERRORS["nozzle"]) * (
        theory.at(theory.vacuum, pressure, mixture) * pressure * pi * throat**2 - AMBIENT * exit_area
    )
    burnt = float(np.trapezoid(fuel, time))
    outer = float(np.sqrt(port[-1] ** 2 + 1e-5))
    mass = DENSITY * pi * length * (outer**2 - port0**2)
    gamma = float(np.mean(theory.at(theory.gamma, pressure, mixture)))
    static = pressure / stagnation_over_static(gamma, pi * outer**2 / area)
    test = _measured(r, of, time, static, thrust, oxidizer, burnt, mass, (port0, outer, length, area, exit_area), port)
    return Burn(time, mixture, efficiency, throat, of.exponent, test)


def _first_flow(theory: Theory, of: World, area: float) -> float:
    """Oxidizer flow [kg/s] that makes the world's pressure at its first mixture."""
    at = theory.at(theory.c_star, np.array([of.pressure]), np.array([of.mixture]))[0]
    return float(of.pressure * area / (of.efficiency * at * (1.0 + 1.0 / of.mixture)))


def _run(
    theory: Theory, of: World, time: Array, oxidizer: Array, area: Array, efficiency: Array, grain: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Port [m], mixture [-] and pressure [Pa] over time."""
    port0, length = grain
    flux0 = oxidizer[0] * (1.0 + of.of_fuel / of.mixture) / (pi * port0**2)
    rate0 = oxidizer[0] / of.mixture / (2.0 * pi * port0 * length * DENSITY)
    port, mixture, radius, fuel = np.empty(time.size), np.empty(time.size), port0, oxidizer[0] / of.mixture
    for i in range(time.size):
        for _ in range(3):
            flux = (oxidizer[i] + of.of_fuel * fuel) / (pi * radius**2)
            rate = rate0 * (flux / flux0) ** of.exponent * (1.0 - of.fades * time[i] / of.lasts)
            fuel = 2.0 * pi * radius * length * DENSITY * rate
        port[i], mixture[i] = radius, oxidizer[i] / fuel
        radius += STEP * rate
    pressure = np.full(time.size, of.pressure)
    for _ in range(6):
        c_star = theory.at(theory.c_star, pressure, mixture)
        pressure = efficiency * c_star * oxidizer * (1.0 + 1.0 / mixture) / area
    return port, mixture, pressure


def _measured(
    r: np.random.Generator, of: World, time: Array, pressure: Array, thrust: Array, oxidizer: Array, burnt: float,
    mass: float, shape: tuple[float, float, float, float, float], port: Array,
) -> Firing:  # fmt: skip
    """What a team would have of it."""
    port0, outer, length, area, exit_area = shape
    e = {name: std * r.standard_normal() for name, std in ERRORS.items()}
    read = (1.0 + e["gain"]) * pressure + e["zero"] + of.noise * of.pressure * r.standard_normal(time.size)
    force = thrust + e["thrust"] * thrust.max() + of.noise * thrust.max() * r.standard_normal(time.size)
    bias = float(np.hypot(ERRORS["zero"], ERRORS["gain"] * of.pressure))
    made = {"p_chamber": (read, bias), "thrust": (force, ERRORS["thrust"] * float(thrust.max()))}
    there = [name for name in made if name != "thrust" or of.thrust]
    log = {n: _channel(n, time, *made[n]) for n in there}
    left = mass - burnt * (1.0 + e["fuel"])
    after = of.throat + of.erodes + 3e-5 * r.standard_normal()
    observed = SimpleNamespace(
        fuel_mass_after=Value(left, ERRORS["fuel"] * burnt) if of.weighed else None,
        throat_radius_after=Value(after, ERRORS["radius"]) if of.calipered else None,
        burn_time=None,
    )
    definition = SimpleNamespace(
        fuel=None,
        channels={"p_chamber": SimpleNamespace(tap="aft")}, grain=SimpleNamespace(mass=Value(mass, 0.0)),
        observed=observed, nozzle=SimpleNamespace(throat_radius=Value(of.throat, ERRORS["radius"])),
        ambient_pressure=Value(AMBIENT, 0.0),
    )  # fmt: skip
    definition.known = _known(definition)
    flow = oxidizer * (1.0 + e["flow"])
    shape = Shape(
        throat_area=area, exit_area=exit_area, port_radius=port0, outer_radius=outer, grain_length=length,
        dead_volume=0.0, fuel_density=DENSITY, oxidizer_enthalpy=ENTHALPY,
    )  # fmt: skip
    passed = Quantity(float(np.trapezoid(flow, time)), "kg", ERRORS["flow"] * float(np.trapezoid(flow, time)))
    return cast("Firing", SimpleNamespace(
        log=log, segments=SimpleNamespace(time=lambda name: 0.1 if name == "t_feed" else None),
        definition=definition, calibration=SimpleNamespace(oxidizer_mass_liquid_phase=passed),
        fire=SimpleNamespace(end=float(time[-1])), shape=shape, time=time, oxidizer=flow, ambient=AMBIENT,
        measured={"p_chamber": read, **({"thrust_corrected": force} if of.thrust else {})},
    ))  # fmt: skip


def _known(definition: SimpleNamespace) -> Callable[[str], Value | None]:
    """As a definition has it: all of it is stated with its deviation."""

    def known(key: str) -> Value | None:
        section, name = key.split(".")
        return cast("Value | None", getattr(getattr(definition, section), name))

    return known


def _channel(name: str, time: Array, values: Array, accuracy: float) -> Channel:
    unit = "N" if name == "thrust" else "Pa"
    return Channel(name, unit, time, values, np.zeros(time.size, dtype=np.uint8), accuracy, True, name)
