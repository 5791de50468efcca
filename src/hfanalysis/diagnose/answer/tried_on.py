"""How a test compares with the simulated ones on which the diagnosis was tried, and what that says of its answer.

The rows of worlds.json are tests of the set ``calibration`` of docs/worlds.md, which no constant of the diagnosis
comes of: under which conditions each was taken, what was stated of it most surely, and whether that was right.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from math import log

import numpy as np

from hfanalysis.diagnose.answer.posterior import BEFORE, SET, kind
from hfanalysis.inference.gap import noise_of
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.subject import Subject
from hfanalysis.products.diagnosis import Diagnosis, TriedOn
from hfanalysis.wording.numbers import listed

CHANNELS = ("p_tank", "p_run", "p_chamber", "thrust", "p_purge", "m_tank")
"""Those that tests of worlds have."""

NEAREST = 30
"""Tests that count as like one. Source: choice; of about a dozen statements one more or less that is wrong is 8 %."""

BEYOND = 1.5
"""Times the least or the largest value of a condition beyond which a test is outside of what was tried. Source: choice,
half more."""


@dataclass(frozen=True)
class Conditions:
    """How a test was taken: samples per second, seconds of rest before the opening, noise of block means over a
    channel's largest value [-] and oxidizer loaded [kg]; and ``lacks``, channels that were not compared."""

    rate: float
    rest: float
    noise: float
    load: float
    lacks: tuple[str, ...] = ()

    @property
    def numbers(self) -> dict[str, float]:
        """Those that are numbers."""
        return {name: getattr(self, name) for name in WORDS}

    def far(self, other: Conditions, scales: Mapping[str, float]) -> float:
        """How unlike two tests are [-]: 1 for the whole range of a condition, or for a channel that one of them
        lacks."""
        apart = sum((log(x / other.numbers[n]) / scales[n]) ** 2 for n, x in self.numbers.items())
        return float(apart + len(set(self.lacks) ^ set(other.lacks)))


AVERAGE = 4
"""Statements as good as the average that are counted with those of a world. Source: choice, more than the one to three
that a world has itself, by which its share would be all or nothing."""

WORDS = {
    "rate": ("samples a second", "", ".3g"),
    "rest": ("of rest", "s", ".2g"),
    "noise": ("of noise in a mean", "%", ".2g"),
    "load": ("of oxidizer", "kg", ".2g"),
}
"""Conditions in words, their units and how they are written."""


@dataclass(frozen=True)
class Row:
    """A simulated test: its ``world``, how it was taken, the probability of what was stated of it most surely, and
    whether all that was stated above SET was right."""

    world: str
    conditions: Conditions
    stated: float
    right: bool

    @property
    def sure(self) -> bool:
        """Whether anything was stated surely."""
        return self.stated > SET


@lru_cache
def rows() -> tuple[Row, ...]:
    """All of them."""
    source = files("hfanalysis.diagnose.answer") / "worlds.json"
    found = json.loads(source.read_text(encoding="utf-8"))["tests"]
    return tuple(
        Row(r["world"], Conditions(**{n: r[n] for n in WORDS}, lacks=tuple(r["lacks"])), r["stated"], r["right"])
        for r in found
    )


def conditions_of(subject: Subject, observed: Observed) -> Conditions | None:
    """How a test was taken; None where that cannot be told."""
    calibration, origin = subject.calibration, subject.segments.t_open.value
    times = [subject.log[name].time for name in observed.names if name in subject.log]
    if calibration is None or origin is None or not times or not (calibration.oxidizer_mass.value or 0.0) > 0.0:
        return None
    largest = {channel.name: float(np.abs(channel.value).max()) for channel in observed.channels}
    noise = [std / largest[name] for name, std in noise_of(observed).items() if largest[name] > 0.0]
    found = Conditions(
        rate=float(np.median([1.0 / np.median(np.diff(time)) for time in times])),
        rest=float(max(origin - time[0] for time in times)),
        noise=float(np.median(noise)),
        load=calibration.oxidizer_mass.value or 0.0,
        lacks=tuple(name for name in CHANNELS if name not in observed.names),
    )
    return found if all(x > 0.0 and np.isfinite(x) for x in found.numbers.values()) else None


def tried_on(conditions: Conditions | None, known: Sequence[Row]) -> TriedOn | None:
    """What was found on tests like one, whether it is outside of all that was tried, and how often a sure statement
    was wrong in the world where that was most often so; None where its conditions are not known."""
    if conditions is None:
        return None
    ranges = {name: [row.conditions.numbers[name] for row in known] for name in WORDS}
    scales = {name: max(log(max(all_of) / min(all_of)), 1e-9) for name, all_of in ranges.items()}
    near = sorted(known, key=lambda row: row.conditions.far(conditions, scales))[:NEAREST]
    sure = [row for row in near if row.sure]
    beyond = tuple(
        _beyond(name, conditions.numbers[name], min(all_of), max(all_of))
        for name, all_of in ranges.items()
        if _outside(name, conditions.numbers[name], min(all_of), max(all_of))
    )
    tried = {name for row in known for name in row.conditions.lacks}
    if alone := [name for name in conditions.lacks if name not in tried]:
        beyond = (*beyond, f"none without {listed(alone)} was tried")
    return TriedOn(
        rate=conditions.rate, rest=conditions.rest, noise=conditions.noise, load=conditions.load, like=len(near),
        sure=len(sure), right=sum(row.right for row in sure), outside=beyond, misled=_worst(known) if beyond else 0.0,
    )  # fmt: skip


WORSE = {"rate": (True, False), "rest": (True, False), "noise": (False, True), "load": (True, True)}
"""Whether less than the least of a condition, and more than the most, is outside: more samples, more rest and less
noise can be made those that were tried by leaving out and adding."""


def _outside(name: str, value: float, least: float, most: float) -> bool:
    below, above = WORSE[name]
    return (below and value < least / BEYOND) or (above and value > BEYOND * most)


def _beyond(name: str, value: float, low: float, high: float) -> str:
    words, unit, form = WORDS[name]
    own, least, most = (f"{(100.0 if unit == '%' else 1.0) * x:{form}}" for x in (value, low, high))
    return f"{own}{f' {unit}' if unit else ''} {words}, tried with {least} to {most}"


def _worst(known: Sequence[Row]) -> float:
    """Share [-] of sure statements that were wrong in the world in which that is largest, each world's counted with
    AVERAGE more that are wrong as often as those of all worlds."""
    sure = [row for row in known if row.sure]
    if not sure:
        return 1.0
    wrong = sum(not row.right for row in sure) / len(sure)
    by_world = [[not row.right for row in sure if row.world == world] for world in {row.world for row in sure}]
    return max((sum(of) + AVERAGE * wrong) / (len(of) + AVERAGE) for of in by_world)


def mixed(posterior: Mapping[str, float], misled: float) -> dict[str, float]:
    """The probabilities where evidence misleads in a share ``misled`` [-] of tests: there they are those that labels
    have before a test.

    >>> {label: round(p, 3) for label, p in mixed({"none": 0.0, "a": 1.0, "unknown": 0.0}, 0.2).items()}
    {'none': 0.05, 'a': 0.92, 'unknown': 0.03}
    """
    names = max(sum(kind(label) == "named" for label in posterior), 1)
    before = {label: BEFORE[kind(label)] / (names if kind(label) == "named" else 1) for label in posterior}
    total = sum(before.values())
    return {k: (1.0 - misled) * p + misled * before[k] / total for k, p in posterior.items()}


def tried_sentences(product: Diagnosis) -> list[str]:
    """How far the answer can be believed on such a stand."""
    found = product.tried_on
    if found is None:
        return []
    if found.outside:
        return [
            f"This test is outside of the simulated ones on which the diagnosis was tried: {'; '.join(found.outside)}.",
            f"So every probability counts that in the worst of those worlds {100.0 * found.misled:.0f} % of sure "
            "statements were wrong.",
        ]
    if product.verdict == "none" or not found.sure:
        return []
    return [
        f"Of {found.sure} statements above {SET:g} on the {found.like} simulated tests most like this one "
        f"{found.right} were right."
    ]
