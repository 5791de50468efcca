"""Two channels swapped: each does what the other should, and nothing that it should do itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hfanalysis.health.firing import EMPTY_LINE, burn_of, usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import called, level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text

HOLDS = 8e5
"""[Pa] at least of a tank at rest that will feed a firing. Source: nitrous oxide at -45 degC saturates at 8 bar."""
FALLS, STAYS = 0.2, 0.05
"""Part of its pressure that a tank loses at least in a firing, and that a purge's supply loses at most [-]."""
ABOVE = 3.0
"""Deviations of both accuracies by which a chamber has to be above its line to be the line [-]."""
MOST_OF_IT = 0.8
"""Part of the firing in which it is [-]."""


@dataclass(frozen=True)
class Manner:
    """How a channel goes through the firing: before, early and late in it, and after [SI]."""

    before: float
    early: float
    late: float

    @property
    def falls(self) -> float:
        """Part of what it was before that is gone late in the firing [-]."""
        return 1.0 - self.late / self.before if self.before else 0.0


def find(test: SeenTest) -> Iterator[Finding]:
    """Tank and line, tank and chamber, line and chamber, tank and purge, thrust and mass."""
    ways = {name: way for name in PAIRED if (way := _manner(test, name)) is not None}
    for first, second in PAIRS:
        if first in ways and second in ways and _swapped(test, first, second, ways):
            yield _finding(test, first, second, ways)
            return


PAIRS = (
    ("p_tank", "p_run"), ("p_tank", "p_chamber"), ("p_tank", "p_purge"), ("p_tank", "p_fill"), ("p_run", "p_chamber"),
    ("thrust", "m_tank"),
)  # fmt: skip
PAIRED = tuple(dict.fromkeys(name for pair in PAIRS for name in pair))


def _manner(test: SeenTest, name: str) -> Manner | None:
    seen = test.get(name)
    if seen is None or test.fire is None or seen.coarse.rest is None:
        return None
    start, end = test.fire
    trace, part = usable(test, seen), 0.2 * (end - start)
    early, late = trace.between(start + 0.5 * part, start + part), trace.between(end - 2.0 * part, end - part)
    if not len(early.values) or not len(late.values):
        return None
    return Manner(seen.coarse.rest.value, float(np.median(early.values)), float(np.median(late.values)))


def _swapped(test: SeenTest, first: str, second: str, ways: dict[str, Manner]) -> bool:
    a, b = ways[first], ways[second]
    if second in ("p_run", "p_chamber") and first == "p_tank":
        # no tank rests at ambient, and neither chamber nor line is full before and loses it: how much is no matter
        return _open_and_rises(a) and b.before > HOLDS and b.falls > STAYS and b.early > a.early
    if first == "p_tank":
        run = ways.get("p_run")
        follows = run is None or run.late < (1.0 - FALLS) * run.early
        return a.before > HOLDS and abs(a.falls) < STAYS and b.before > HOLDS and b.falls > FALLS and follows
    if first == "p_run":
        return _chamber_above(test, ways)
    return _weighs(a) and _pushes(b)


def _open_and_rises(way: Manner) -> bool:
    return way.before < EMPTY_LINE and way.early > way.before + HOLDS / 4.0


def _weighs(way: Manner) -> bool:
    """Becomes less, and nothing before."""
    return way.before > 0.0 and way.late < 0.8 * way.before and way.early < 1.05 * way.before


def _pushes(way: Manner) -> bool:
    """From nothing to much."""
    return abs(way.before) < 0.1 * way.early


def _chamber_above(test: SeenTest, ways: dict[str, Manner]) -> bool:
    """The chamber above its line through most of the firing, and below the tank, which it would not be if it only read
    too much."""
    burn = burn_of(test, "p_run", "p_chamber")
    if burn is None or not (_open_and_rises(ways["p_run"]) and _open_and_rises(ways["p_chamber"])):
        return False
    run, chamber = test.channels["p_run"], test.channels["p_chamber"]
    sure = ABOVE * float(np.hypot(run.channel.accuracy, chamber.channel.accuracy))
    above = burn.values["p_chamber"] - burn.values["p_run"] > sure
    tank = ways.get("p_tank")
    below = tank is None or ways["p_chamber"].early < tank.early
    return float(np.mean(above[burn.burning])) > MOST_OF_IT and below


def _finding(test: SeenTest, first: str, second: str, ways: dict[str, Manner]) -> Finding:
    def said(name: str) -> str:
        way, dimension = ways[name], test.channels[name].dimension
        return text(
            "{name} goes from {before} at rest to {early} early and {late} late in the firing", name=called(name),
            before=level(way.before, dimension), early=level(way.early, dimension), late=level(way.late, dimension),
        )  # fmt: skip

    a, b = test.channels[first], test.channels[second]
    cure = f"[channels.{first}]\n{_column(b)}\n[channels.{second}]\n{_column(a)}"
    evidence = text("{first}, {second}: each does what the other should", first=said(first), second=said(second))
    return Finding(
        kind="swapped", verdict="unusable", channels=(first, second), evidence=evidence,
        means="the two columns are swapped, in the log or in test.toml: every number from them is another's", cure=cure,
    )  # fmt: skip


def _column(seen: Seen) -> str:
    column = seen.spec.column
    return f'column = "{column}"' if isinstance(column, str) else f"column = {column}"
