"""[rocket] of test.toml or an engine file, turned into what flies."""

from __future__ import annotations

from math import pi
from pathlib import Path

from hfanalysis.assembly import shape
from hfanalysis.record.drag_table import read_drag_table
from hfanalysis.record.rocket import Rocket
from hfanalysis.rocket.aerodynamics import Shape, drag_table
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle


def vehicle(rocket: Rocket | None, folder: Path, launch_altitude: float) -> Vehicle | str:
    """The rocket, its drag table read from ``folder``, or why it cannot fly; ``launch_altitude`` above sea level
    [m]."""
    if rocket is None:
        return "no [rocket] is given"
    area = frontal_area(rocket)
    outside = shape.shape(rocket)
    built = outside if isinstance(outside, Shape) else None
    missing = {
        "drag_coefficient (or drag_table, or geometry)": rocket.drag_coefficient or rocket.drag_table or built,
        "frontal_area (or diameter)": area,
        "launch_angle": rocket.launch_angle,
    }
    for key, found in missing.items():
        if found is None:
            return f"rocket.{key} is not given"
    assert area is not None
    assert rocket.launch_angle is not None
    site = (area, rocket.launch_angle.value, launch_altitude)
    if rocket.drag_coefficient is not None:
        return Vehicle(rocket.dry_mass.value, rocket.drag_coefficient.value, *site)
    if rocket.drag_table is not None:
        table = read_drag_table(folder / rocket.drag_table)
        return Vehicle(rocket.dry_mass.value, table.coefficient[0], *site, table.mach, table.coefficient)
    assert isinstance(outside, Shape)
    mach, coefficient = drag_table(outside, launch_altitude)
    return Vehicle(rocket.dry_mass.value, coefficient[0], *site, mach, coefficient)


def drag_from(rocket: Rocket) -> str:
    """Where the drag comes from, in words."""
    if rocket.drag_coefficient is not None:
        return "one coefficient, as stated"
    return f"against Mach number, {rocket.drag_table}" if rocket.drag_table else "built up from the geometry"


def frontal_area(rocket: Rocket) -> float | None:
    """What the drag coefficient counts on [m^2]: stated, or the diameter's circle."""
    if rocket.diameter is not None:
        return 0.25 * pi * rocket.diameter.value**2
    return rocket.frontal_area.value if rocket.frontal_area else None


def parachutes(rocket: Rocket | None) -> tuple[Parachute, Parachute] | str:
    """Drogue and main, or why there is no descent under them."""
    if rocket is None or rocket.drogue is None or rocket.main is None:
        return "[rocket.drogue] and [rocket.main] are not both given"
    if rocket.main.deploy_altitude is None:
        return "rocket.main.deploy_altitude is not given"
    drogue = Parachute(rocket.drogue.drag_coefficient.value, rocket.drogue.area.value)
    main = Parachute(rocket.main.drag_coefficient.value, rocket.main.area.value, rocket.main.deploy_altitude.value)
    return drogue, main
