"""Engine files for flight simulators: what a firing or a simulated burn is to them, and what is said in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hfanalysis.flight import rasp, rocksim
from hfanalysis.flight.motor import OUT, Motor, Points, motor_class
from hfanalysis.flight.rocketpy_script import Scripted, script
from hfanalysis.flight.stability import Launch, StabilityRuns
from hfanalysis.record.rocket import Rocket
from hfanalysis.record.sections import GrainSection, NozzleSection, Tank
from hfanalysis.rocket.aerodynamics import Shape
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle

SLENDER = 25.0
"""Length over diameter [-] of a rocket whose geometry is not known; only RocketPy's inertia follows it."""

OF_GRAIN = "length: no casing_length is stated; what is known of tank and grain"

NO_LENGTH = "length: not known; the diameter stands in for it"

BY_THEMSELVES = "total mass: propellant alone, the empty engine belongs to the rocket's dry mass"


class Stated(Protocol):
    """What sizes a motor: sections of test.toml or of an engine file, None where they are not given."""

    @property
    def rocket(self) -> Rocket | None:
        """[rocket]."""

    @property
    def tank(self) -> Tank | None:
        """[tank]."""

    @property
    def grain(self) -> GrainSection | None:
        """[grain]."""

    @property
    def nozzle(self) -> NozzleSection | None:
        """[nozzle]."""


@dataclass(frozen=True)
class Export:
    """A motor, its curve, comments for people, and radii [m] of throat and exit (0: not known).

    ``static``: the curve as on a stand, and what is to be said of it.
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


@dataclass(frozen=True)
class Course:
    """What a motor does: its curve along the flight, with where that is from; the same on the stand; the loaded
    propellant [kg]. ``uncentered``: why the curve has no center of gravity."""

    points: Points
    comments: tuple[str, ...]
    static: tuple[Points, tuple[str, ...]]
    loaded: float
    uncentered: str = ""


def export(name: str, course: Course, stated: Stated, vehicle: Vehicle, stable: StabilityRuns | str) -> Export:
    """The motor of that ``name``; what is known of sizes and weights is added to what its course says of itself."""
    points, (static, about) = course.points, course.static
    assert points.mass is not None
    motor = _motor(name, stated, vehicle, float(points.mass[0]), course.loaded, stable)
    said = (*course.comments, *_of_size(stated), *_of_weight(stated, course.uncentered, stable), designation(points))
    return Export(motor, points, said, _radii(stated.nozzle), (static, (*about, designation(static))))


def standing(name: str, stated: Stated, points: Points, about: tuple[str, ...], loaded: float) -> str:
    """A motor without a rocket as a RASP file, as large as tank and grain; ``loaded`` [kg] of propellant."""
    motor = Motor(name, *_size(stated, None), loaded, loaded)
    return rasp.of_points(motor, points, (*about, *_of_size(stated), designation(points)))


def rocketpy(
    launch: Launch,
    outside: Shape | str,
    canopies: tuple[Parachute, Parachute] | str,
    stable: StabilityRuns | str,
    motor: Export,
) -> str:
    """The flight as a script for RocketPy; without a geometry the rocket has no surfaces and flies in still air."""
    weighed = None if isinstance(stable, str) else stable
    known = outside if isinstance(outside, Shape) else None
    vehicle = launch.vehicle
    length = known.length if known is not None else SLENDER * 2.0 * float(np.sqrt(vehicle.frontal_area / np.pi))
    engine = weighed.place.dry if weighed is not None else None
    return script(
        Scripted(
            vehicle=vehicle,
            motor=motor.motor,
            points=motor.points,
            shape=known,
            canopies=None if isinstance(canopies, str) else canopies,
            rail_length=launch.rail_length,
            empty_mass=float(engine.mass) if engine is not None else 0.0,
            pitch_inertia=vehicle.dry_mass * length**2 / 12.0,
            center_of_mass=length - (float(weighed.place.fixed[0].center) if weighed is not None else 0.5 * length),
            nozzle_radius=motor.radii[1],
        ),
        motor.comments[0],
    )


def _motor(
    name: str, stated: Stated, vehicle: Vehicle, burnt: float, loaded: float, stable: StabilityRuns | str
) -> Motor:
    geometry = stated.rocket.geometry if stated.rocket is not None else None
    engine = geometry.engine_mass.value if geometry is not None and geometry.engine_mass is not None else 0.0
    diameter, length = _size(stated, vehicle)
    if not isinstance(stable, str) and not _casing(stated.rocket)[1]:
        length = stable.place.where.length
    return Motor(name, diameter, length, burnt, engine + loaded)


def _casing(rocket: Rocket | None) -> tuple[float, float]:
    """Diameter and length [m] as stated (0: not)."""
    stated = (rocket.casing_diameter, rocket.casing_length) if rocket is not None else (None, None)
    return stated[0].value if stated[0] else 0.0, stated[1].value if stated[1] else 0.0


def _size(stated: Stated, vehicle: Vehicle | None) -> tuple[float, float]:
    """Diameter and length [m] of the motor: the casing's as stated, else of tank and grain; else as wide as the rocket.

    A length that is not known is the diameter's, since no file can do without one.
    """
    grain, tank = stated.grain, stated.tank
    widths = [2.0 * grain.outer_radius.value] if grain is not None and grain.outer_radius is not None else []
    widths += [tank.inner_diameter.value] if tank is not None and tank.inner_diameter is not None else []
    width = max(widths, default=0.0 if vehicle is None else 2.0 * float(np.sqrt(vehicle.frontal_area / np.pi)))
    length = grain.length.value if grain is not None and grain.length is not None else width
    casing = _casing(stated.rocket)
    return casing[0] or width, casing[1] or length


def _radii(nozzle: NozzleSection | None) -> tuple[float, float]:
    throat, leave = (None, None) if nozzle is None else (nozzle.throat_radius, nozzle.exit_radius)
    return (throat.value if throat else 0.0), (leave.value if leave else 0.0)


def _of_size(stated: Stated) -> Iterator[str]:
    geometry = stated.rocket.geometry if stated.rocket is not None else None
    if geometry is None or geometry.engine_mass is None:
        yield BY_THEMSELVES
    if not _casing(stated.rocket)[1]:
        yield OF_GRAIN if stated.grain is not None and stated.grain.length is not None else NO_LENGTH


def _of_weight(stated: Stated, uncentered: str, stable: StabilityRuns | str) -> Iterator[str]:
    """Where the center of gravity is from, and what is not known of it."""
    if uncentered:
        yield f"center of gravity: not in this file: {uncentered}"
    elif isinstance(stable, str) or stable.place.dry is None:
        yield "center of gravity: of tank and grain with what they hold; the empty engine is not weighed apart"
    if stated.rocket is None or stated.rocket.geometry is None:
        yield "no [rocket.geometry] is given: sizes are those of the casing, or of tank and grain"


def designation(points: Points) -> str:
    """Burn time and average thrust as a motor's designation has them (NFPA 1125)."""
    time, thrust = points.by_share(OUT)
    letter = motor_class(points.impulse).split()[0]
    return (
        f"burn_time_5_percent {time:.3f} s, average_thrust_5_percent {thrust:.1f} N: from the first to the last "
        f"{100.0 * OUT:.0f} % of the peak (NFPA 1125), {letter}{thrust:.0f}; "
        f"the curve goes on to {points.time[-1]:.2f} s"
    )
