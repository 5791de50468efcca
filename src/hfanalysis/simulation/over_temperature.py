"""The same engine on colder and warmer days: its numbers over the temperature of the tank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.record.schema import changed
from hfanalysis.simulation.spread import ENOUGH, SEED, DrawnFile, draw, engine_of, is_loose, run, with_tank_as_built
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


DRAWN = 40
"""Engines drawn at each temperature. Source: by choice; thirteen temperatures make a band that is smooth to the eye."""


@dataclass(frozen=True)
class OverTemperature:
    """Numbers [SI] by name, (n,) each, at temperatures (n,) [degC] of the tank; NaN where there is none; and at the
    file's own. ``bands``: 95 % intervals, (n,) and (n,), where the file states what makes them; the temperature's own
    +/- is in none. ``refused``: by temperature [degC], why there is no such engine."""

    temperature: Array
    numbers: dict[str, Array]
    stated: dict[str, float]
    bands: dict[str, tuple[Array, Array]]
    refused: dict[float, str]


def over_temperature(file: EngineFile, effects: Adopted, command: str, drawn: int = DRAWN) -> OverTemperature:
    """Of the file's tank as built and loaded, at DAYS; with bands of ``drawn`` engines each."""
    built = with_tank_as_built(file, command)
    files = [DrawnFile(one, {}) for one in (built, *(_at(built, t) for t in DAYS))]
    engine, flight, _ = run(files, effects, None, command)
    kept = {name: of for name, of in {**engine, **flight}.items() if name in NAMES}
    kept = {name: kept[name] for name in NAMES if name in kept}
    made = [engine_of(one, command) for one in files[1:]]
    refused = {float(t): one for t, one in zip(DAYS, made, strict=True) if isinstance(one, str)}
    own = {name: float(of[0]) for name, of in kept.items()}
    bands = _bands(built, effects, command, drawn) if drawn and is_loose(_at(built, DAYS[0])) else {}
    return OverTemperature(DAYS, {name: of[1:] for name, of in kept.items()}, own, bands, refused)


def _bands(built: EngineFile, effects: Adopted, command: str, drawn: int) -> dict[str, tuple[Array, Array]]:
    files = [one for t in DAYS for one in draw(_at(built, t), drawn, SEED).files]
    engine, flight, _ = run(files, effects, np.random.default_rng([SEED, 1]), command)
    found = {name: of.reshape(len(DAYS), drawn) for name, of in {**engine, **flight}.items() if name in NAMES}
    return {name: (_quantile(of, 0.025), _quantile(of, 0.975)) for name, of in found.items()}


def _quantile(found: Array, share: float) -> Array:
    """Along the last axis; NaN where too few draws have a number."""
    enough = np.isfinite(found).mean(axis=1) >= ENOUGH
    out = np.full(len(found), np.nan)
    out[enough] = np.nanquantile(found[enough], share, axis=1)
    return out


def _at(file: EngineFile, celsius: float) -> EngineFile:
    return changed(file, tank=changed(file.tank, temperature=Value(CELSIUS + float(celsius))))
