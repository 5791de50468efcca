"""Engine files of a firing, as its rocket feels it, for flight simulators."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.shape import shape
from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.motor import Motor, Points, points_of
from hfanalysis.flight.rocketpy_script import Scripted, script
from hfanalysis.measured_flight.product import MeasuredFlight
from hfanalysis.measured_flight.stability import StabilityRuns, propellant_center
from hfanalysis.performance.thrust import OUT, motor_class
from hfanalysis.record.definition import TestDefinition
from hfanalysis.rocket.aerodynamics import Shape
from hfanalysis.rocket.vehicle import Vehicle

SLENDER = 25.0
"""Length over diameter [-] of a rocket whose geometry is not known; only RocketPy's inertia follows it."""

OF_GRAIN = "length: no casing_length is stated; what is known of tank and grain"

NO_LENGTH = "length: not known; the diameter stands in for it"

BY_THEMSELVES = "total mass: propellant alone, the empty engine belongs to the rocket's dry mass"


@dataclass(frozen=True)
class Export:
    """A motor, its curve, comments for people, and radii [m] of throat and exit (0: not known).

    ``static``: the curve as the stand measured it, and what is to be said of it.
    """

    motor: Motor
    points: Points
    comments: tuple[str, ...]
    radii: tuple[float, float]
    static: tuple[Points, tuple[str, ...]]

    @property
    def static_eng(self) -> str:
        """The stand's thrust as a RASP file, for simulators that take thrust to altitude themselves."""
        return rasp.of_points(self.motor, *self.static)

    @property
    def eng(self) -> str:
        """As a RASP file."""
        return rasp.of_points(self.motor, self.points, self.comments)

    @property
    def rse(self) -> str:
        """As a RockSim file."""
        return rocksim.text(self.motor, self.points, self.comments, self.radii)


def rocketpy(launched: MeasuredFlight, definition: TestDefinition, stable: StabilityRuns | str, motor: Export) -> str:
    """The flight as a script for RocketPy; without a geometry the rocket has no surfaces and flies in still air."""
    firing, weighed = launched.firing, None if isinstance(stable, str) else stable
    outside = shape(definition.rocket)
    known = outside if isinstance(outside, Shape) else None
    length = known.length if known is not None else SLENDER * 2.0 * float(np.sqrt(firing.vehicle.frontal_area / np.pi))
    engine = weighed.place.dry if weighed is not None else None
    return script(
        Scripted(
            vehicle=firing.vehicle,
            motor=motor.motor,
            points=motor.points,
            shape=known,
            canopies=None if isinstance(firing.canopies, str) else firing.canopies,
            rail_length=firing.rail_length,
            empty_mass=float(engine.mass) if engine is not None else 0.0,
            pitch_inertia=firing.vehicle.dry_mass * length**2 / 12.0,
            center_of_mass=length - (float(weighed.place.fixed[0].center) if weighed is not None else 0.5 * length),
            nozzle_radius=motor.radii[1],
        ),
        motor.comments[0],
    )


def export(launched: MeasuredFlight, definition: TestDefinition, stable: StabilityRuns | str) -> Export:
    """The firing along its flight: thrust at the altitudes flown through, propellant that burns.

    The engine's center of gravity is that of ``stable``, where it is known.
    """
    center = propellant_center(launched.firing, definition) if isinstance(stable, str) else stable.engine_center
    curve, trace = launched.firing.curve, launched.ascent
    time = curve.time
    thrust = np.interp(time, trace.column("time"), trace.column("thrust"))
    mass = np.maximum(curve.mass - curve.mass_after, 0.0)
    points = points_of(time, thrust, mass, None if isinstance(center, str) else center)
    motor = _motor(launched, definition, float(mass[0]), stable)
    said = (*_comments(launched, definition), *_of_weight(definition, center, stable), _designation(points))
    return Export(motor, points, said, _radii(definition), _static(launched, definition))


def _static(launched: MeasuredFlight, definition: TestDefinition) -> tuple[Points, tuple[str, ...]]:
    """The thrust of the stand, not that along the flight."""
    thrust, ambient = launched.firing.thrust, definition.ambient_pressure.value
    points = points_of(thrust.time, thrust.thrust)
    said = f"thrust as measured on the stand, purge gas included, at an ambient pressure of {ambient / 1e5:.4f} bar"
    return points, (_origin(definition), said, _designation(points))


def _origin(definition: TestDefinition) -> str:
    source = {"replica": "REPLICA, generated, not measured", "synthetic": "SYNTHETIC, generated, not measured"}
    return f"{definition.test.id}: {source.get(definition.test.source, 'measured on the stand')}"


def _motor(launched: MeasuredFlight, definition: TestDefinition, burnt: float, stable: StabilityRuns | str) -> Motor:
    geometry = definition.rocket.geometry if definition.rocket is not None else None
    engine = geometry.engine_mass.value if geometry is not None and geometry.engine_mass is not None else 0.0
    loaded = float(launched.firing.propellant.total[0])
    diameter, length = _size(definition, launched.firing.vehicle)
    if not isinstance(stable, str) and not _casing(definition)[1]:
        length = stable.place.where.length
    return Motor(definition.test.id, diameter, length, burnt, engine + loaded)


def _casing(definition: TestDefinition) -> tuple[float, float]:
    """Diameter and length [m] as stated (0: not)."""
    rocket = definition.rocket
    stated = (rocket.casing_diameter, rocket.casing_length) if rocket is not None else (None, None)
    return stated[0].value if stated[0] else 0.0, stated[1].value if stated[1] else 0.0


def _size(definition: TestDefinition, vehicle: Vehicle) -> tuple[float, float]:
    """Diameter and length [m] of the motor: the casing's as stated, else of tank and grain; else as wide as the rocket.

    A length that is not known is the diameter's, since no file can do without one.
    """
    grain, tank = definition.grain, definition.tank
    widths = [2.0 * grain.outer_radius.value] if grain is not None and grain.outer_radius is not None else []
    widths += [tank.inner_diameter.value] if tank is not None and tank.inner_diameter is not None else []
    width = max(widths, default=2.0 * float(np.sqrt(vehicle.frontal_area / np.pi)))
    length = grain.length.value if grain is not None and grain.length is not None else width
    stated = _casing(definition)
    return stated[0] or width, stated[1] or length


def _radii(definition: TestDefinition) -> tuple[float, float]:
    nozzle = definition.nozzle
    throat, leave = (None, None) if nozzle is None else (nozzle.throat_radius, nozzle.exit_radius)
    return (throat.value if throat else 0.0), (leave.value if leave else 0.0)


def _comments(launched: MeasuredFlight, definition: TestDefinition) -> tuple[str, ...]:
    altitude = launched.firing.vehicle.launch_altitude
    geometry = definition.rocket.geometry if definition.rocket is not None else None
    said = [_origin(definition)]
    said += [
        f"thrust {launched.firing.thrust_basis}, {launched.firing.thrust_is}, along the flight from {altitude:.0f} m"
    ]
    said += [] if geometry is not None and geometry.engine_mass is not None else [BY_THEMSELVES]
    long = definition.grain is not None and definition.grain.length is not None
    if not _casing(definition)[1]:
        said += [OF_GRAIN if long else NO_LENGTH]
    return tuple(said)


def _of_weight(definition: TestDefinition, center: Array | str, stable: StabilityRuns | str) -> Iterator[str]:
    """Where the center of gravity is from, and what is not known of it."""
    if isinstance(center, str):
        yield f"center of gravity: not in this file: {center}"
    elif isinstance(stable, str) or stable.place.dry is None:
        yield "center of gravity: of tank and grain with what they hold; the empty engine is not weighed apart"
    if definition.rocket is None or definition.rocket.geometry is None:
        yield "no [rocket.geometry] is given: sizes are those of the casing, or of tank and grain"


def _designation(points: Points) -> str:
    """Burn time and average thrust as a motor's designation has them (NFPA 1125)."""
    time, thrust = points.by_share(OUT)
    letter = motor_class(points.impulse).split()[0]
    return (
        f"burn_time_5_percent {time:.3f} s, average_thrust_5_percent {thrust:.1f} N: from the first to the last "
        f"{100.0 * OUT:.0f} % of the peak (NFPA 1125), {letter}{thrust:.0f}; "
        f"the curve goes on to {points.time[-1]:.2f} s"
    )
