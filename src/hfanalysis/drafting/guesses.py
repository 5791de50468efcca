"""What a column probably is: what its name, its unit, its shape and its size say, added up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from hfanalysis.drafting.columns import Column
from hfanalysis.drafting.labels import as_meant, dimension
from hfanalysis.drafting.shapes import Shape
from hfanalysis.drafting.sizes import AT_AIR, Fit, units_for
from hfanalysis.drafting.words import Said, read
from hfanalysis.record.channels import CANONICAL
from hfanalysis.units import unit_factor

PLACED, NAMED, ALIKE = 5.0, 2.5, 1.0
"""Points for a channel: name or unit say what and where; only where; only what. Evidence: two shapes that agree (2
each) must not outvote a name that says both."""
NEAREST, NEARER = {"inj", "injector", "man", "mani", "manifold", "thrust"}, 0.25
"""Words for the very place that a channel stands for (the line's pressure is the injector's), and their points."""
UNIT = 1.5
"""Points for a stated unit that fits the channel. Evidence: less than a shape (2), for a logger's unit can be wrong."""
POSSIBLE = 0.5
"""Points for readings of a possible size; taken off where the stated unit makes them impossible. Evidence: a gauge that
reads wild values is still the gauge that its name says."""
LEAST = 2.0
"""Points from which on a guess is worth its line. Evidence: a shape alone has 2, one word alone 1."""

STATED_WEIGHS = 3.0
"""Votes on the unit of the others that a stated unit has. Evidence: a guess of a unit is right in two of three columns
of published logs."""
ONE_UNIT, ODD_UNIT = ("pressure", "temperature"), 1.0
"""Dimensions that a logger writes in one unit, and the points that another unit costs. Evidence: a cell that ends at
0.08 kg was taken for a tank in MPa beside three pressures in psi."""

_PLACES = {
    "pressure": {"tank": "p_tank", "run": "p_run", "chamber": "p_chamber", "purge": "p_purge", "fill": "p_fill"},
    "temperature": {"tank": "T_tank", "run": "T_run", "chamber": "T_chamber"},
    "mass": {"tank": "m_tank", "run": "m_tank", "run tank": "m_tank"},
    "force": {"": "thrust", "chamber": "thrust"},
}
"""What is measured -> where -> channel."""

_SHAPES: dict[str, dict[str, float]] = {
    "p_tank": {"falls": 2.0, "fills": 2.0, "wanders": 0.5, "pulse": -1.0, "rises": -1.0, "dip": -0.5},
    "m_tank": {"falls": 2.0, "fills": 2.0, "wanders": 0.5, "pulse": -1.0, "rises": -1.0},
    "p_run": {"pulse": 2.0, "fills": 0.5, "falls": -0.5, "wanders": 0.5, "rises": 0.5},
    "p_chamber": {"pulse": 2.0, "falls": -1.5, "fills": -1.0, "rises": -0.5},
    "thrust": {"pulse": 2.0, "dip": 1.0, "falls": -0.5, "fills": -1.0},
    "p_purge": {"falls": 0.5, "fills": -0.5, "wanders": 0.5, "noise": 0.5},
    "p_fill": {"noise": 0.5, "wanders": 0.5, "falls": 0.5},
    "T_tank": {"falls": 0.5, "wanders": 0.5, "fills": 0.5, "state": 0.0, "clock": 0.0},
    "T_run": {"falls": 0.5, "wanders": 0.5, "state": 0.0, "clock": 0.0},
    "T_chamber": {"rises": 1.0, "pulse": 0.5, "wanders": 0.5, "state": 0.0, "clock": 0.5},
    "valve": {"state": 2.0, "pulse": 1.0},
}
"""Channel that is guessed -> what a shape says for it (or against it); others are named by who knows them.
Evidence: test_survey.py, columns without names."""
_LIFELESS = {"constant": -2.0, "noise": -1.5, "empty": -5.0, "clock": -3.0, "state": -2.0, "dip": -1.0}
"""What other shapes say against any channel. Evidence: test_words.py, a dead column beside a living one."""


@dataclass(frozen=True)
class Guess:
    """A channel that a column may be. ``unit``: stated, or the likeliest one; ``units`` those beside it; ``certain``:
    name and stated unit say so together.
    """

    channel: str
    points: float
    reasons: tuple[str, ...]
    unit: str = ""
    units: tuple[str, ...] = ()
    certain: bool = False
    gauge: bool = False


@dataclass(frozen=True)
class Judged:
    """A column with its shape, what its name says, and the guesses, the likeliest first; ``remark``: what else there is
    to say about it.
    """

    column: Column
    shape: Shape
    said: Said
    guesses: tuple[Guess, ...] = ()
    remark: str = ""
    rate: float | None = field(default=None, compare=False)

    @property
    def best(self) -> Guess | None:
        """The likeliest guess, None where there is none."""
        return self.guesses[0] if self.guesses else None


def judged(column: Column, shape: Shape, name: str = "") -> Judged:
    """A column with its guesses; ``name`` stands for its own where that says nothing (the file's)."""
    said = next(
        (one for part in (column.name.rpartition(".")[2], column.name, name) if (one := read(part)).words), Said()
    )
    named = _by_name(said, column.unit)
    found = [_guess(channel, named, said, column, shape) for channel in _SHAPES if _possible(channel, said, column)]
    least = {channel: ALIKE if points >= NAMED else LEAST for channel, points in named.items()}
    kept = [one for one in found if one is not None and one.points >= least.get(one.channel, LEAST)]
    kept.sort(key=lambda one: -one.points)
    remark = "" if kept or not said.words else f"{_whose(said)}, by its name ({_capitals(said)})"
    return Judged(column, shape, said, tuple(kept), remark)


_KINDS = {
    "": "a column",
    "cell": "a load cell",
    "electric": "volts, counts or current",
    "flow": "a flow (none is read: the model finds it)",
    "other": "no channel of a stand",
    "state": "a state of the stand",
}


def _whose(said: Said) -> str:
    """What a column measures where no channel is meant."""
    where = {"": "", "fuel": " of the fuel", "run tank": " of the oxidizer's tank or line"}.get(
        said.place, f" at {said.place}"
    )
    return _KINDS.get(said.quantity, f"a {said.quantity}") + where


def _capitals(said: Said) -> str:
    return ", ".join(word.upper() for word in said.words)


def _measured(said: Said, unit: str) -> str:
    """What is measured, by the name and the unit; "?" where they contradict each other."""
    by_unit = dimension(unit)
    if not said.quantity or not by_unit:
        return "mass" if said.quantity == "cell" and said.place in ("tank", "run", "run tank") else (
            "force" if said.quantity == "cell" and said.place == "chamber" else said.quantity or by_unit)  # fmt: skip
    if said.quantity == "cell":
        return _of_cell(said, by_unit)
    return said.quantity if said.quantity == by_unit or as_meant(unit, said.quantity) else "?"


def _of_cell(said: Said, by_unit: str) -> str:
    """A cell weighs the tank and pushes against the chamber, in pounds or kilograms of either sort."""
    if by_unit not in ("force", "mass"):
        return "electric" if by_unit in ("voltage", "dimensionless") else "?"
    return {"tank": "mass", "run tank": "mass", "run": "mass", "chamber": "force"}.get(said.place, by_unit)


def _by_name(said: Said, unit: str) -> Mapping[str, float]:
    """Channel -> points by its name, and by what the unit adds to it."""
    what = _measured(said, unit)
    places = _PLACES.get(what, {})
    if what == "valve":
        return {"valve": PLACED if said.main or (not said.place and not said.silent) else ALIKE}
    if said.place == "run tank" and what in ("pressure", "temperature"):
        return {places["tank"]: NAMED, places["run"]: NAMED}
    if said.place in places and (what == "force" or said.place):
        return {places[said.place]: (PLACED if said.sure else NAMED) + NEARER * bool(set(said.words) & NEAREST)}
    if not what and said.place == "run tank":
        return {"p_tank": NAMED, "p_run": NAMED, "m_tank": ALIKE}
    if not what and said.place:
        return {where[said.place]: NAMED for kind, where in _PLACES.items() if said.place in where and kind != "force"}
    if said.place or what == "?":
        return {}
    return dict.fromkeys(places.values(), ALIKE) | ({"thrust": ALIKE, "m_tank": ALIKE} if what == "cell" else {})


def _possible(channel: str, said: Said, column: Column) -> bool:
    """Whether neither name nor unit speak against a channel."""
    what, quantity = _measured(said, column.unit), CANONICAL[channel]
    if channel == "valve":
        return what == "valve"
    if column.unit and not as_meant(column.unit, quantity):
        return False
    if said.place and not what:
        return channel in _by_name(said, column.unit)
    if said.place and channel not in _by_name(said, column.unit):
        return False
    return what in ("", quantity) or (what == "cell" and quantity in ("force", "mass"))


def _guess(channel: str, named: Mapping[str, float], said: Said, column: Column, shape: Shape) -> Guess | None:
    stated = as_meant(column.unit, CANONICAL[channel]) if column.unit else ""
    fits = units_for(channel, shape, stated)
    if not fits and named.get(channel, 0.0) < (NAMED if stated else PLACED):
        return None
    points = named.get(channel, 0.0) + _of_shape(channel, shape) + (UNIT if stated else 0.0)
    points += POSSIBLE + fits[0].points if fits else -POSSIBLE
    certain = named.get(channel, 0.0) >= PLACED and bool(stated or channel == "valve")
    return Guess(
        channel, points, tuple(_reasons(channel, named, said, column, shape, fits)),
        stated or (fits[0].unit if fits else ""), tuple(fit.unit for fit in fits[1:]), certain,
        bool(fits) and fits[0].gauge,
    )  # fmt: skip


def _of_shape(channel: str, shape: Shape) -> float:
    return _SHAPES[channel].get(shape.word, _LIFELESS.get(shape.word, 0.0))


def _reasons(
    channel: str, named: Mapping[str, float], said: Said, column: Column, shape: Shape, fits: tuple[Fit, ...]
) -> list[str]:
    """What speaks for a guess, in words, and what against it."""
    reasons = [f"by its name ({_capitals(said)})"] if named.get(channel) else []
    reasons += [f"in {column.unit}"] if column.unit and CANONICAL[channel] != "dimensionless" else []
    merit = _of_shape(channel, shape)
    reasons += [shape.words] if merit > 0.0 else [f"though it {_verb(shape)}"] if merit < 0.0 else []
    reasons += [fits[0].reason] if fits and fits[0].reason else []
    reasons += [] if fits else [f"though {shape.high:.4g} {column.unit} is no size for it".replace("  ", " ")]
    return reasons


def _verb(shape: Shape) -> str:
    return {"noise": "shows nothing but noise", "empty": "has no numbers"}.get(shape.word, shape.words)


def agreed(found: list[Judged]) -> list[Judged]:
    """Units that are not stated, as the other columns of a test have theirs: a logger writes all pressures in one."""
    votes: dict[str, dict[tuple[float, float], float]] = {}
    for one in found:
        if one.best is not None and one.best.unit and CANONICAL[one.best.channel] in ONE_UNIT:
            units = votes.setdefault(CANONICAL[one.best.channel], {})
            weight = one.best.points * (STATED_WEIGHS if one.column.unit else 1.0)
            units[_size(one.best, one.best.unit)] = units.get(_size(one.best, one.best.unit), 0.0) + weight
    most = {dimension: max(units, key=lambda unit: units[unit]) for dimension, units in votes.items()}
    return [one if one.column.unit else _sorted(one, [_in_unit(guess, most) for guess in one.guesses]) for one in found]


def _size(guess: Guess, unit: str) -> tuple[float, float]:
    """What tells a unit from others, gauge or absolute alike [SI]."""
    return unit_factor(unit, CANONICAL[guess.channel], "")


def _in_unit(guess: Guess, most: Mapping[str, tuple[float, float]]) -> Guess:
    """A guess in the unit of the others; one that cannot be in it is the less likely."""
    dimension = CANONICAL[guess.channel]
    if dimension not in most or not guess.unit or _size(guess, guess.unit) == most[dimension]:
        return guess
    unit = next((unit for unit in guess.units if _size(guess, unit) == most[dimension]), "")
    if not unit:
        return replace(guess, points=guess.points - ODD_UNIT)
    others = tuple(one for one in (guess.unit, *guess.units) if one != unit)
    reasons = (*guess.reasons, f"in {unit} as the other {dimension}s")
    return replace(guess, unit=unit, units=others, gauge=False, reasons=reasons)


def _sorted(one: Judged, guesses: list[Guess]) -> Judged:
    return replace(one, guesses=tuple(sorted(guesses, key=lambda guess: -guess.points)))


def apart(found: list[Judged]) -> list[Judged]:
    """Of pressures without a name that rise with the firing the higher is the line's, the lower the chamber's; beside
    such as rest at the open air, what rests at zero is no pressure.
    """
    pulses = [one for one in found if one.shape.word == "pulse" and not one.said.place and _both(one)]
    in_air = [one for one in pulses if any(AT_AIR in reason for reason in one.guesses[0].reasons)]
    if len(in_air) < 2:
        return found
    highest = max(in_air, key=lambda one: one.shape.plateau)
    leaning = {id(one): "p_run" if one is highest else "p_chamber" for one in in_air}
    no_pressures = {id(one) for one in pulses} - set(leaning)
    return [
        _leaning(one, leaning[id(one)]) if id(one) in leaning else _no_pressure(one) if id(one) in no_pressures else one
        for one in found
    ]


def _both(one: Judged) -> bool:
    return {"p_run", "p_chamber"} <= {guess.channel for guess in one.guesses}


def _no_pressure(one: Judged) -> Judged:
    less = {guess.channel: 1.0 if CANONICAL[guess.channel] == "pressure" else 0.0 for guess in one.guesses}
    return _sorted(one, [replace(guess, points=guess.points - less[guess.channel]) for guess in one.guesses])


def _leaning(one: Judged, channel: str) -> Judged:
    reason = f"the {'highest' if channel == 'p_run' else 'lower'} of the pressures that rise with the firing"
    lean = [
        replace(guess, points=guess.points + 0.5, reasons=(*guess.reasons, reason))
        if guess.channel == channel
        else guess
        for guess in one.guesses
    ]
    return _sorted(one, lean)
