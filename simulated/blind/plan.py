"""Which cases there are: none, single effects, outsiders, pairs of effects, and pairs of tests of one stand."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import cycle, islice, product

import numpy as np

from .effects import LIBRARY, OUTSIDE
from .sensors import FAMILIES

SPLITS = {"development": 1_000_000, "calibration": 2_000_000, "scored": 3_000_000}
"""Where the seeds of each begin; a million each, so that none occurs twice."""
MOST_CASES, MOST_SEEDS = 10_000, 100

TARGETS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""d' of single effects."""
OUTSIDE_TARGETS = (2.0, 4.0, 8.0, 16.0, 32.0)
"""d' of outsiders, after the best effect of the library."""
PAIR_TARGETS = (8.0, 16.0)
"""d' of each of two effects given the other."""
STAND_TARGETS = (4.0, 8.0, 16.0, 32.0)

SHARES = {"none": 0.22, "single": 0.432, "outside": 0.168, "pair": 0.08, "stand": 0.10}
"""Of the tests."""


@dataclass(frozen=True)
class Case:
    """One test to write. ``seed`` makes the test, ``stand_seed`` what tests of one stand share."""

    id: str
    kind: str
    effects: tuple[str, ...]
    target: float
    family: str
    seed: int
    stand_seed: int
    stand: str | None = None
    second: bool = False


def counts(total: int) -> dict[str, int]:
    """Tests of each kind; tests of a stand come in twos."""
    out = {kind: round(share * total) for kind, share in SHARES.items()}
    out["stand"] = 2 * round(SHARES["stand"] * total / 2.0)
    out["none"] += total - sum(out.values())
    return out


def _effects(kind: str, count: int, rng: np.random.Generator) -> list[tuple[tuple[str, ...], float]]:
    """Effects and targets, every combination as often as every other as far as they go."""
    inside, outside = ([e.name for e in group] for group in (LIBRARY, OUTSIDE))
    if kind == "none":
        return [((), 0.0)] * count
    if kind == "pair":
        pairs = [(a, b) for i, a in enumerate(inside) for b in inside[i + 1 :]]
        order = [pairs[i] for i in rng.permutation(len(pairs))]
        return list(islice(((p, t) for p, t in zip(cycle(order), cycle(PAIR_TARGETS), strict=False)), count))
    names, targets = (outside, OUTSIDE_TARGETS) if kind == "outside" else (inside, TARGETS)
    if kind == "stand":
        targets = STAND_TARGETS
    cells = list(product(names, targets))
    rounds: list[tuple[tuple[str, ...], float]] = []
    while len(rounds) < count:
        rounds += [((cells[i][0],), cells[i][1]) for i in rng.permutation(len(cells))]
    return rounds[:count]


def plan(total: int, split: str = "development", seed: int = 0) -> list[Case]:
    """All cases, always the same for the same arguments, in an order in which every stretch holds every kind."""
    if not (0 < total <= MOST_CASES and 0 <= seed < MOST_SEEDS):
        raise ValueError(f"at most {MOST_CASES} cases and {MOST_SEEDS} seeds, not {total} and {seed}")
    rng = np.random.default_rng([7, seed])
    start = SPLITS[split] + seed * MOST_CASES
    groups: list[tuple[str, tuple[str, ...], float]] = []
    for kind, count in counts(total).items():
        groups += [(kind, *x) for x in _effects(kind, count // 2 if kind == "stand" else count, rng)]
    cases: list[Case] = []
    family = cycle(FAMILIES)
    for i in rng.permutation(len(groups)):
        cases += _tests(*groups[i], next(family), start + len(cases), split[0].upper())
    return _balanced(cases)


def _tests(kind: str, effects: tuple[str, ...], target: float, family: str, seed: int, letter: str) -> list[Case]:
    number = f"{letter}{seed % 1_000_000:06d}"
    if kind != "stand":
        return [Case(number, kind, effects, target, family, seed, seed)]
    stand = f"stand-{number}"
    return [
        Case(f"{number}A", kind, effects, target, family, seed, seed, stand),
        Case(f"{number}B", kind, effects, target, family, seed + 1, seed, stand, second=True),
    ]


def _balanced(cases: list[Case]) -> list[Case]:
    """Tests without an effect get the families of noise in turn."""
    from dataclasses import replace

    family = cycle(FAMILIES)
    return [replace(c, family=next(family)) if c.kind == "none" else c for c in cases]
