"""What ``--out`` writes: the JSON product, histories or the parametric study as tables, plots, and an engine file."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.flight import rasp
from hfanalysis.flight.histories import Flown, write
from hfanalysis.flight.stability import SLOW
from hfanalysis.products.disk import atomic, write_json
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.rocket.aerodynamics import center_of_pressure, components
from hfanalysis.simulation import motor, plots, study
from hfanalysis.simulation.flown import held
from hfanalysis.simulation.steady_run import DesignRun
from hfanalysis.simulation.study import FlowPoint, MixturePoint
from hfanalysis.simulation.unsteady_run import Simulation
from hfanalysis.steady_design.steady import SteadyEngine

STATES = {
    "tank_mass": "kg",
    "tank_temperature": "K",
    "port_radius": "m",
    "altitude": "m",
    "speed": "m/s",
    "impulse": "N s",
}
OUTPUTS = {
    "tank_pressure": "Pa",
    "run_pressure": "Pa",
    "chamber_pressure": "Pa",
    "ambient_pressure": "Pa",
    "thrust": "N",
    "oxidizer_flow": "kg/s",
    "fuel_flow": "kg/s",
    "nozzle_flow": "kg/s",
    "of_ratio": "1",
    "acceleration": "m/s^2",
}
"""Histories of a simulation, with units."""

OVER_TEMPERATURE = {
    "total_impulse": "N s", "peak_thrust": "N", "peak_chamber_pressure": "Pa", "burn_time": "s", "apogee": "m",
}  # fmt: skip
"""Columns over the temperature of the tank, with units."""

OF_ASCENT = {
    "time": "s", "height": "m", "altitude": "m", "speed": "m/s", "acceleration": "m/s^2", "thrust": "N", "drag": "N",
    "mass": "kg", "mach": "1",
}  # fmt: skip
"""Columns of the flight's table, with units; on the way down there are only the first four."""


def simulation(out: Path, simulation: Simulation) -> None:
    """simulate.json, histories.csv (on the solver's steps), plots and engine files; of a rocket also its flight, as
    flight.csv and flight.h5, and a script for RocketPy."""
    write_json(out / "simulate.json", simulation.product)
    table = histories(simulation)
    write_table(out / "histories.csv", list(table), np.column_stack(list(table.values())).tolist())
    for name, text in plots.simulation(table):
        write_text(out / name, text)
    days = simulation.on_other_days
    ends = {
        f"{key}_{end}": of for key, both in days.bands.items() for end, of in zip(("low", "high"), both, strict=True)
    }
    units = {key: OVER_TEMPERATURE[key.removesuffix("_low").removesuffix("_high")] for key in [*days.numbers, *ends]}
    columns = ["temperature [degC]", *(f"{key} [{unit}]" for key, unit in units.items())]
    found = [days.temperature, *days.numbers.values(), *ends.values()]
    write_table(out / "temperature.csv", columns, np.column_stack(found).tolist())
    name, flown = file_name(simulation.file), simulation.flown
    if isinstance(flown, str):
        points, said = motor.standing(simulation.file, simulation.engine)
        write_text(out / f"{name}_static.eng", motor.alone(simulation, points, said))
        return
    _flight(out, name, simulation, flown)


def _flight(out: Path, name: str, simulation: Simulation, found: Flown) -> None:
    made = motor.export(simulation, found)
    for end, text in (
        (".eng", made.eng),
        ("_static.eng", made.static_eng),
        (".rse", made.rse),
        ("_rocketpy.py", motor.rocketpy(simulation, found, made)),
    ):
        write_text(out / f"{name}{end}", text)
    with atomic(out / "flight.h5") as scratch:
        title = f"flight of {name}, simulated"
        write(scratch, title, simulation.product.provenance, found, left(simulation, found))
    for title, text in plots.flight(found):
        write_text(out / title, text)
    columns = ["part", *(f"{key} [{unit}]" for key, unit in OF_ASCENT.items())]
    write_table(out / "flight.csv", columns, _flight_rows(found))


def left(simulation: Simulation, found: Flown) -> dict[str, Array]:
    """Oxidizer and fuel left [kg] on the times of the ascent, (n,) each."""
    load = held(simulation.engine, simulation.burnt, found.ascent.column("time"))
    return {"oxidizer_mass": load.oxidizer, "fuel_mass": load.fuel}


def _flight_rows(found: Flown) -> Iterator[list[object]]:
    """Up, down under the parachutes, and, last, down without them."""
    up = {**{key: found.ascent.column(key) for key in OF_ASCENT if key != "height"}, "height": found.height}
    yield from (["ascent", *row] for row in np.column_stack([up[key] for key in OF_ASCENT]).tolist())
    ground = found.launch.vehicle.launch_altitude
    for part, leg in sorted(found.legs().items(), key=lambda item: item[0] == "ballistic"):
        rows = np.column_stack([leg.time, leg.altitude - ground, leg.altitude, leg.speed]).tolist()
        yield from ([part, *row, *[""] * (len(OF_ASCENT) - 4)] for row in rows)


def histories(simulation: Simulation) -> dict[str, Array]:
    """Columns of the histories, (n,) each, named with their units ("time [s]")."""
    burnt, engine = simulation.burnt, simulation.engine
    radius, flow = burnt.state("port_radius"), burnt.output("oxidizer_flow")
    load = held(engine, burnt, burnt.time)
    wall = 2.0 * np.pi * radius * engine.grain_length * engine.fuel_density
    table = {
        "time [s]": burnt.time,
        **{f"{name} [{unit}]": burnt.state(name) for name, unit in STATES.items()},
        **{f"{name} [{unit}]": burnt.output(name) for name, unit in OUTPUTS.items()},
        "liquid_mass [kg]": load.liquid,
        "fuel_mass [kg]": load.fuel,
        "chamber_temperature [K]": simulation.chamber_temperature,
        "regression_rate [m/s]": burnt.output("fuel_flow") / wall,
        "oxidizer_flux [kg/m^2/s]": oxidizer_flux(flow, radius),
    }
    return table | _balance(simulation)


def _balance(simulation: Simulation) -> dict[str, Array]:
    """Center of gravity, pitch inertia and margin of a rocket whose geometry is stated."""
    found = simulation.flown
    if isinstance(found, str) or isinstance(found.stable, str):
        return {}
    burnt, stable, clock = simulation.burnt, found.stable, found.launch.curve.time
    still = center_of_pressure(components(stable.outside, SLOW))[1]
    center, inertia = (np.interp(burnt.time, clock, of) for of in (stable.balance.center, stable.balance.inertia))
    return {
        "center_of_gravity [m]": center,
        "pitch_inertia [kg m^2]": inertia,
        "engine_center_of_gravity [m]": np.interp(burnt.time, clock, stable.engine_center),
        "static_margin [calibers]": (still - center) / stable.outside.diameter,
    }


def file_name(file: EngineFile) -> str:
    """The engine's name as one of files."""
    return re.sub(r"[^\w.-]+", "-", file.engine.id).strip(".-") or "engine"


def design(out: Path, file: EngineFile, designed: DesignRun, ranges: study.Ranges = study.USUAL) -> None:
    """design.json, the study's two tables and their plots, and ID.eng of the constant thrust."""
    write_json(out / "design.json", designed.product)
    flows = study.over_flow_and_length(designed.task, ranges)
    mixtures = list(study.over_mixture(designed.task.requirement, ranges))
    write_table(out / "study_flow_length.csv", FLOW_COLUMNS, map(_flow_row, flows))
    write_table(out / "study_mixture.csv", MIXTURE_COLUMNS, map(_mixture_row, mixtures))
    for name, text in plots.study(flows, mixtures):
        write_text(out / name, text)
    write_text(out / f"{file_name(file)}.eng", engine_file(file, designed))


FLOW_COLUMNS = [
    "oxidizer_flow [kg/s]",
    "grain_length [m]",
    "ideal_fuel_mass [kg]",
    "ideal_specific_impulse [s]",
    "ideal_exit_radius [m]",
    "ideal_thrust [N]",
    "fuel_mass [kg]",
    "specific_impulse [s]",
    "exit_radius [m]",
    "thrust [N]",
    "reason",
]
"""``ideal``: expanded to ambient; the others with the exit radius of the file. Empty where there is no such engine."""

MIXTURE_COLUMNS = ["chamber_pressure [Pa]", "of_ratio [1]", "specific_impulse [s]", "specific_impulse_propep [s]"]


def _flow_row(point: FlowPoint) -> list[object]:
    return [point.oxidizer_flow, point.grain_length, *_cells(point.ideal), *_cells(point.fixed), point.reason]


def _cells(engine: SteadyEngine | None) -> list[object]:
    if engine is None:
        return [""] * 4
    return [engine.fuel_mass, engine.specific_impulse, engine.exit_radius, engine.thrust]


def _mixture_row(point: MixturePoint) -> list[object]:
    return [point.chamber_pressure, point.of_ratio, point.specific_impulse, point.specific_impulse_propep]


def engine_file(file: EngineFile, designed: DesignRun) -> str:
    """The constant thrust as a RASP engine file; the rocket's dry mass holds the empty engine."""
    engine, grain = designed.engine, designed.task.grain
    propellant = engine.oxidizer_mass + engine.fuel_mass
    tank = file.tank.inner_diameter
    motor = rasp.Motor(
        name=file.engine.id,
        diameter=max(2.0 * grain.outer_radius, tank.value if tank else 0.0),
        length=grain.length,
        propellant_mass=propellant,
        total_mass=propellant,
    )
    comments = (
        f"constant thrust of the steady-state design, {engine.total_impulse:.0f} N s",
        "length: the grain's; total mass: propellant alone, the empty engine belongs to the rocket's dry mass",
    )
    return rasp.text(motor, rasp.constant_thrust(engine.thrust, engine.burn_time), comments)


def write_table(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """A CSV table, whole or not at all."""
    with atomic(path) as scratch, scratch.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)


def write_text(path: Path, text: str) -> None:
    """A text, whole or not at all."""
    with atomic(path) as scratch:
        scratch.write_text(text, encoding="utf-8")
