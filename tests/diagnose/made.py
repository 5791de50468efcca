"""Made-up observations: the stand's engine, run with or without an effect, read by sensors with known noise."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from tests.engine.stand import engine_on_stand

from hfanalysis.diagnose.hypothesis import Hypothesis, base_hypothesis
from hfanalysis.diagnose.observed import (
    AROUND_CHANGE,
    CHANNELS,
    EVENT_STD,
    FIRST,
    FORM_ERROR,
    FUEL_STD,
    Channel,
    Observed,
)
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Engine, burn

NOISE = {"p_tank": 3e3, "p_run": 3e3, "p_chamber": 3e3, "thrust": 5.0}
"""Standard deviation of a block mean."""

BIAS = {"p_tank": 5e3, "p_run": 5e3, "p_chamber": 5e3, "thrust": 5.0}


def observed(*effects: Active, seed: int = 1, offsets: dict[str, float] | None = None) -> Observed:
    """What the sensors read of a run with these effects; ``offsets`` are added to readings from 3 s on."""
    return of_engine(engine_on_stand(effects=effects), seed, offsets or {})


def of_engine(engine: Engine, seed: int, offsets: dict[str, float]) -> Observed:
    rng = np.random.default_rng(seed)
    done = burn(engine, 9.0, run_on=True)
    assert done.liquid_out is not None
    end = done.burn_time - AROUND_CHANGE
    time = np.arange(FIRST, end, 0.04)
    time = time[np.abs(time - done.liquid_out) > AROUND_CHANGE]
    _, outputs = done.steps.at(time)
    from hfanalysis.engine.model import OUTPUTS

    channels = []
    for name, output in CHANNELS.items():
        value = outputs[:, OUTPUTS.index(output)] + NOISE[name] * rng.standard_normal(time.size)
        value = value + BIAS[name] * rng.standard_normal() + offsets.get(name, 0.0) * (time > 3.0)
        covariance = NOISE[name] ** 2 * np.eye(time.size) + BIAS[name] ** 2
        channel = Channel(name, time, value, np.full(time.size, NOISE[name]), BIAS[name], covariance, covariance)
        channels.append(channel.at_form(FORM_ERROR))
    instants = {"t_v": (done.liquid_out, EVENT_STD), "t_fuel_out": (done.burn_time, FUEL_STD)}
    events = {name: (at + std * float(rng.standard_normal()), std) for name, (at, std) in instants.items()}
    return Observed(tuple(channels), events, {"liquid": 0.0, "vapor": done.liquid_out, "end": end}, end)


@cache
def hypothesis() -> Hypothesis:
    """The base model, calibrated a little wrongly."""
    engine = engine_on_stand(temperature=293.4, a=1.1e-4)
    wrong = replace(engine, feed=replace(engine.feed, area=engine.feed.area * 1.03, loss_factor=6.0e8))
    return base_hypothesis(wrong, {"oxidizer_mass": {"value": 8.35, "std": 0.02}})
