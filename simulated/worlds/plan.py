"""Which tests there are: a third hide nothing; engines, loggers and ends of the fuel go round among all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from simulated.blind.effects import LIBRARY
from simulated.worlds import engines, loggers
from simulated.worlds.engines import ENDS

SETS = {
    "quick": 5_000_000,
    "development": 6_000_000,
    "calibration": 7_000_000,
    "looked_at": 10_000_000,
    "scored": 11_000_000,
}
"""Where the seeds of each begin. Constants in the code come of ``development``; what the diagnosis says of where it was
tried of ``calibration`` (with every engine and logger); those of ``quick`` and ``scored`` set nothing. ``looked_at``
was scored once, and changes came of what was seen there."""

WIDE = ("calibration",)
"""Sets with all engines and loggers, laws drawn test by test; others of that kind have the first four of each."""

OF_WORLDS = {"looked_at": "T", "scored": "U"}
"""Sets of a few worlds, each with one draw of laws, one engine class and one logger in all of its tests; and what the
names of these tests begin with."""

REFERENCE = "reference"
"""The world whose tests are runs of the plain reference solver (benchmarks/reference_engine.py)."""

OUTSIDE = ("slow_valve", "vent_leak", "injector_hydraulic_flip", "combustion_dc_shift", "entrainment_regression",
           "logger_skew", "feed_line_flashing", "tank_gas_ingestion")  # fmt: skip
"""Of those outside the library."""

KINDS = {"none": 20, "single": 28, "outside": 7, "pair": 5}
"""Tests of each kind among sixty."""

IN_WORLD = {"none": 25, "single": 12, "outside": 3, "pair": 2}
"""Tests of each kind in a world."""

IN_REFERENCE = {"none": 25, "single": 3}
"""In that of the reference solver, which knows no effect: what may be hidden there is of sensors."""

OF_SENSORS = ("load_cell_drift", "chamber_tap_lag", "pressure_transducer_offset")
"""Those."""

TARGETS = (12.0, 40.0)
"""d' of what is hidden, from and to, in logarithms."""


@dataclass(frozen=True)
class Test:
    """One test to write."""

    id: str
    kind: str
    effects: tuple[str, ...]
    engine: str
    logger: str
    end: str
    target: float
    seed: int
    world: str = ""
    laws: int | None = None

    @property
    def of_reference(self) -> bool:
        """Whether the reference solver runs it."""
        return self.world == REFERENCE


@dataclass(frozen=True)
class Place:
    """A world: an engine class, a logger, and the seed of its laws."""

    name: str
    engine: str
    logger: str
    laws: int


def worlds(which: str) -> list[Place]:
    """The worlds of a set: one of each logger, on engines in turn; the last one is that of the reference solver."""
    start = SETS[which]
    rng = np.random.default_rng(start)
    of_engines = [name for _ in range(2) for name in rng.permutation(list(engines.ENGINES))]
    of_loggers = [str(name) for name in rng.permutation(list(loggers.LOGGERS))]
    made = [
        Place(f"{chr(ord('A') + i)}", str(engine), logger, start + 500_000 + i)
        for i, (engine, logger) in enumerate(zip(of_engines, of_loggers, strict=False))
    ]
    return [*made[:-1], replace(made[-1], name=REFERENCE)]


def plan(which: str = "quick", count: int = 60) -> list[Test]:
    """All tests, always the same, in an order in which every stretch holds every kind."""
    if which in OF_WORLDS:
        return _by_worlds(which)[:count]
    start = SETS[which]
    rng = np.random.default_rng(start)
    singles, outside = _names(rng, count)
    kinds = [kind for _ in range(-(-count // 60)) for kind in _spread(KINDS)][:count]
    of = [(e, log) for _ in range(count) for e, log in stands(rng, which in WIDE)]
    tests = []
    for i, kind in enumerate(kinds):
        names = {"none": 0, "single": 1, "outside": 1, "pair": 2}[kind]
        effects = tuple((outside if kind == "outside" else singles).pop(0) for _ in range(names))
        engine, logger = of[i]
        low, high = np.log(TARGETS)
        end = "late" if "fuel_sliver" in effects else str(rng.choice(ENDS, p=(0.4, 0.2, 0.2, 0.2)))
        tests.append(
            Test(
                f"{which[0].upper()}{i:03d}",
                kind,
                effects,
                engine,
                logger,
                end,
                float(np.exp(rng.uniform(low, high))),
                start + i,
            )
        )
    return tests


def _names(rng: np.random.Generator, count: int) -> tuple[list[str], list[str]]:
    """Effects of the library, and of those outside, in turns."""
    inside = [e.name for e in LIBRARY]
    singles = [inside[i] for _ in range(count) for i in rng.permutation(len(inside))]
    return singles, [OUTSIDE[i] for _ in range(count) for i in rng.permutation(len(OUTSIDE))]


def _by_worlds(which: str) -> list[Test]:
    """The tests of all worlds of a set, one world after the other in turns."""
    start, rows = SETS[which], []
    rng = np.random.default_rng(start + 1)
    singles, outside = _names(rng, sum(IN_WORLD.values()))
    for k, place in enumerate(worlds(which)):
        reference = place.name == REFERENCE
        kinds = _spread(IN_REFERENCE if reference else IN_WORLD)
        for i, kind in enumerate(kinds):
            if reference:
                effects = (OF_SENSORS[i % len(OF_SENSORS)],) if kind == "single" else ()
            else:
                taken = outside if kind == "outside" else singles
                effects = tuple(taken.pop(0) for _ in range({"none": 0, "pair": 2}.get(kind, 1)))
            end = "late" if "fuel_sliver" in effects else str(rng.choice(ENDS, p=(0.4, 0.2, 0.2, 0.2)))
            target, seed = float(np.exp(rng.uniform(*np.log(TARGETS)))), start + 1000 * k + i
            name = f"{OF_WORLDS[which]}{place.name[0].upper()}{i:02d}"
            rows.append((i / len(kinds), k, Test(name, kind, effects, place.engine, place.logger, end, target, seed,
                                                 place.name, place.laws)))  # fmt: skip
    return [test for _, _, test in sorted(rows, key=lambda row: row[:2])]


def _spread(of: dict[str, int]) -> list[str]:
    """Kinds by their numbers, evenly mixed."""
    places = [((k + 0.5) / number, kind) for kind, number in of.items() for k in range(number)]
    return [kind for _, kind in sorted(places)]


def stands(rng: np.random.Generator, wide: bool = False) -> list[tuple[str, str]]:
    """Every engine by every logger once; the ``wide`` ones, or the first four of each."""
    of = (tuple(engines.ENGINES), tuple(loggers.LOGGERS)) if wide else (engines.QUICK, loggers.QUICK)
    among = [(engine, logger) for engine in of[0] for logger in of[1]]
    return [among[i] for i in rng.permutation(len(among))]
