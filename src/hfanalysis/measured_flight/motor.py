"""The motor that a firing is to flight simulators: along its flight, and as the stand measured it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.assembly.shape import shape
from hfanalysis.flight import engine_files
from hfanalysis.flight.engine_files import Course, Export
from hfanalysis.flight.motor import Points, points_of
from hfanalysis.flight.stability import Launch, StabilityRuns
from hfanalysis.measured_flight.held import propellant_center
from hfanalysis.measured_flight.product import MeasuredFlight
from hfanalysis.record.definition import TestDefinition


def rocketpy(launched: MeasuredFlight, definition: TestDefinition, stable: StabilityRuns | str, motor: Export) -> str:
    """The flight as a script for RocketPy."""
    firing = launched.firing
    launch = Launch(firing.curve, firing.vehicle, firing.rail_length)
    return engine_files.rocketpy(launch, shape(definition.rocket), firing.canopies, stable, motor)


def export(launched: MeasuredFlight, definition: TestDefinition, stable: StabilityRuns | str) -> Export:
    """The firing along its flight: thrust at the altitudes flown through, propellant that burns.

    The engine's center of gravity is that of ``stable``, where it is known.
    """
    firing = launched.firing
    center = propellant_center(firing, definition) if isinstance(stable, str) else stable.engine_center
    curve, trace = firing.curve, launched.ascent
    thrust = np.interp(curve.time, trace.column("time"), trace.column("thrust"))
    mass = np.maximum(curve.mass - curve.mass_after, 0.0)
    unknown = center if isinstance(center, str) else ""
    course = Course(
        points_of(curve.time, thrust, mass, None if isinstance(center, str) else center),
        tuple(_comments(launched, definition)),
        _static(launched, definition),
        float(firing.propellant.total[0]),
        unknown,
    )
    return engine_files.export(definition.test.id, course, definition, firing.vehicle, stable)


def _static(launched: MeasuredFlight, definition: TestDefinition) -> tuple[Points, tuple[str, ...]]:
    """The thrust of the stand, not that along the flight."""
    thrust, ambient = launched.firing.thrust, definition.ambient_pressure.value
    said = f"thrust as measured on the stand, purge gas included, at an ambient pressure of {ambient / 1e5:.4f} bar"
    return points_of(thrust.time, thrust.thrust), (_origin(definition), said)


def _origin(definition: TestDefinition) -> str:
    source = {"replica": "REPLICA, generated, not measured", "synthetic": "SYNTHETIC, generated, not measured"}
    return f"{definition.test.id}: {source.get(definition.test.source, 'measured on the stand')}"


def _comments(launched: MeasuredFlight, definition: TestDefinition) -> Iterator[str]:
    firing = launched.firing
    altitude = firing.vehicle.launch_altitude
    yield _origin(definition)
    yield f"thrust {firing.thrust_basis}, {firing.thrust_is}, along the flight from {altitude:.0f} m"
