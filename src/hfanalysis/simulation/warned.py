"""The numbers of a design and of a simulated burn that the rules of :mod:`hfanalysis.engine.cautions` look at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

import numpy as np

from hfanalysis.arrays import Mask
from hfanalysis.assembly import engine as build
from hfanalysis.assembly import tank
from hfanalysis.engine import cautions
from hfanalysis.engine.cautions import Cautions
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.nozzle import characteristic_velocity
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.flight import constant_thrust
from hfanalysis.flight.pitch import HIGH, LOW
from hfanalysis.flight.stability import StabilityRuns
from hfanalysis.products.beyond import Beyond
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.steady_design import steady
from hfanalysis.steady_design.injector import behind_line
from hfanalysis.steady_design.steady import OptimumMixture, Requirement, SteadyEngine
from hfanalysis.thermo.combustion import equilibrium
from hfanalysis.thermo.combustion_table import gas_at

RATIOS = np.geomspace(2.0, 15.0, 40)
"""O/F [-] among which the best is looked for: as in a steady design, in steps of 5 %. Evidence: at 5 to 40 bar the
best of them has the highest c* to 3e-4."""

RISEN = 0.9
"""Share of its peak [-] that the chamber's pressure has to have come to before a burn is judged. Source: by choice:
ignition itself passes through every pressure, in milliseconds."""


def of_burn(engine: Engine, burnt: Burn, flight: Mapping[str, Quantity]) -> Cautions:
    """Of a simulated burn and the quantities of the flight on it [SI]."""
    return tuple(_of_burn(engine, burnt, flight))


def of_stability(stable: StabilityRuns | str) -> Cautions:
    """Of the static margin in winds: in that where it is worst, on either side."""
    if isinstance(stable, str):
        return ()
    winds = [one.product() for one in stable.margins]
    low, high = min(winds, key=lambda one: one.least), max(winds, key=lambda one: one.largest)
    worst = low if low.least < LOW else high
    return cautions.static_margin(worst.least, worst.largest, (LOW, HIGH), worst.wind)


def _windows(burnt: Burn) -> tuple[Mask, Mask]:
    """Where the chamber has come to its pressure and burns, and where liquid flows as well, (n,) each."""
    chamber = burnt.output("chamber_pressure")
    before_end = burnt.time <= burnt.burn_time
    lit = np.arange(chamber.size) >= int(np.argmax(chamber >= RISEN * chamber[before_end].max()))
    burning = lit & before_end
    return burning, burning if burnt.liquid_out is None else burning & (burnt.time <= burnt.liquid_out)


def lowest_stiffness(burnt: Burn) -> float:
    """Lowest pressure drop of the injector over the chamber's pressure while liquid flows [-]; NaN: none does."""
    _, liquid = _windows(burnt)
    chamber = burnt.output("chamber_pressure")
    return float(((burnt.output("run_pressure") - chamber) / chamber)[liquid].min()) if liquid.any() else float("nan")


def _of_burn(engine: Engine, burnt: Burn, flight: Mapping[str, Quantity]) -> Iterator[Beyond]:
    burning, liquid = _windows(burnt)
    if liquid.any():
        yield from cautions.stiffness(lowest_stiffness(burnt))
        drop = burnt.output("run_pressure") - burnt.output("chamber_pressure")
        yield from cautions.reversed_flow(float(drop[liquid].min()))
        yield from _of_nozzle(engine, burnt, liquid)
    flux = oxidizer_flux(burnt.output("oxidizer_flow"), burnt.state("port_radius"))
    yield from cautions.oxidizer_flux(float(flux[burning].max()))
    yield from _of_mixture(engine, burnt, burning)
    yield from cautions.frozen_tank(float(burnt.state("tank_temperature").min()))
    if burnt.fuel_out and burnt.liquid_out is None:
        density = float(engine.saturation.vapor_density(burnt.state("tank_temperature")[burning][-1]))
        yield from cautions.left_over(float(burnt.state("tank_mass")[burning][-1]), engine.feed.volume * density)
    speed, ratio = flight["rail_departure_velocity"].value, flight["pad_thrust_to_weight"].value
    yield from cautions.rail_speed(speed) if speed is not None else ()
    yield from cautions.thrust_to_weight(ratio) if ratio is not None else ()


def _of_mixture(engine: Engine, burnt: Burn, burning: Mask) -> Cautions:
    """By c* at the burn's mean O/F, pressure and enthalpy of the oxidizer."""
    fuel = engine.fuel_mass - engine.grain.fuel(float(burnt.state("port_radius")[burning][-1]))
    used = engine.oxidizer_mass - float(burnt.state("tank_mass")[burning][-1])
    if not (fuel > 0.0 and used > 0.0 and burning.sum() > 1):
        return ()
    pressure, enthalpy = (
        _mean(burnt, name, burning) for name in ("chamber_pressure", "oxidizer_enthalpy")
    )  # fmt: skip

    def velocity(ratio: float) -> float:
        rt, gamma = gas_at(engine.combustion.kernel, np.log(pressure), np.log(ratio), enthalpy, 0.0)
        return float(characteristic_velocity(rt, gamma))

    of_each = [velocity(ratio) for ratio in RATIOS]
    best = int(np.argmax(of_each))
    lost = 1.0 - velocity(used / fuel) / of_each[best]
    return cautions.mixture(used / fuel, float(RATIOS[best]), lost, "characteristic velocity")


def _mean(burnt: Burn, name: str, burning: Mask) -> float:
    time, values = burnt.time[burning], burnt.output(name)[burning]
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))


def _of_nozzle(engine: Engine, burnt: Burn, liquid: Mask) -> Cautions:
    """Where the chamber's pressure is lowest while liquid flows."""
    pressure = burnt.output("chamber_pressure")
    at = int(np.flatnonzero(liquid)[np.argmin(pressure[liquid])])
    outside, gamma = (float(burnt.output(name)[at]) for name in ("ambient_pressure", "gamma"))
    return cautions.separation(float(pressure[at]), outside, gamma, engine.exit_area / engine.throat_area)


def of_design(needs: Needs, asked: Requirement, port_radius: float, found: SteadyEngine, best: OptimumMixture
              ) -> Cautions:  # fmt: skip
    """Of a steady design with its initial ``port_radius`` [m], its rocket and the tank that the file states."""
    chamber = asked.chamber_pressure
    gas = equilibrium(chamber, found.of_ratio, asked.oxidizer_enthalpy, fuel=asked.fuel)
    lost = 1.0 - steady.ideal_specific_impulse(asked, found.of_ratio) / best.specific_impulse
    return (
        *_of_feed(needs, asked),
        *cautions.oxidizer_flux(asked.oxidizer_flow / (pi * port_radius**2)),
        *cautions.mixture(found.of_ratio, best.of_ratio, lost, "specific impulse"),
        *cautions.separation(chamber, asked.ambient, gas.gamma, (found.exit_radius / found.throat_radius) ** 2),
        *_of_launch(needs.file, found),
    )


def _of_feed(needs: Needs, asked: Requirement) -> Cautions:
    """What the tank has left before the injector; a file without the tank's temperature does not say."""
    if needs.file.tank.temperature is None:
        return ()
    held = behind_line(tank.saturated(needs), build.line_loss(needs.file), asked.oxidizer_flow)
    above = cautions.beyond_tank(asked.chamber_pressure, held)
    return above or cautions.stiffness(held / asked.chamber_pressure - 1.0)


def _of_launch(file: EngineFile, found: SteadyEngine) -> Cautions:
    vehicle = build.vehicle(file)
    if not isinstance(vehicle, Vehicle):
        return ()
    ratio = cautions.thrust_to_weight(found.thrust_to_weight(vehicle))
    rail = file.rocket.guided_length if file.rocket else None
    if rail is None:
        return ratio
    try:
        speed = constant_thrust.rail_speed(vehicle, found.thrust, found.propellant_flow, found.burn_time, rail)
    except ValueError:  # it stays on its pad: thrust to weight has said so
        return ratio
    return (*cautions.rail_speed(speed), *ratio)
