"""Which tests there are: a third hide nothing; engines, loggers and ends of the fuel go round among all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from simulated.blind.effects import LIBRARY
from simulated.worlds import engines, loggers
from simulated.worlds.engines import ENDS

SETS = {"quick": 5_000_000, "development": 6_000_000, "calibration": 7_000_000, "scored": 8_000_000}
"""Where the seeds of each begin. Constants in the code come of ``development``; what the diagnosis says of where it was
tried of ``calibration`` (with every engine and logger); those of ``quick`` and ``scored`` set nothing."""

WIDE = ("calibration", "scored")
"""Sets with all engines and loggers; the others have the first four of each."""

OUTSIDE = ("slow_valve", "vent_leak", "injector_hydraulic_flip", "combustion_dc_shift", "entrainment_regression",
           "logger_skew", "feed_line_flashing", "tank_gas_ingestion")  # fmt: skip
"""Of those outside the library."""

KINDS = {"none": 20, "single": 28, "outside": 7, "pair": 5}
"""Tests of each kind among sixty."""

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


def plan(which: str = "quick", count: int = 60) -> list[Test]:
    """All tests, always the same, in an order in which every stretch holds every kind."""
    start = SETS[which]
    rng = np.random.default_rng(start)
    inside = [e.name for e in LIBRARY]
    singles = [inside[i] for _ in range(count) for i in rng.permutation(len(inside))]
    outside = [OUTSIDE[i] for _ in range(count) for i in rng.permutation(len(OUTSIDE))]
    kinds = [kind for _ in range(-(-count // 60)) for kind in _spread()][:count]
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


def _spread() -> list[str]:
    """Kinds of sixty tests, evenly mixed."""
    places = [((k + 0.5) / number, kind) for kind, number in KINDS.items() for k in range(number)]
    return [kind for _, kind in sorted(places)]


def stands(rng: np.random.Generator, wide: bool = False) -> list[tuple[str, str]]:
    """Every engine by every logger once; the ``wide`` ones, or the first four of each."""
    of = (tuple(engines.ENGINES), tuple(loggers.LOGGERS)) if wide else (engines.QUICK, loggers.QUICK)
    among = [(engine, logger) for engine in of[0] for logger in of[1]]
    return [among[i] for i in rng.permutation(len(among))]
