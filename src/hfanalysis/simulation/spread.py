"""What +/- in an engine file, and its [covariance], make of an engine's numbers: engines drawn over them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.cautions import LEAST_RAIL_SPEED, LEAST_STIFFNESS
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.errors import InputError
from hfanalysis.flight.summary import FlightSpread
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.inference.budget import by_draws
from hfanalysis.processors import processors
from hfanalysis.products.budget import Budget
from hfanalysis.products.engines import Chance, Spread, SpreadInput
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.record.schema import Section, changed
from hfanalysis.record.sections import CovarianceSection
from hfanalysis.record.unused import LOOSE_OF_ENGINES, OF_ENGINES
from hfanalysis.simulation import flown, numbers, warned
from hfanalysis.simulation.errors import off_by
from hfanalysis.units import Value
from hfanalysis.validate.model_errors import lower_factor

T = TypeVar("T")

DRAWS = 400
"""Engines drawn. Evidence: test_spread.py: another seed moves a standard deviation by less than a tenth."""

SEED = 1

ENOUGH = 0.9
"""Share of the draws that have to have a number for it to have a band [-]. Source: by choice, as of a prediction."""

SAME = 1e-6
"""Relative deviation [-] up to which a number is the same in all draws. Source: what a solver leaves."""

NEAR = 0.05
"""Share of the target apogee [-] within which it counts as reached. Source: by choice of what is asked for."""

TOGETHER = "constants together ([covariance])"

COVERED = {
    "oxidizer_mass": ("tank.oxidizer_mass",),
    "volume": ("tank.volume", "tank.length", "tank.ullage"),
    "fuel_mass": ("grain.mass",),
    "flow_area": ("injector.C_i", "injector.hole_area", "injector.hole_diameter"),
    "K_loss": ("feed.K_loss",),
    "m": ("tank.polytropic_exponent",),
    "n": ("grain.n",),
    "a": ("grain.a",),
    "ln_a": ("grain.a",),
    "throat_area": ("nozzle.throat_radius",),
}
"""Names of [covariance], and the keys whose own +/- they stand for."""


@dataclass(frozen=True)
class Loose:
    """A stated value with its standard deviation, and where it is in the file."""

    keys: tuple[str, ...]
    value: Value

    @property
    def name(self) -> str:
        """Dotted."""
        return ".".join(self.keys)


@dataclass(frozen=True)
class DrawnFile:
    """A file with its values off by what is stated of them, and the errors [SI] of its constants by name."""

    file: EngineFile
    together: Mapping[str, float]


def loose(file: EngineFile) -> list[Loose]:
    """What the file states with a +/- that an engine or its flight hangs on."""
    names = file.covariance.names if file.covariance is not None else ()
    covered = {key for name in names for key in COVERED.get(name, ())}
    found = [Loose(keys, value) for keys, value in _values(file, ())]
    return [one for one in found if one.name not in covered | OF_ENGINES | LOOSE_OF_ENGINES]


def _values(section: Any, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Value]]:
    for one in fields(section):
        inner = vars(section)[one.name]
        if isinstance(inner, Value) and inner.std:
            yield (*above, one.name), inner
        elif isinstance(inner, Section):
            yield from _values(inner, (*above, one.name))


def is_loose(file: EngineFile) -> bool:
    """Whether anything is stated that makes bands."""
    return bool(loose(file)) or file.covariance is not None or _loose_effects(file)


def _loose_effects(file: EngineFile) -> bool:
    return any("+/-" in str(text) for effect in file.effects.values() for text in effect.values())


@dataclass(frozen=True)
class Draws:
    """Files and their inputs' standard normal numbers (count,) or (count, k), by name."""

    files: tuple[DrawnFile, ...]
    inputs: Mapping[str, Array]
    stated: tuple[SpreadInput, ...]


def with_tank_as_built(file: EngineFile, command: str) -> EngineFile:
    """The file with its tank's volume stated, unless what sizes the tank is itself loose: another load is another fill
    of the same tank."""
    sized_by = {one.name for one in loose(file)} & {"tank.ullage", "tank.length"}
    if file.tank.volume is not None or sized_by:
        return file
    tank = flown.of_size(file.tank, build.tank(Needs(file, command)))
    return changed(file, tank=changed(tank, ullage=None, length=None))


def draw(file: EngineFile, count: int, seed: int) -> Draws:
    """So many files, each with every loose value and the constants together off by what is stated of them."""
    rng = np.random.default_rng(seed)
    found = loose(file)
    normal = rng.standard_normal((count, len(found)))
    inputs = {one.name: normal[:, i] for i, one in enumerate(found)}
    stated = [SpreadInput(name=one.name, value=one.value.value, std=float(one.value.std or 0.0)) for one in found]
    together = np.zeros((count, 0))
    names: tuple[str, ...] = ()
    if (errors := file.covariance) is not None:
        names = tuple(errors.names)
        shared = rng.standard_normal((count, len(names)))
        together = shared @ factor_of(file, errors).T
        inputs[TOGETHER] = shared
        stated += [SpreadInput(name=f"covariance.{n}", std=float(s)) for n, s in zip(names, errors.std, strict=True)]
    files = tuple(
        DrawnFile(_moved(file, found, row), dict(zip(names, off, strict=True)))
        for row, off in zip(normal.tolist(), together.tolist(), strict=True)
    )
    return Draws(files, inputs, tuple(stated))


def factor_of(file: EngineFile, errors: CovarianceSection) -> Array:
    """Lower factor (k, k) [SI] of the file's covariance; times independent standard normal numbers (k,) it gives errors
    of the constants together. Raises InputError for a constant that no engine has."""
    for name in errors.names:
        if name not in COVERED:
            where = file.where("covariance", "names")
            raise InputError(f"{where}: found {name!r}; expected some of {', '.join(COVERED)}")
    return np.asarray(lower_factor(np.array(errors.correlation)) * np.array(errors.std)[:, None])


def _moved(file: EngineFile, found: Sequence[Loose], normal: Sequence[float]) -> EngineFile:
    moved = file
    for one, off in zip(found, normal, strict=True):
        value = one.value.value + (one.value.std or 0.0) * off
        moved = _put(moved, one.keys, replace(one.value, value=value))
    return moved


def _put(section: T, keys: tuple[str, ...], value: Value) -> T:
    first, *rest = keys
    inner = value if not rest else _put(getattr(section, first), tuple(rest), value)
    return changed(section, **{first: inner})


def engine_of(drawn: DrawnFile, command: str) -> Engine | str:
    """The engine of a drawn file, or why there is none."""
    needs, off = Needs(drawn.file, command), drawn.together
    try:
        made = build.engine(needs, build.tank(needs))
    except (InputError, ValueError) as error:
        return str(error)
    return off_by(made, off, made)


@dataclass(frozen=True)
class Bands:
    """What the draws say: deviations and 95 % intervals by name, of the engine and of its flight, and the rest."""

    engine: Mapping[str, FlightSpread | str]
    flight: Mapping[str, FlightSpread | str]
    product: Spread


def bands(file: EngineFile, effects: Adopted, command: str, count: int = DRAWS, seed: int = SEED) -> Bands:
    """Draw ``count`` engines, with ``effects`` in the model, burn and fly them; ``command``: who asks."""
    found = draw(with_tank_as_built(file, command), count, seed)
    engine, flight, beside = run(found.files, effects, np.random.default_rng([seed, 1]), command)
    refused = int(np.isnan(engine[next(iter(engine))]).sum()) if engine else count
    target = file.design.target_apogee.value if file.design.target_apogee else None
    chances = _chances(flight.get("apogee"), flight.get("rail_departure_velocity"), beside.get("stiffness"), target)
    made_of = budgets(engine | flight, ASKED, found)
    product = Spread(draws=count, refused=refused, seed=seed, inputs=found.stated, chances=chances, budget=made_of)
    return Bands(spreads(engine), spreads(engine | flight), product)


def run(
    files: Sequence[DrawnFile], effects: Adopted, rng: np.random.Generator | None, command: str
) -> tuple[dict[str, Array], dict[str, Array], dict[str, Array]]:
    """Numbers [SI] by name, (n,) each, of the engines of n drawn files, of their flights, and beside them; NaN where
    there is none. ``rng`` draws the effects within what is known of their sizes; without it they are as adopted."""
    made = [engine_of(one, command) for one in files]
    there = [i for i, one in enumerate(made) if isinstance(one, Engine)]
    engines = [
        replace(one, effects=effects.acting if rng is None else effects.drawn(effects.acting, rng))
        for one in made
        if isinstance(one, Engine)
    ]
    burns = burn_many(engines)
    with ThreadPoolExecutor(processors()) as pool:
        jobs = [(files[i].file, e, b) for i, e, b in zip(there, engines, burns, strict=True)]
        rows = list(pool.map(lambda job: numbers_of(*job), jobs))
    engine, flight, beside = (table([row[k] for row in rows], there, len(files)) for k in range(3))
    return engine, flight, beside


def budgets(found: Mapping[str, Array], asked: Sequence[str], drawn: Draws) -> dict[str, Budget]:
    """What the ``asked`` of the numbers (count,) are spread by, where the draws tell."""
    of = {name: by_draws(found[name], drawn.inputs) for name in asked if name in found}
    return {name: budget for name, budget in of.items() if budget is not None}


ASKED = ("apogee", "total_impulse", "peak_chamber_pressure")
"""Numbers of which it is told whose spread costs most."""


def numbers_of(file: EngineFile, engine: Engine, burnt: Burn | str) -> tuple[dict[str, float], ...]:
    """Numbers of an engine, of its flight, and beside them, of one draw."""
    if isinstance(burnt, str):
        return {}, {}, {}
    of_engine = plain(numbers.of_burn(engine, burnt) | numbers.loaded(file, engine, burnt))
    found = flown.launched(file, engine, burnt)
    of_flight = {} if isinstance(found, str) else plain(flown.numbers_of(*found, build.parachutes(file)))
    return of_engine, of_flight, {"stiffness": warned.lowest_stiffness(burnt)}


def plain(found: Mapping[str, Quantity]) -> dict[str, float]:
    """The values of those that are there [SI]."""
    return {name: one.value for name, one in found.items() if one.value is not None}


def table(rows: Sequence[Mapping[str, float]], there: Sequence[int], count: int) -> dict[str, Array]:
    """Columns (count,), NaN where a draw has no such number."""
    found: dict[str, Array] = {}
    for i, row in zip(there, rows, strict=True):
        for name, value in row.items():
            found.setdefault(name, np.full(count, np.nan))[i] = value
    return found


def spreads(found: Mapping[str, Array]) -> dict[str, FlightSpread | str]:
    """Deviation and 95 % interval of each number, (count,) draws of it; or why there is none."""
    return {name: _spread(values) for name, values in found.items()}


def _spread(values: Array) -> FlightSpread | str:
    known = values[np.isfinite(values)]
    if known.size < max(ENOUGH * values.size, 2):
        return f"no band: {known.size} of {values.size} drawn engines have one"
    low, high = np.quantile(known, (0.025, 0.975))
    return FlightSpread(float(known.std(ddof=1)), (float(low), float(high)))


def _chances(apogee: Array | None, rail: Array | None, stiff: Array | None, target: float | None) -> tuple[Chance, ...]:
    """Shares of the draws, refused ones among those that fail."""
    found = []
    if apogee is not None and target is not None:
        near = np.abs(apogee / target - 1.0) <= NEAR
        words = f"the apogee is within {100.0 * NEAR:g} % of [design] target_apogee"
        found.append(_chance("target_reached", near, target, "m", words))
    if rail is not None:
        words = f"the rail is left at {LEAST_RAIL_SPEED:g} m/s at least"
        found.append(_chance("rail_speed", rail >= LEAST_RAIL_SPEED, LEAST_RAIL_SPEED, "m/s", words))
    if stiff is not None:
        words = f"the injector's pressure drop stays at {LEAST_STIFFNESS:g} of the chamber pressure at least"
        found.append(_chance("injector_stiffness", stiff >= LEAST_STIFFNESS, LEAST_STIFFNESS, "", words))
    return tuple(found)


def _chance(name: str, held: Any, limit: float, unit: str, words: str) -> Chance:
    return Chance(name=name, probability=float(np.mean(held)), limit=limit, unit=unit, text=words)


def about(found: Mapping[str, Quantity], known: Mapping[str, FlightSpread | str]) -> dict[str, Quantity]:
    """Quantities with the deviations and intervals that are known of them."""
    return {name: _about(one, known.get(name)) for name, one in found.items()}


def _about(quantity: Quantity, spread: FlightSpread | str | None) -> Quantity:
    if isinstance(spread, str):
        return quantity if quantity.value is None else replace(quantity, why=spread)
    if spread is None or quantity.value is None or not spread.std > SAME * abs(quantity.value):
        return quantity
    return spread.about(quantity.value, quantity.unit)
