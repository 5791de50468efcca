"""What ``hfa design`` finds: the steady-state design of an engine file, its optimum mixture and its apogee."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hfanalysis.assembly import engine as build
from hfanalysis.engine.grain import Grain
from hfanalysis.errors import InputError
from hfanalysis.flight import constant_thrust
from hfanalysis.flight.summary import FlightSpread
from hfanalysis.products.engines import Designed, Optimum, Spread
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.simulation import heading, sized, spread, warned
from hfanalysis.steady_design import steady
from hfanalysis.steady_design.steady import Requirement, SteadyEngine
from hfanalysis.thermo.combustion import restart

COMMAND = "hfa design"

ASKED = ("fuel_mass", "thrust", "specific_impulse")
"""Numbers of which it is told whose spread costs most."""

UNITS = {
    "burn_time": "s",
    "oxidizer_mass": "kg",
    "fuel_mass": "kg",
    "of_ratio": "",
    "chamber_temperature": "K",
    "thrust": "N",
    "throat_radius": "m",
    "exit_radius": "m",
    "total_impulse": "N s",
    "specific_impulse": "s",
}
"""The fields of a steady engine that the product states."""


@dataclass(frozen=True)
class Task:
    """What a design is made from; ``target`` is the apogee above the site [m] where the fuel is to be solved for it."""

    requirement: Requirement
    grain: Grain
    vehicle: Vehicle | str
    target: float | None
    fuel_mass: float | None


@dataclass(frozen=True)
class DesignRun:
    """The task, the engine that answers it, and the JSON product."""

    task: Task
    engine: SteadyEngine
    product: Designed


def design(file: EngineFile, draws: int = 0) -> DesignRun:
    """The steady-state design of an engine file.

    ``draws``: designs solved anew over what the file states with a +/-, for bands about the numbers.

    Raises :class:`InputError` where the file lacks what the model needs, or no engine meets what it asks for.
    """
    restart()
    needs = Needs(file, COMMAND)
    task = task_of(needs)
    try:
        engine = solve(task)
        best = steady.optimum(task.requirement)
        port = task.grain.port_radius(engine.fuel_mass)
        heard = warned.of_design(needs, task.requirement, port, engine, best)
    except (ValueError, ArithmeticError) as error:
        raise InputError(f"{file.where('design')}: {error}") from None
    found = _numbers(needs, task, engine)
    known = _bands(file, draws) if draws and spread.is_loose(file) else None
    product = Designed.from_json(
        {
            **heading.heading(file, COMMAND, build.oxidizer_enthalpy(needs)),
            "fuel_mass_from": "grain.mass" if task.target is None else "design.target_apogee",
            **(found if known is None else spread.about(found, known[0])),
            "optimum": Optimum(of_ratio=Quantity(best.of_ratio), specific_impulse=Quantity(best.specific_impulse, "s")),
            **({} if known is None else {"spread": known[1]}),
            "beyond": heard,
            "warnings": file.warnings,
            "provenance": heading.provenance(file),
        }
    )
    return DesignRun(task, engine, product)


def _numbers(needs: Needs, task: Task, engine: SteadyEngine) -> dict[str, Quantity]:
    return {
        **{name: Quantity(float(getattr(engine, name)), unit) for name, unit in UNITS.items()},
        "port_radius": Quantity(task.grain.port_radius(engine.fuel_mass), "m"),
        "grain_length": Quantity(task.grain.length, "m"),
        **sized.injector(needs, task.requirement),
        **sized.tank(needs, engine.oxidizer_mass),
        **_flown(needs.file, task, engine),
    }


def _bands(file: EngineFile, count: int) -> tuple[Mapping[str, FlightSpread | str], Spread]:
    """Deviations and intervals of the design's numbers by name, and what they are made of."""
    found, rows, there = spread.draw(file, count, spread.SEED), [], []
    for i, one in enumerate(found.files):
        needs = Needs(one.file, COMMAND)
        try:
            task = task_of(needs)
            row = spread.plain(_numbers(needs, task, solve(task)))
        except (InputError, ValueError, ArithmeticError):
            continue
        rows.append(row)
        there.append(i)
    columns = spread.table(rows, there, count)
    made_of = spread.budgets(columns, ASKED, found)
    refused = count - len(rows)
    about = Spread(draws=count, refused=refused, seed=spread.SEED, inputs=found.stated, budget=made_of)
    return spread.spreads(columns), about


def task_of(needs: Needs) -> Task:
    """What the engine file asks for: the fuel for its target apogee, or else the fuel it states."""
    file = needs.file
    vehicle, target = build.vehicle(file), file.design.target_apogee
    if target is not None and not isinstance(vehicle, Vehicle):
        raise InputError(f"{file.where('design', 'target_apogee')}: {vehicle}; {COMMAND} needs it for an apogee")
    return Task(
        requirement=build.requirement(needs),
        grain=build.steady_grain(needs),
        vehicle=vehicle,
        target=target.value if target else None,
        fuel_mass=None if target else build.fuel_mass(needs),
    )


def solve(task: Task) -> SteadyEngine:
    """The engine for a task. Raises ValueError where there is none, with the reason."""
    mass = task.fuel_mass
    if mass is None:
        assert isinstance(task.vehicle, Vehicle)
        assert task.target is not None
        mass = steady.fuel_for_apogee(task.requirement, task.grain, task.vehicle, task.target)
    return steady.design(task.requirement, task.grain, mass)


def _flown(file: EngineFile, task: Task, engine: SteadyEngine) -> dict[str, Quantity]:
    """Thrust to weight, wet mass and apogee of the rocket on this engine."""
    vehicle = task.vehicle
    if not isinstance(vehicle, Vehicle):
        return {name: Quantity.absent(vehicle) for name in ("wet_mass", "pad_thrust_to_weight", "apogee")}
    return {
        "wet_mass": Quantity(vehicle.dry_mass + engine.oxidizer_mass + engine.fuel_mass, "kg"),
        "pad_thrust_to_weight": Quantity(engine.thrust_to_weight(vehicle)),
        "apogee": _apogee(vehicle, engine),
    }


def _apogee(vehicle: Vehicle, engine: SteadyEngine) -> Quantity:
    try:
        height = constant_thrust.apogee(vehicle, engine.thrust, engine.propellant_flow, engine.burn_time)
    except ValueError as error:
        return Quantity.absent(str(error))
    return Quantity(height, "m") if height > 0.0 else Quantity.absent("the rocket does not leave its pad")
