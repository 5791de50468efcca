"""Whether what was found or set can be so: events in holes of the log, or set where it shows none; a tank's pressure
that no nitrous oxide has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hfanalysis.quantity import NORMAL_95
from hfanalysis.record.signals import Signal
from hfanalysis.segment.opening import Opening
from hfanalysis.sentences import said, text
from hfanalysis.units import Value

SHOWN_BY = {
    "t_feed": "p_run", "t_v": "p_tank", "t_purge": "p_purge", "t_fuel_out": "p_chamber", "t_fuel_gone": "p_chamber",
    "t_end": "p_chamber",
}  # fmt: skip
"""The channel that an event is looked for in first."""

BESIDE_HOLE = 0.1
"""[s] before or after a hole of that channel in which an event found may be the hole's edge (test_holes.py)."""

BY_HAND = "set by the engineer"
HAND_STD = 1e-3
"""Standard deviation of an instant set by hand without one [s]: it is worked with as it stands."""

IN_TANKS = (8e5, 130e5)
"""Pressure [Pa] of any tank of nitrous oxide at rest, supercharged or not; another one is another unit's. Source: it
saturates at 8 to 72 bar from -45 to 36 degC (CoolProp); above, a tank is supercharged."""


def beside_hole(opening: Opening, signals: Mapping[str, Signal]) -> tuple[Opening, list[str]]:
    """The opening, no surer than the hole of a channel that it was found in or beside; and what there is to say."""
    for name in opening.channels:
        found = signals[name].holes(opening.time - BESIDE_HOLE, opening.time + BESIDE_HOLE) if name in signals else ()
        for start, end in found:
            time, std = anywhere_in(opening.time, opening.std, start, end)
            return replace(opening, time=time, std=std), [lies_in_hole("t_open", name, start, end)]
    return opening, []


def anywhere_in(time: float, std: float, start: float, end: float) -> tuple[float, float]:
    """An instant [s] that may lie anywhere in a hole from ``start`` to ``end`` [s], and its standard deviation [s].

    >>> anywhere_in(1.9, 0.01, 2.0, 3.2)[0]
    2.6
    """
    inside = start < time < end
    return (time if inside else 0.5 * (start + end)), max(std, float((end - start) / np.sqrt(12.0)))


def lies_in_hole(event: str, channel: str, start: float, end: float) -> str:
    """What is said of an event in a hole of its channel, from ``start`` to ``end`` [s]."""
    return f"{event} lies in a hole of {channel}, which has no good samples from {start:.2f} to {end:.2f} s"


def strange_tank(tank: Signal | None) -> list[str]:
    """That the tank's pressure at rest is none of nitrous oxide, where it is none."""
    rest = tank.mean(-2.0, -0.1) if tank is not None else IN_TANKS[0]
    if not np.isfinite(rest) or IN_TANKS[0] <= rest <= IN_TANKS[1]:
        return []
    return [
        text(
            "p_tank reads {rest} before the opening, where a tank of nitrous oxide has {least:.0f} to {most}: is its "
            "unit right?",
            rest=said(rest, "bar", ".4g"),
            least=IN_TANKS[0] / 1e5,
            most=said(IN_TANKS[1], "bar", ".0f"),
        )
    ]


def contradicted(name: str, stated: Value, found: float, std: float) -> list[str]:
    """The warning where an instant set by hand and the one ``found`` [s] lie apart by more than both intervals."""
    if abs(stated.value - found) <= NORMAL_95 * ((stated.std or HAND_STD) + std):
        return []
    words = (
        "{name} is {hand} at {stated:.3f} s, but the log shows it at {found:.3f} +/- {std:.3f} s: what rests on {name} "
        "is worth what the statement is"
    )
    return [text(words, name=name, hand=BY_HAND, stated=stated.value, found=found, std=std)]
