"""The firing as the rocket feels it: thrust at altitude and mass on an even clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.errors import AbsentError
from hfanalysis.flight.curve import Curve, accumulated, altitude_gain, even_curve
from hfanalysis.flight.descent import Parachute
from hfanalysis.flight.vehicle import Vehicle
from hfanalysis.launch.propellant import Propellant, propellant
from hfanalysis.launch.thrust import MeasuredThrust, measured_thrust
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal
from hfanalysis.simulate import rocket
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog
from hfanalysis.thermo import atmosphere, combustion

Array = NDArray[np.float64]

RAW, CORRECTED = "as measured on the stand", "from the stand's ambient pressure to the altitude's"

GAMMAS = 60
"""Equilibria over a burn; the heat capacity ratio changes slowly, and thrust hardly follows it."""

LIT = 1.3
"""Chamber over ambient pressure from which on the gas is worth an equilibrium; below, the nearest one holds."""


@dataclass(frozen=True)
class Firing:
    """What flies: the rocket, its rail [m] and canopies, thrust and mass over the burn, and what they come from."""

    vehicle: Vehicle
    rail_length: float | None
    canopies: tuple[Parachute, Parachute] | str
    curve: Curve
    thrust: MeasuredThrust
    propellant: Propellant
    thrust_is: str
    notes: tuple[str, ...]

    @property
    def wet_mass(self) -> float:
        """Of the rocket on its pad [kg]."""
        return self.vehicle.dry_mass + float(self.propellant.total[0])


def firing(
    log: TestLog,
    segments: Segments | None,
    calibration: Mapping[str, Any] | None,
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
    mass = vehicle.dry_mass + np.interp(thrust.time, load.time, load.total)
    carried = 0.0 if definition.model.conventions == "report" else float(load.total[-1])
    curve = even_curve(thrust.time, accumulated(thrust.time, thrust.thrust), mass, vehicle.dry_mass + carried)
    curve, said = (
        (curve, "raw thrust was asked for") if raw_thrust else _at_altitude(curve, log, segments, definition, load)
    )
    rail = definition.rocket.rail_length
    return Firing(
        vehicle,
        rail.value if rail else None,
        rocket.parachutes(definition.rocket),
        curve,
        thrust,
        load,
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


def _at_altitude(
    curve: Curve, log: TestLog, segments: Segments | None, definition: TestDefinition, load: Propellant
) -> tuple[Curve, str]:
    """The curve with the nozzle's gain by ambient pressure; else the curve as it is, and why."""
    nozzle, channel = definition.nozzle, log.get("p_chamber")
    if nozzle is None or nozzle.throat_radius is None or nozzle.exit_radius is None:
        return curve, "[nozzle] throat_radius and exit_radius are not both given"
    if channel is None or Signal.of(channel).dead:
        return curve, "the log has no live p_chamber"
    assert segments is not None
    signal = Signal.of(channel).shifted(segments.t_open.value or 0.0)
    pressure = signal.reduced(curve.step).at(curve.time)
    stand = definition.ambient_pressure.value
    gamma = _gamma(curve.time, pressure, stand, load)
    throat, exit_area = (pi * radius.value**2 for radius in (nozzle.throat_radius, nozzle.exit_radius))
    gain, ambients = altitude_gain(gamma, pressure, stand, throat, exit_area)
    return replace(curve, gain=gain, ambients=ambients), ""


def _gamma(time: Array, pressure: Array, stand: float, load: Propellant) -> Array:
    """Heat capacity ratio of the chamber gas over time, frozen, at the O/F of the flows."""
    combustion.restart()
    lit = np.flatnonzero(pressure > LIT * stand)
    chosen = lit[:: max(lit.size // GAMMAS, 1)] if lit.size else np.array([int(np.argmax(pressure))])
    ratio = np.interp(time, load.time, load.of_ratio)
    found = [combustion.equilibrium(max(float(pressure[i]), stand), float(ratio[i])).gamma for i in chosen]
    return np.interp(time, time[chosen], found)
