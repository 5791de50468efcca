"""The motor that a simulated engine is to flight simulators: along its flight, and on a stand at its site."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.assembly import engine as build
from hfanalysis.assembly.shape import places, shape
from hfanalysis.engine import unsteady
from hfanalysis.engine.unsteady import Engine
from hfanalysis.flight import engine_files
from hfanalysis.flight.engine_files import Course, Export
from hfanalysis.flight.histories import Flown
from hfanalysis.flight.motor import Points, points_of
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.rocket.balance import engine_center
from hfanalysis.simulation import flown
from hfanalysis.simulation.unsteady_run import Simulation


def export(simulated: Simulation, found: Flown) -> Export:
    """The engine along its flight: thrust at the altitudes flown through, propellant that burns."""
    file, launch = simulated.file, found.launch
    time, mass = launch.curve.time, np.maximum(launch.curve.mass - launch.curve.mass_after, 0.0)
    held = flown.held(simulated.engine, simulated.burnt, time)
    where = places(file.rocket, flown.of_size(file.tank, simulated.tank), file.grain, file.chamber)
    if not isinstance(found.stable, str):
        center, reason = found.stable.engine_center, ""
    elif isinstance(where, str):
        center, reason = None, where
    else:
        center, reason = engine_center(held, where, None), ""
    site = simulated.engine.vehicle.launch_altitude if simulated.engine.vehicle is not None else 0.0
    said = f"thrust of the simulated engine along its flight from {site:.0f} m"
    course = Course(
        points_of(time, launch.curve.thrust, mass, center),
        (_origin(file), said, _left(simulated)),
        standing(file, simulated.engine),
        simulated.engine.oxidizer_mass + simulated.engine.fuel_mass,
        reason,
    )
    return engine_files.export(file.engine.id, course, file, launch.vehicle, found.stable)


def rocketpy(simulated: Simulation, found: Flown, motor: Export) -> str:
    """The flight as a script for RocketPy."""
    return engine_files.rocketpy(found.launch, shape(simulated.file.rocket), found.canopies, found.stable, motor)


def standing(file: EngineFile, engine: Engine) -> tuple[Points, tuple[str, ...]]:
    """The engine's thrust on a stand at its site, and what is to be said of it."""
    ambient = build.ambient_pressure(file)
    burnt = unsteady.burn(replace(engine, vehicle=None, ambient_pressure=ambient))
    points = points_of(burnt.time, burnt.output("thrust"))
    return points, (_origin(file), f"thrust as on a stand, at an ambient pressure of {ambient / 1e5:.4f} bar")


def alone(simulated: Simulation, points: Points, said: tuple[str, ...]) -> str:
    """An engine without a rocket as a RASP file."""
    engine = simulated.engine
    return engine_files.standing(
        simulated.file.engine.id, simulated.file, points, said, engine.oxidizer_mass + engine.fuel_mass
    )


def _origin(file: EngineFile) -> str:
    return f"{file.engine.id}: SIMULATED by hfa simulate, not measured"


def _left(simulated: Simulation) -> str:
    left = float(simulated.burnt.state("tank_mass")[-1])
    return f"propellant: all that is loaded; {left:.3f} kg of oxidizer are left in the tank after the burn"
