"""The same engine on colder and warmer days: its numbers over the temperature of the tank."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.unsteady import Engine
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.record.schema import changed
from hfanalysis.simulation.spread import DrawnFile, engine_of, numbers_of, table, with_tank_as_built
from hfanalysis.units import Value

CELSIUS = 273.15
"""[K]. Source: definition."""

DAYS = np.linspace(5.0, 35.0, 13)
"""Temperatures [degC] of a spring morning to a desert's noon; nitrous oxide is critical at 36.4."""

NAMES = {
    "total_impulse": "total impulse", "peak_thrust": "peak thrust", "peak_chamber_pressure": "peak chamber pressure",
    "burn_time": "burn time", "apogee": "apogee",
}  # fmt: skip
"""What is told, and what people read."""


@dataclass(frozen=True)
class OverTemperature:
    """Numbers [SI] by name, (n,) each, at temperatures (n,) [degC] of the tank; NaN where there is none; and at the
    file's own. ``refused``: by temperature [degC], why there is no such engine."""

    temperature: Array
    numbers: dict[str, Array]
    stated: dict[str, float]
    refused: dict[float, str]


def over_temperature(file: EngineFile, effects: Adopted, command: str) -> OverTemperature:
    """Of the file's tank as built and loaded, at DAYS."""
    built = with_tank_as_built(file, command)
    files = [built, *(_at(built, CELSIUS + float(t)) for t in DAYS)]
    made = [engine_of(DrawnFile(one, {}), command) for one in files]
    there = [i for i, one in enumerate(made) if isinstance(one, Engine)]
    engines = [replace(one, effects=effects.acting) for one in made if isinstance(one, Engine)]
    rows = [numbers_of(files[i], e, b) for i, e, b in zip(there, engines, burn_many(engines), strict=True)]
    found = table([{**engine, **flight} for engine, flight, _ in rows], there, len(files))
    kept = {name: found[name] for name in NAMES if name in found}
    refused = {float(t): one for t, one in zip(DAYS, made[1:], strict=True) if isinstance(one, str)}
    own = {name: float(of[0]) for name, of in kept.items()}
    return OverTemperature(DAYS, {name: of[1:] for name, of in kept.items()}, own, refused)


def _at(file: EngineFile, kelvin: float) -> EngineFile:
    return changed(file, tank=changed(file.tank, temperature=Value(kelvin)))
