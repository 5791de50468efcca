"""A script that flies a rocket and its motor in RocketPy, complete in itself."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from pprint import pformat

import numpy as np

from hfanalysis.flight.motor import Motor, Points
from hfanalysis.rocket.aerodynamics import Shape
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle

NOSES = {"cone": "conical", "ogive": "ogive", "von_karman": "von karman", "ellipsoid": "elliptical"}
"""What RocketPy calls them."""

RAIL_UNKNOWN = 5.0
"""Length of a rail that is not stated [m]. Evidence: RocketPy cannot do without one."""

HEAD = '''"""A rocket on its motor. Written by hfanalysis. Needs RocketPy (pip install rocketpy).

Usage: python THIS_FILE [--inclination DEGREES]
"""

import argparse
from functools import cached_property

from rocketpy import Environment, Flight, Function, GenericMotor, Rocket

TITLE = {title!r}
'''

BODY = '''

class GivenMotor(GenericMotor):
    """Its propellant leaves as it is given, not in proportion to the thrust."""

    @cached_property
    def propellant_mass(self):
        return Function(PROPELLANT, "Time (s)", "Propellant (kg)", "linear", "constant")

    @cached_property
    def total_mass_flow_rate(self):
        """Negative; mean between the points."""
        pairs = zip(PROPELLANT, PROPELLANT[1:])
        points = [(0.5 * (t0 + t1), (m1 - m0) / (t1 - t0)) for (t0, m0), (t1, m1) in pairs]
        return Function(points, "Time (s)", "Mass flow (kg/s)", "linear", "zero")


def build():
    """The rocket on its motor; positions count from the nozzle's end upwards."""
    motor = GivenMotor(
        thrust_source=THRUST,
        burn_time=THRUST[-1][0],
        chamber_radius=MOTOR_RADIUS,
        chamber_height=MOTOR_LENGTH,
        chamber_position=0.5 * MOTOR_LENGTH,
        propellant_initial_mass=PROPELLANT[0][1],
        nozzle_radius=NOZZLE_RADIUS,
        dry_mass=EMPTY_MASS,
        dry_inertia=(0.0, 0.0, 0.0),
        center_of_dry_mass_position=0.5 * MOTOR_LENGTH,
    )
    rocket = Rocket(
        radius=RADIUS,
        mass=DRY_MASS - EMPTY_MASS,
        inertia=(PITCH_INERTIA, PITCH_INERTIA, ROLL_INERTIA),
        power_off_drag=DRAG,
        power_on_drag=DRAG,
        center_of_mass_without_motor=CENTER_OF_MASS,
        coordinate_system_orientation="tail_to_nose",
    )
    rocket.add_motor(motor, position=0.0)
    if SHAPE:
        rocket.add_nose(**SHAPE["nose"])
        if "fins" in SHAPE:
            rocket.add_trapezoidal_fins(**SHAPE["fins"])
        if "tail" in SHAPE:
            rocket.add_tail(**SHAPE["tail"])
    for canopy in PARACHUTES:
        rocket.add_parachute(**canopy)
    return rocket


def fly(inclination=INCLINATION, terminate_on_apogee=True):
    """The flight from the launch site without wind; `inclination` is the rail's over the horizon [deg]."""
    environment = Environment(elevation=ELEVATION)
    environment.set_atmospheric_model(type="standard_atmosphere")
    return Flight(
        rocket=build(),
        environment=environment,
        rail_length=RAIL_LENGTH,
        inclination=inclination,
        heading=0.0,
        terminate_on_apogee=terminate_on_apogee,
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=TITLE)
    parser.add_argument("--inclination", type=float, default=INCLINATION, help="of the rail over the horizon [deg]")
    flight = fly(parser.parse_args().inclination)
    print(f"apogee above ground {flight.apogee - ELEVATION:.1f} m at {flight.apogee_time:.2f} s")
    print(f"rail departure {flight.out_of_rail_velocity:.2f} m/s, peak speed {flight.max_speed:.1f} m/s")
'''


@dataclass(frozen=True)
class Scripted:
    """What a script states: the rocket, motor and curve (with its masses), shape, canopies, rail [m].

    Empty engine [kg], pitch inertia [kg m^2], center of mass over the tail [m], radius of the nozzle's exit [m].
    """

    vehicle: Vehicle
    motor: Motor
    points: Points
    shape: Shape | None
    canopies: tuple[Parachute, Parachute] | None
    rail_length: float | None
    empty_mass: float
    pitch_inertia: float
    center_of_mass: float
    nozzle_radius: float


def script(of: Scripted, title: str) -> str:
    """The script's text. Raises ValueError for a curve without a mass history.

    Whatever it states is written as a literal: a title is text there, not code.
    """
    if of.points.mass is None:
        raise ValueError("a flight needs the propellant's mass over time")
    statements = {
        "ELEVATION": of.vehicle.launch_altitude,
        "INCLINATION": round(90.0 - degrees(of.vehicle.launch_angle), 6),
        "RAIL_LENGTH": of.rail_length if of.rail_length is not None else RAIL_UNKNOWN,
        "RADIUS": float(np.sqrt(of.vehicle.frontal_area / np.pi)),
        "DRY_MASS": of.vehicle.dry_mass,
        "EMPTY_MASS": of.empty_mass,
        "PITCH_INERTIA": of.pitch_inertia,
        "ROLL_INERTIA": 0.5 * of.vehicle.dry_mass * of.vehicle.frontal_area / np.pi,
        "CENTER_OF_MASS": of.center_of_mass,
        "MOTOR_RADIUS": max(0.5 * of.motor.diameter, 1e-3),
        "MOTOR_LENGTH": max(of.motor.length, 1e-3),
        "NOZZLE_RADIUS": max(of.nozzle_radius, 1e-3),
        "DRAG": _drag(of.vehicle),
        "SHAPE": _shape(of.shape) if of.shape is not None else {},
        "PARACHUTES": _canopies(of.canopies),
        "THRUST": _pairs(of.points.time, of.points.thrust, 4),
        "PROPELLANT": _pairs(of.points.time, of.points.mass, 6),
    }
    stated = "\n".join(f"{key} = {_literal(value)}" for key, value in statements.items())
    return HEAD.format(title=title) + stated + "\n" + BODY


def _literal(value: object) -> str:
    return pformat(float(value) if isinstance(value, float) else value, width=110, sort_dicts=False)


def _pairs(time: np.ndarray, values: np.ndarray, digits: int) -> list[tuple[float, float]]:
    return [(round(float(t), 6), round(float(v), digits)) for t, v in zip(time, values, strict=True)]


def _drag(vehicle: Vehicle) -> object:
    if vehicle.drag_mach is None or vehicle.drag_values is None:
        return vehicle.drag_coefficient
    return [(float(m), float(c)) for m, c in zip(vehicle.drag_mach, vehicle.drag_values, strict=True)]


def _shape(shape: Shape) -> dict[str, dict[str, object]]:
    """Positions over the tail, as RocketPy has them."""
    end = shape.length
    found: dict[str, dict[str, object]] = {
        "nose": {"length": shape.nose.length, "kind": NOSES[shape.nose.kind], "position": end}
    }
    if shape.fins is not None:
        fins = shape.fins
        found["fins"] = {
            "n": fins.count, "root_chord": fins.root, "tip_chord": fins.tip, "span": fins.span,
            "sweep_length": fins.sweep, "position": end - fins.position,
        }  # fmt: skip
    if shape.tail is not None:
        tail = shape.tail
        found["tail"] = {
            "top_radius": 0.5 * shape.diameter, "bottom_radius": 0.5 * tail.diameter, "length": tail.length,
            "position": end - tail.position,
        }  # fmt: skip
    return found


def _canopies(canopies: tuple[Parachute, Parachute] | None) -> list[dict[str, object]]:
    if canopies is None:
        return []
    triggers = ("apogee", canopies[1].deploy_altitude or "apogee")
    return [
        {"name": name, "cd_s": canopy.drag_coefficient * canopy.area, "trigger": trigger}
        for name, canopy, trigger in zip(("drogue", "main"), canopies, triggers, strict=True)
    ]
