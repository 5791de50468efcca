"""Records of runs whose truth is known, as sensors with known noise make them, for the tests of weak residuals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand

from hfanalysis.diagnose.weak_form.spread import Spread
from hfanalysis.diagnose.weak_form.weak import WeakResidual, weak_residuals
from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import Burn, Engine, burn

Array = NDArray[np.float64]

NOISE = {"p_tank": 3e3, "p_run": 3e3, "p_chamber": 3e3, "thrust": 5.0}
BIAS = {"p_tank": 5e3, "p_run": 5e3, "p_chamber": 5e3, "thrust": 5.0}
RELATIVE = {"area": 0.005, "loss_factor": 0.02, "oxidizer_mass": 0.003, "temperature": 3e-4, "a": 0.01, "n": 0.003}
"""Standard deviations of the constants, relative to themselves."""

TANK = ("tank_energy", "tank_volume", "injector")


@dataclass(frozen=True)
class Reading:
    name: str
    time: Array
    value: Array
    covariance: Array


@dataclass(frozen=True)
class Record:
    channels: tuple[Reading, ...]
    phases: Mapping[str, float]
    end: float

    def without(self, *names: str) -> Record:
        return replace(self, channels=tuple(c for c in self.channels if c.name not in names))

    def plus(self, name: str, offset: float) -> Record:
        moved = tuple(replace(c, value=c.value + offset) if c.name == name else c for c in self.channels)
        return replace(self, channels=moved)


@cache
def run_of(*effects: Active) -> Burn:
    return burn(engine_on_stand(effects=effects), 9.0, rtol=1e-6, run_on=True)


def recorded(run: Burn, seed: int | None = None, spacing: float = 0.02, start: float = 0.05) -> Record:
    """What sensors read of a run: with noise and offsets, or (no seed) without."""
    assert run.liquid_out is not None
    rng = np.random.default_rng(seed)
    end = run.burn_time - 0.06
    time = np.arange(start, end, spacing)
    time = time[np.abs(time - run.liquid_out) > 0.06]
    read, channels = observe(run, time), []
    for name, noise in NOISE.items():
        value = read[name]
        if seed is not None:
            value = value + noise * rng.standard_normal(time.size) + BIAS[name] * rng.standard_normal()
        channels.append(Reading(name, time, value, noise**2 * np.eye(time.size) + BIAS[name] ** 2))
    return Record(tuple(channels), {"liquid": 0.0, "vapor": run.liquid_out, "end": end}, end)


def spread() -> Spread:
    engine = engine_on_stand()
    values = {name: getattr(engine.feed, name, None) or getattr(engine, name) for name in RELATIVE}
    return Spread.of({name: RELATIVE[name] * value for name, value in values.items()})


def calibrated(seed: int) -> Engine:
    """The engine as a calibration with that spread may find it."""
    engine, rng, known = engine_on_stand(), np.random.default_rng(1000 + seed), spread()
    found = {
        n: s * rng.standard_normal() for n, s in zip(known.names, np.sqrt(known.covariance.diagonal()), strict=True)
    }
    feed = replace(engine.feed, **{n: getattr(engine.feed, n) + found.pop(n) for n in ("area", "loss_factor")})
    return replace(engine, feed=feed, **{n: getattr(engine, n) + moved for n, moved in found.items()})


def residuals(test: Record, engine: Engine | None = None) -> dict[str, WeakResidual]:
    return {r.equation: r for r in weak_residuals(test, engine or engine_on_stand(), spread())}


@cache
def of(*effects: Active) -> dict[str, WeakResidual]:
    return residuals(recorded(run_of(*effects)))


def wet(residual: WeakResidual) -> NDArray[np.bool_]:
    return np.array([phase == "liquid" for phase in residual.phases])


def worst(residual: WeakResidual) -> float:
    return float(np.abs(residual.value / residual.std).max())
