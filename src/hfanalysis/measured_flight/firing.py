"""The firing as the rocket feels it: thrust at altitude and mass on an even clock."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import rocket
from hfanalysis.errors import AbsentError
from hfanalysis.flight.curve import STEPS, Curve, accumulated, altitude_gain, even_curve
from hfanalysis.measured_flight.propellant import Propellant, propellant
from hfanalysis.measured_flight.thrust import MeasuredThrust, measured_thrust
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo import atmosphere, combustion

RAW, CORRECTED = "as measured on the stand", "from the stand's ambient pressure to the altitude's"

EQUILIBRIA = 60
"""Equilibria over a burn; the gas changes slowly, and thrust hardly follows its heat capacity ratio."""

LIT = 1.3
"""Chamber over ambient pressure [-] from which on the gas is worth an equilibrium; below, the nearest one holds."""


@dataclass(frozen=True)
class Firing:
    """What flies: the rocket, its rail [m] and canopies, thrust and mass over the burn, and what they come from.

    ``gas_mass``: in the chamber [kg] on the curve's clock, None where its pressure or size is not known.
    """

    vehicle: Vehicle
    rail_length: float | None
    canopies: tuple[Parachute, Parachute] | str
    curve: Curve
    thrust: MeasuredThrust
    propellant: Propellant
    gas_mass: Array | None
    thrust_is: str
    notes: tuple[str, ...]

    @property
    def wet_mass(self) -> float:
        """Of the rocket on its pad [kg]."""
        return self.vehicle.dry_mass + float(self.propellant.total[0])


def firing(
    log: TestLog,
    segments: Segments | None,
    calibration: Calibration | None,
    definition: TestDefinition,
    raw_thrust: bool = False,
) -> Firing:
    """Assemble what flies. Raises AbsentError where the test lacks what a flight needs, with the reason."""
    vehicle = rocket.vehicle(definition.rocket, definition.folder, launch_altitude(definition))
    if not isinstance(vehicle, Vehicle):
        raise AbsentError(f"test {definition.test.id}: there is nothing to fly: {vehicle}")
    assert definition.rocket is not None
    thrust = measured_thrust(log, segments, definition)
    load = propellant(log, segments, calibration, definition, thrust)
    # samples may be further apart than the curve's steps: what is linear between them stays so
    time = np.union1d(thrust.time, np.linspace(0.0, thrust.burn_time, 2 * STEPS + 1))
    impulse = accumulated(time, np.interp(time, thrust.time, thrust.thrust))
    mass = vehicle.dry_mass + np.interp(time, load.time, load.total)
    carried = 0.0 if definition.model.conventions == "report" else float(load.total[-1])
    curve = even_curve(time, impulse, mass, vehicle.dry_mass + carried)
    gas = _chamber_gas(curve.time, log, segments, definition, load)
    said = "raw thrust was asked for" if raw_thrust else _no_correction(gas, definition)
    if gas is not None and not said:
        curve = _at_altitude(curve, gas, definition)
    rail = definition.rocket.rail_length
    return Firing(
        vehicle,
        rail.value if rail else None,
        rocket.parachutes(definition.rocket),
        curve,
        thrust,
        load,
        None if gas is None else _gas_mass(curve.time, gas, definition, load),
        RAW if said else CORRECTED,
        (*thrust.notes, *((f"thrust as measured on the stand: {said}",) if said else ()), _coasting(carried, load)),
    )


def _coasting(carried: float, load: Propellant) -> str:
    left = float(load.total[-1])
    coasts = "with" if carried else "without"
    return f"{left:.2f} kg of propellant are left after the burn; the rocket coasts {coasts} them"


def launch_altitude(definition: TestDefinition) -> float:
    """Of the launch [m]: the rocket's, else the stand's, else that of the ambient pressure."""
    if definition.rocket is not None and definition.rocket.launch_altitude is not None:
        return definition.rocket.launch_altitude.value
    if definition.site is not None and definition.site.altitude is not None:
        return definition.site.altitude.value
    return atmosphere.altitude_of(definition.ambient_pressure.value)


def _no_correction(gas: ChamberGas | None, definition: TestDefinition) -> str:
    """Why the thrust cannot be taken to altitude; empty where it can."""
    nozzle = definition.nozzle
    if nozzle is None or nozzle.throat_radius is None or nozzle.exit_radius is None:
        return "[nozzle] throat_radius and exit_radius are not both given"
    return "the log has no live p_chamber" if gas is None else ""


def _at_altitude(curve: Curve, gas: ChamberGas, definition: TestDefinition) -> Curve:
    """The curve with the nozzle's gain by ambient pressure."""
    nozzle = definition.nozzle
    assert nozzle is not None
    assert nozzle.throat_radius is not None
    assert nozzle.exit_radius is not None
    areas = [pi * radius.value**2 for radius in (nozzle.throat_radius, nozzle.exit_radius)]
    gain, ambients = altitude_gain(gas.gamma, gas.pressure, definition.ambient_pressure.value, areas[0], areas[1])
    return replace(curve, gain=gain, ambients=ambients)


@dataclass(frozen=True)
class ChamberGas:
    """In the chamber over time: measured pressure [Pa]; frozen heat capacity ratio and R T [J/kg] at equilibrium."""

    pressure: Array
    gamma: Array
    specific_temperature: Array


def _chamber_gas(
    time: Array, log: TestLog, segments: Segments | None, definition: TestDefinition, load: Propellant
) -> ChamberGas | None:
    """At the O/F of the flows, as the quasi-steady chamber has it; None without a live chamber pressure."""
    channel = log.get("p_chamber")
    if channel is None or segments is None or Signal.of(channel).dead:
        return None
    signal = Signal.of(channel).shifted(segments.t_open.value or 0.0)
    pressure = signal.reduced(float(time[1] - time[0])).at(time)
    ambient = definition.ambient_pressure.value
    combustion.restart()
    lit = np.flatnonzero(pressure > LIT * ambient)
    chosen = lit[:: max(lit.size // EQUILIBRIA, 1)] if lit.size else np.array([int(np.argmax(pressure))])
    ratio = np.interp(time, load.time, load.of_ratio)
    found = [combustion.equilibrium(max(float(pressure[i]), ambient), float(ratio[i])) for i in chosen]
    gamma, rt = np.array([(gas.gamma, gas.gas_constant * gas.temperature) for gas in found]).T
    return ChamberGas(pressure, np.interp(time, time[chosen], gamma), np.interp(time, time[chosen], rt))


def _gas_mass(time: Array, gas: ChamberGas, definition: TestDefinition, load: Propellant) -> Array | None:
    """m = p V / (R T) [kg], the port as wide as the fuel left it; None where the chamber's size is not known."""
    grain, chamber = definition.grain, definition.chamber
    if chamber is None or grain is None or grain.density is None or grain.outer_radius is None or grain.length is None:
        return None
    dead = sum(volume.value for volume in (chamber.pre_volume, chamber.post_volume) if volume is not None)
    casing = pi * grain.outer_radius.value**2 * grain.length.value
    volume = dead + casing - np.interp(time, load.time, load.fuel) / grain.density.value
    return np.asarray(np.maximum(gas.pressure, 0.0) * volume / gas.specific_temperature)
