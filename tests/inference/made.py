"""Made-up observations: the stand's engine, run with or without an effect, read by sensors with known noise."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from tests.engine.stand import engine_on_stand
from tests.products.filled import loaded

from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.fitting.hypothesis import Hypothesis, base_hypothesis
from hfanalysis.inference.fitting.predict import ACCURACY, readings, with_spare_fuel
from hfanalysis.inference.observations.channel import ObservedChannel
from hfanalysis.inference.observations.frame import AROUND_CHANGE, EVENT_STD, FIRST, FUEL_STD
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.recorded import TOGETHER

Array = NDArray[np.float64]

NOISE = {"p_tank": 3e3, "p_run": 3e3, "p_chamber": 3e3, "thrust": 5.0}
"""Standard deviation of a block mean [SI]."""

BIAS = {"p_tank": 5e3, "p_run": 5e3, "p_chamber": 5e3, "thrust": 5.0}
"""Stated accuracy [SI]: offset, and error of the gain at the largest reading."""

COMMON = 0.6
"""Correlation of a block of chamber pressure with the same of thrust."""

TIMING = {"t_v": 1e-3, "t_fuel_out": 0.03}
"""How well instants are found [s]; what is taken for their deviation counts the model's knees as well."""

SPACING, RESTING = 0.04, (12.0, 12.5)
"""Seconds between points of the grid in the burn, and where they lie after it."""


def observed(*effects: Active, seed: int = 1, engine: Engine | None = None, common: bool = False) -> Observed:
    """What the sensors read of a run of the stand's engine with these effects; noise as the covariance says."""
    done, fuel_out = _run(effects) if engine is None else _run_of(engine)
    quiet = _quiet(done, fuel_out, common)
    rng = np.random.default_rng(seed)
    read = readings(quiet, done)
    noise = np.split(_noise(quiet, rng), np.cumsum([c.time.size for c in quiet.channels])[:-1])
    channels = tuple(replace(c, value=c.averaged(read[c.name]) + n) for c, n in zip(quiet.channels, noise, strict=True))
    events = {n: (at + TIMING[n] * float(rng.standard_normal()), std) for n, (at, std) in quiet.events.items()}
    return replace(quiet, channels=channels, events=events)


@cache
def _run(effects: tuple[Active, ...]) -> tuple[Burn, float]:
    return _run_of(engine_on_stand(effects=effects))


def _run_of(engine: Engine) -> tuple[Burn, float]:
    """A run of an engine that does not run out of fuel, and when it does."""
    done = burn(with_spare_fuel(engine), 10.0, ACCURACY, run_on=True)
    return done, burn(engine, 10.0, ACCURACY, run_on=True).burn_time


def _quiet(done: Burn, fuel_out: float, common: bool) -> Observed:
    """The observations with values that are the model's, without noise."""
    assert done.liquid_out is not None
    end = fuel_out - AROUND_CHANGE
    burning = np.arange(0.5 * SPACING, end, SPACING)
    grid = np.concatenate([[0.0], burning, RESTING])
    resting = np.concatenate([[True], np.zeros(burning.size, dtype=bool), [True, True]])
    instants = {"t_v": (done.liquid_out, EVENT_STD), "t_fuel_out": (fuel_out, FUEL_STD)}
    phases = {"filling": 0.0, "liquid": 0.2, "vapor": done.liquid_out, "end": end}
    empty = Observed((), grid, resting, instants, {}, phases, end, end, done.steps.engine.ambient_pressure)
    read = readings(empty, done)
    kept = ~resting & (grid > FIRST) & (np.abs(grid - done.liquid_out) > AROUND_CHANGE)
    channels = tuple(_channel(name, read[name], grid, resting, kept) for name in NOISE)
    if not common:
        return replace(empty, channels=channels)
    sizes = [np.where(c.resting, 0.0, NOISE[c.name]) for c in channels if c.name in TOGETHER]
    one, two = (c for c in channels if c.name in TOGETHER)
    same = one.time[:, np.newaxis] == two.time[np.newaxis, :]
    return replace(empty, channels=channels, common=COMMON * same * np.outer(*sizes))


def _channel(
    name: str, reading: Array, grid: Array, resting: NDArray[np.bool_], kept: NDArray[np.bool_]
) -> ObservedChannel:
    after = resting & (grid > 0.0) if name in ("p_chamber", "thrust") else np.zeros_like(resting)
    first = np.flatnonzero(kept | after)
    one = np.ones(first.size)
    value, still = reading[first], resting[first]
    burning = np.where(still, 0.0, 1.0)
    gain = value * burning / np.abs(value).max()
    covariance = NOISE[name] ** 2 * np.diag(one)
    covariance = covariance + BIAS[name] ** 2 * (np.outer(burning, burning) + np.outer(gain, gain))
    count = np.ones(first.size, dtype=np.int64)
    return ObservedChannel(name, grid[first], value, first, count, still, NOISE[name] * one, BIAS[name], covariance)


def covariance_of(test: Observed) -> Array:
    """The covariance of all blocks, channel after channel."""
    out = block_diag(*(c.covariance + c.form_covariance(test.errors) for c in test.channels))
    if test.common is not None:
        edges = np.cumsum([0, *(c.time.size for c in test.channels)])
        a, b = (slice(edges[i], edges[i + 1]) for i in (test.names.index(name) for name in TOGETHER))
        out[a, b], out[b, a] = test.common, test.common.T
    return np.asarray(out)


def _noise(test: Observed, rng: np.random.Generator) -> Array:
    covariance = covariance_of(test)
    return np.asarray(np.linalg.cholesky(covariance) @ rng.standard_normal(covariance.shape[0]))


@cache
def hypothesis() -> Hypothesis:
    """The base model, calibrated a little wrongly."""
    engine = engine_on_stand(temperature=293.4, a=1.1e-4)
    wrong = replace(engine, feed=replace(engine.feed, area=engine.feed.area * 1.03, loss_factor=6.0e8))
    return base_hypothesis(wrong, loaded(8.35, 0.02))


@cache
def truth() -> Array:
    """The x of the hypothesis at which its engine is the one that was observed."""
    engine, base = engine_on_stand(), hypothesis()
    true = {name: getattr(engine.feed, name, getattr(engine, name, None)) for name in base.names}
    return np.array([f.place(float(true[f.name])) for f in base.free])
