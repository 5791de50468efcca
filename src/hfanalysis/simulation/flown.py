"""The flight of a simulated engine's rocket, from its pad to the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.assembly.shape import built
from hfanalysis.assembly.tank import TankBuilt
from hfanalysis.engine.tank import liquid_of
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.flight import ascent, summary
from hfanalysis.flight.ascent import Ascent
from hfanalysis.flight.curve import Curve, even_curve
from hfanalysis.flight.histories import Flown
from hfanalysis.flight.stability import Launch, StabilityRuns, stability
from hfanalysis.flight.winds import WINDS
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.record.schema import changed
from hfanalysis.record.sections import Tank
from hfanalysis.rocket.balance import Held
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.units import Value

LANDED = 5.0
"""[s] after the apogee that a flight in winds is followed, at most. Source: by choice: the margin is told until the
rocket is as slow again as at the rail's end."""


def curve_of(engine: Engine, burnt: Burn) -> Curve:
    """Thrust [N] at the altitudes of the burn, and the rocket's mass [kg]; it coasts with its dry mass, as the report
    does."""
    vehicle = flying(engine)
    later = _later(burnt)
    time, impulse = burnt.time[later], burnt.state("impulse")[later]
    return even_curve(time, impulse, mass(engine, burnt)[later], vehicle.dry_mass)


def _later(burnt: Burn) -> NDArray[np.intp]:
    """Indices of the burn's times, each instant once."""
    return np.flatnonzero(np.diff(burnt.time, prepend=-1.0) > 0.0)


def flying(engine: Engine) -> Vehicle:
    """The engine's rocket; ValueError for an engine on its stand."""
    if engine.vehicle is None:
        raise ValueError("the engine stands on its bench")
    return engine.vehicle


def mass(engine: Engine, burnt: Burn) -> Array:
    """Of the rocket over the burn [kg], (n,): dry mass, tank, grain, and the gas in the chamber (report, eq. 3.47)."""
    grain = engine.grain.fuel(burnt.state("port_radius"))
    stored = burnt.state("chamber_oxidizer") + burnt.state("chamber_fuel")
    return np.asarray(flying(engine).dry_mass + burnt.state("tank_mass") + grain + stored)


def ascend(engine: Engine, burnt: Burn, rail_length: float | None = None) -> Ascent:
    """From ignition to apogee; ``rail_length`` [m] (None: there is no rail to leave).

    Raises ValueError for a rocket that stays on its pad or leaves the atmosphere model.
    """
    return ascent.ascend(curve_of(engine, burnt), flying(engine), rail_length)


def apogee(engine: Engine, burnt: Burn, rail_length: float | None = None) -> float | None:
    """Above the launch site [m]; None where the rocket stays on its pad or leaves the atmosphere model."""
    try:
        return ascend(engine, burnt, rail_length).height
    except ValueError:
        return None


def quantities(found: Flown | str) -> dict[str, Quantity]:
    """Of the flight, each with its unit [m, s, m/s, m/s^2]; each that cannot be had says why."""
    if isinstance(found, str):
        return summary.absent(found)
    return numbers_of(found.launch, found.ascent, found.canopies)


def numbers_of(launch: Launch, up: Ascent, canopies: tuple[Parachute, Parachute] | str) -> dict[str, Quantity]:
    """Of a flight that took place."""
    return summary.quantities(launch.vehicle, up, launch.rail_length, canopies)


def launched(file: EngineFile, engine: Engine, burnt: Burn) -> tuple[Launch, Ascent] | str:
    """The file's rocket on its way up, or why it cannot fly."""
    vehicle = build.vehicle(file) if engine.vehicle is None else engine.vehicle
    if not isinstance(vehicle, Vehicle):
        return vehicle
    launch = Launch(curve_of(engine, burnt), vehicle, file.rocket.guided_length if file.rocket else None)
    try:
        return launch, ascent.ascend(launch.curve, vehicle, launch.rail_length)
    except ValueError as error:
        return str(error)


def to_ground(file: EngineFile, engine: Engine, burnt: Burn, tank: TankBuilt) -> Flown | str:
    """The flight of the file's rocket, its margin in winds where its geometry is stated; or why it cannot fly."""
    found = launched(file, engine, burnt)
    if isinstance(found, str):
        return found
    launch, up = found
    return Flown(launch, up, build.parachutes(file), _in_winds(file, engine, burnt, tank, launch, up))


def _in_winds(
    file: EngineFile, engine: Engine, burnt: Burn, tank: TankBuilt, launch: Launch, up: Ascent
) -> StabilityRuns | str:
    rocket = built(file.rocket, of_size(file.tank, tank), file.grain, file.chamber)
    if isinstance(rocket, str):
        return rocket
    return stability(launch, rocket, held(engine, burnt, launch.curve.time), up.end[0] + LANDED, winds(file))


def winds(file: EngineFile) -> tuple[float, ...]:
    """Those [m/s] in which the margin is told: the report's, and the launch's own where it is stated."""
    stated = file.rocket.wind_speed if file.rocket is not None else None
    return WINDS if stated is None or stated.value <= 0.0 else tuple(sorted({*WINDS, stated.value}))


def of_size(stated: Tank, tank: TankBuilt) -> Tank:
    """The stated tank with the volume and the length that its ullage or its length came to."""
    length = stated.length if tank.size is None else Value(tank.size.length)
    return changed(stated, volume=Value(tank.volume), length=length)


def held(engine: Engine, burnt: Burn, time: Array) -> Held:
    """What tank, grain and chamber hold [kg] at times [s], (n,); nitrogen counts as vapor."""
    later = _later(burnt)

    def at(values: Array) -> Array:
        return np.asarray(np.interp(time, burnt.time[later], values[later]))

    oxidizer, temperature = at(burnt.state("tank_mass")), at(burnt.state("tank_temperature"))
    source = engine.saturation
    v_l, v_v = np.asarray(source.liquid_volume(temperature)[0]), np.asarray(source.vapor_volume(temperature)[0])
    wet = time < (np.inf if burnt.liquid_out is None else burnt.liquid_out)
    liquid = np.where(wet, np.clip(liquid_of(engine.feed.volume, oxidizer, v_l, v_v), 0.0, oxidizer), 0.0)
    gas = burnt.state("chamber_oxidizer") + burnt.state("chamber_fuel") + burnt.state("chamber_nitrogen")
    volume = np.where(wet, v_l, 0.0)
    fuel = np.maximum(at(np.asarray(engine.grain.fuel(burnt.state("port_radius")))), 0.0)
    return Held(oxidizer + at(burnt.state("tank_nitrogen")), liquid, volume, fuel, at(gas))
