"""A log of the stand's engine as sensors read it, with its true phases: what is reduced to observations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand
from tests.segment.stand import channel, definition

from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import Burn, burn
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.reduction import observe_test
from hfanalysis.inference.unknown import Samples, Unknown
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import Site
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value

Array = NDArray[np.float64]
Seen = TypeVar("Seen", bound=Unknown)

OPENING, RATE, QUIET, AFTER = 50.0, 200.0, 4.0, 4.0
"""The opening in log time [s], samples per second, and seconds logged before it and after the burn."""

WHITE = {"p_tank": 6e3, "p_run": 6e3, "p_chamber": 6e3, "thrust": 10.0, "m_tank": 0.02}
"""Standard deviation of a sample [SI]."""

ACCURACY = {"p_tank": 1e4, "p_run": 1e4, "p_chamber": 1e4, "thrust": 8.0, "m_tank": 0.05}


@cache
def run() -> Burn:
    return burn(engine_on_stand(), 12.0, run_on=True)


def clean() -> tuple[Array, dict[str, Array]]:
    """Seconds after the opening, and what perfect sensors read."""
    done = run()
    time = np.arange(-QUIET + 0.5 / RATE, done.burn_time + AFTER, 1.0 / RATE)
    read = observe(done, np.maximum(time, 0.0))
    ambient = done.steps.engine.ambient_pressure
    for name, rest in (("p_run", ambient), ("p_chamber", ambient), ("thrust", 0.0)):
        read[name] = np.where((time < 0.0) | (time > done.burn_time + 0.3), rest, read[name])
    return time, {name: read[name] for name in WHITE}


def log(seed: int | None = 0, plus: Mapping[str, Array] | None = None, only: tuple[str, ...] = tuple(WHITE)) -> TestLog:
    """With white noise (no seed: without); ``plus`` is added to channels."""
    rng = np.random.default_rng(seed)
    time, read = clean()
    made = {}
    for name in only:
        noise = 0.0 if seed is None else WHITE[name] * rng.standard_normal(time.size)
        made[name] = channel(name, time + OPENING, read[name] + noise + (plus or {}).get(name, 0.0), ACCURACY[name])
    return TestLog(made)


def stated(**change: Any) -> TestDefinition:
    """What is stated of the test; accuracies among it."""
    engine = engine_on_stand()
    made = definition(
        mass=Value(engine.oxidizer_mass, 0.01), site=Site(ambient_pressure=Value(engine.ambient_pressure)), **change
    )
    channels = {name: _Stated(Value(value)) for name, value in ACCURACY.items()}
    return replace(made, channels=channels)  # type: ignore[arg-type]


class _Stated:
    """A channel of test.toml of which only the accuracy is asked."""

    def __init__(self, accuracy: Value) -> None:
        self.accuracy = accuracy


def segments(**change: Quantity) -> Segments:
    """The true phases."""
    done = run()
    assert done.liquid_out is not None
    absent = {n: Quantity.absent("this test does not have it") for n in EVENTS if n != "t_fuel_gone"}  # as t_fuel_out
    known = {
        "t_v": Quantity(done.liquid_out, "s", 1e-3),
        "t_fuel_out": Quantity(done.burn_time, "s", 0.01),
        "t_feed": Quantity(0.15, "s", 0.01),
    }
    return Segments.of(Quantity(OPENING, "s", 1e-4), absent | known | change, kind="hot_fire")


def seen(
    kind: type[Seen],
    signals: Mapping[str, Signal],
    steady: float = 5.0,
    phases: Segments | None = None,
    shown: float | None = None,
) -> Seen | None:
    """What the samples show of a kind of unknown; the true phases where no others are given, and a flame to the end
    where it is not ``shown`` [s after the opening] for less."""
    return kind.in_samples(Samples(signals, phases or segments(), steady, shown))


def reduced(of: TestLog | None = None, definition: TestDefinition | None = None, **events: Quantity) -> Observed:
    return observe_test(of or log(), segments(**events), definition or stated())
