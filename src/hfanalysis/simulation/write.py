"""What ``--out`` writes: the JSON product, histories or the parametric study as tables, plots, and an engine file."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.flight import rasp
from hfanalysis.products.disk import atomic, write_json
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.simulation import plots, study
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
    "chamber_pressure": "Pa",
    "thrust": "N",
    "oxidizer_flow": "kg/s",
    "fuel_flow": "kg/s",
    "nozzle_flow": "kg/s",
    "of_ratio": "1",
    "acceleration": "m/s^2",
}
"""Histories of a simulation, with units."""


def simulation(out: Path, simulation: Simulation) -> None:
    """simulate.json, histories.csv (on the solver's steps) and plots."""
    write_json(out / "simulate.json", simulation.product)
    table = histories(simulation)
    write_table(out / "histories.csv", list(table), np.column_stack(list(table.values())).tolist())
    for name, text in plots.simulation(table):
        write_text(out / name, text)


def histories(simulation: Simulation) -> dict[str, Array]:
    """Columns of the histories, (n,) each, named with their units ("time [s]")."""
    burnt = simulation.burnt
    return {
        "time [s]": burnt.time,
        **{f"{name} [{unit}]": burnt.state(name) for name, unit in STATES.items()},
        **{f"{name} [{unit}]": burnt.output(name) for name, unit in OUTPUTS.items()},
        "chamber_temperature [K]": simulation.chamber_temperature,
    }


def design(out: Path, file: EngineFile, designed: DesignRun, ranges: study.Ranges = study.USUAL) -> None:
    """design.json, the study's two tables and their plots, and ID.eng of the constant thrust."""
    write_json(out / "design.json", designed.product)
    flows = study.over_flow_and_length(designed.task, ranges)
    mixtures = list(study.over_mixture(designed.task.requirement, ranges))
    write_table(out / "study_flow_length.csv", FLOW_COLUMNS, map(_flow_row, flows))
    write_table(out / "study_mixture.csv", MIXTURE_COLUMNS, map(_mixture_row, mixtures))
    for name, text in plots.study(flows, mixtures):
        write_text(out / name, text)
    name = re.sub(r"[^\w.-]+", "-", file.engine.id).strip(".-") or "engine"
    write_text(out / f"{name}.eng", engine_file(file, designed))


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
