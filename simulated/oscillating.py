"""Burns that oscillate in a known way, and burns whose begin and end are known, as loggers of many kinds see them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import cast

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.performance.stability.modes import Mode
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, TestLog

MEAN, LIQUID, END = 2e6, 5.0, 7.0
"""Chamber pressure [Pa]; when the liquid is gone and the fire out [s]."""

LEVEL = {"p_tank": 2.5, "p_run": 2.0, "p_chamber": 1.0, "thrust": 1e-3}
"""Of each channel, over MEAN."""

RATES = (50.0, 100.0, 250.0, 1000.0, 5000.0)
"""[Hz] of the loggers."""

OWN = "the intrinsic low frequency of a hybrid"
"""What swings where the feed does not."""


@dataclass(frozen=True)
class Swing:
    """A line: ``frequency`` [Hz] at first, by what it moves [Hz/s], rms [-] over the mean; ``fed``: by the feed."""

    frequency: float
    chirp: float
    share: float
    fed: bool


@dataclass(frozen=True)
class Case:
    """A burn as a logger of ``rate`` [Hz] sees it: sensors' ``noise`` and ``hum`` of the mains [-], and what swings."""

    rate: float
    noise: float
    mains: float
    hum: float
    swings: tuple[Swing, ...]
    seed: int


def case(seed: int, smooth: bool = False) -> Case:
    """One of many: none, or one or two lines of 5 to 200 Hz and 0.5 to 20 % of the mean, half of them by the feed."""
    r = np.random.default_rng(seed)
    number = 0 if smooth else int(r.integers(1, 3))
    swings = [
        Swing(
            float(np.exp(r.uniform(np.log(5.0), np.log(200.0)))),
            float(r.choice([0.0, r.uniform(-0.5, 0.5)])),
            float(np.exp(r.uniform(np.log(0.005), np.log(0.2))) / np.sqrt(2.0)),
            bool(r.random() < 0.5),
        )
        for _ in range(number)
    ]
    if number == 2:  # two that are one to the eye are one
        second = replace(swings[1], frequency=swings[0].frequency * float(r.choice([0.5, 0.7, 1.5, 2.5])))
        swings[1] = second
    return Case(
        rate=float(r.choice(RATES)),
        noise=float(np.exp(r.uniform(np.log(0.001), np.log(0.01)))),
        mains=float(r.choice([50.0, 60.0])),
        hum=float(r.choice([0.0, r.uniform(0.001, 0.004)])),
        swings=tuple(swings),
        seed=seed,
    )


def oscillating(of: Case) -> tuple[TestLog, Segments]:
    """The log of a case, and its phases."""
    r = np.random.default_rng(of.seed + 1_000_000)
    time = np.arange(-3.0 - r.random() / of.rate, END + 2.0, 1.0 / of.rate)
    lit = np.where((time > 0.0) & (time < END), 1.0, 0.0)
    level = lit * np.exp(-0.04 * np.clip(time, 0.0, None)) * np.where(time > LIQUID, 0.7, 1.0)
    values = {}
    for name, times in LEVEL.items():
        value = times * MEAN * level + of.noise * times * MEAN * r.standard_normal(time.size)
        value += of.hum * times * MEAN * np.sqrt(2.0) * np.sin(2.0 * np.pi * of.mains * time + r.uniform(0.0, 6.0))
        values[name] = value
    for swing in of.swings:
        wave = _wave(time, swing, float(r.uniform(0.0, 6.0))) * lit * level
        values["p_chamber"] += MEAN * wave
        values["thrust"] += LEVEL["thrust"] * MEAN * wave
        # what drives swings against the chamber; a feed that only follows has a part of it, in phase
        part = -0.8 if swing.fed else 0.25
        values["p_run"] += part * MEAN * wave
    flags = np.zeros(time.size, dtype=np.uint8)
    units = {"thrust": "N"}
    log = TestLog({n: Channel(n, units.get(n, "Pa"), time, v, flags, 1e4, True, n) for n, v in values.items()})
    return log, _segments()


def _wave(time: Array, swing: Swing, phase: float) -> Array:
    turns = swing.frequency * time + 0.5 * swing.chirp * time**2
    return np.asarray(np.sqrt(2.0) * swing.share * np.sin(2.0 * np.pi * turns + phase))


def _segments(**times: float) -> Segments:
    known = {"t_feed": 0.2, "t_v": LIQUID, "t_end": END, **times}
    events = {n: Quantity(known[n], "s", 0.01) if n in known else Quantity.absent("none") for n in EVENTS}
    return Segments.of(Quantity(0.0, "s", 1e-3), events, kind="hot_fire", misfire=False)


def modes_of(of: Case) -> tuple[Mode, ...]:
    """What this engine can do by itself: the first of what swings without the feed, and two modes of the gas."""
    own = next((s.frequency for s in of.swings if not s.fed), 20.0)
    return (
        Mode(OWN, 0.7 * own, 1.5 * own),
        Mode("the Helmholtz mode of the chamber", 300.0, 380.0),
        Mode("the first longitudinal mode of the chamber", 480.0, 620.0),
    )


@dataclass(frozen=True)
class Started:
    """A burn whose begin and end are known: its log, phases, definition, and the ``true`` times [s] by name."""

    log: TestLog
    segments: Segments
    definition: TestDefinition
    true: dict[str, float]


def started(seed: int) -> Started:
    """Pressure and thrust that rise and fall in exponentials, with a hard start or without."""
    r = np.random.default_rng(seed)
    delay, rise, fall = r.uniform(0.05, 0.6), r.choice([0.02, r.uniform(0.05, 0.2)]), r.uniform(0.05, 0.2)
    over, rate, noise = r.choice([0.0, 0.6]), r.choice(RATES), r.choice([2e-3, 1e-2])

    def course(time: Array) -> Array:
        since = np.clip(time - delay, 0.0, None)
        shape = (1.0 - np.exp(-since / rise)) * (1.0 + over * np.exp(-since / 0.08))
        return np.asarray(MEAN * shape * np.where(time < END, 1.0, np.exp(-(time - END) / fall)))

    fine = np.arange(0.0, END + 3.0, 2e-4)
    clean = course(fine)
    first, last = (fine[np.argmax(clean > part * MEAN)] for part in (0.1, 0.9))
    true = {"ignition_delay": float(first), "rise_time": float(last - first)}
    for name, part in (("action_time", 0.1), ("burn_time_5_percent", 0.05)):
        above = fine[clean > part * clean.max()]
        true[name] = float(above[-1] - above[0])
    time = np.arange(-2.0 - r.random() / rate, END + 3.0, 1.0 / rate)
    flags, pressure = np.zeros(time.size, dtype=np.uint8), course(time)
    values = {
        "p_chamber": ("Pa", pressure + 1e5 + 4e3 * r.standard_normal(), MEAN),
        "p_run": ("Pa", 2.5 * pressure, MEAN),
        "thrust": ("N", 1e-3 * pressure, 1e-3 * MEAN),
    }
    log = TestLog({
        n: Channel(n, u, time, v + noise * size * r.standard_normal(time.size), flags, 0.005 * size, True, n)
        for n, (u, v, size) in values.items()
    })  # fmt: skip
    return Started(log, _segments(), cast("TestDefinition", SimpleNamespace(stand=None)), true)
