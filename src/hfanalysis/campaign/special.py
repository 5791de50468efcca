"""What sets one test apart from the others of its stand, besides the number that does not fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot

from hfanalysis.products.campaign import TestRow
from hfanalysis.quantity import NORMAL_95, Quantity
from hfanalysis.report.names import called

NUMBERS = {
    "burn_time": ("the longest burn", "the shortest burn"),
    "total_impulse": ("the largest impulse", "the smallest impulse"),
    "peak_chamber_pressure": ("the highest chamber pressure", "the lowest chamber pressure"),
}
"""Measured numbers by which a test may stand out, as people say it."""


def special(test: str, rows: Mapping[str, TestRow]) -> Iterator[str]:
    """In which way a test is the only one of its kind among ``rows``; nothing where it is as the others."""
    own, others = rows[test], [row for name, row in rows.items() if name != test]
    areas = {row.injector_area for row in others}
    if own.injector_area is not None and None not in areas and own.injector_area not in areas:
        yield "the only one with its injector"
    dates = sorted(row.date for row in others if row.date)
    if own.date and dates and not dates[0] <= own.date <= dates[-1]:
        yield "the last test" if own.date > dates[-1] else "the first test"
    for name, (most, least) in NUMBERS.items():
        yield from _beyond(own.performance.get(name), [row.performance.get(name) for row in others], most, least)
    named = set(_effects(own)).difference(*map(_effects, others))
    yield from (f"the only one in which {called(name)} is named" for name in sorted(named))


def _effects(row: TestRow) -> list[str]:
    return [] if row.diagnosis is None else [effect.name for effect in row.diagnosis.effects]


def _beyond(own: Quantity | None, others: list[Quantity | None], most: str, least: str) -> Iterator[str]:
    """Whether a number is beyond those of all others by more than their deviations."""
    known = [q for q in others if q is not None and q.value is not None]
    if own is None or own.value is None or len(known) < len(others) or not known:
        return

    def above(one: Quantity, other: Quantity) -> bool:
        apart = (one.value or 0.0) - (other.value or 0.0)
        return apart > NORMAL_95 * hypot(one.std or 0.0, other.std or 0.0)

    if all(above(own, q) for q in known):
        yield most
    elif all(above(q, own) for q in known):
        yield least
