"""Whether the numbers of a test keep the team's own limits (:mod:`hfanalysis.record.limits`).

A number that is missing or doubted neither keeps nor breaks a rule, nor does one whose 95 % interval holds the limit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.flight import Flight
from hfanalysis.products.validation import Column, Validation
from hfanalysis.quantity import DOUBTED, Quantity
from hfanalysis.record.limits import FILE, Rule
from hfanalysis.report.material import Material
from hfanalysis.units import parse, parse_as
from hfanalysis.wording.numbers import in_words, shown

KEPT, BROKEN, OPEN = "kept", "broken", "open"
"""What becomes of a rule; open where the numbers do not tell."""


class Judged(NamedTuple):
    """A rule's outcome: what was held against what, and why it is open where it is."""

    state: str
    name: str
    words: str


@dataclass(frozen=True)
class Limit:
    """A bound [unit of the quantity] with what it is called; ``above``: whether the quantity may not be below it."""

    at: float
    above: bool
    words: str


def known_quantities() -> tuple[str, ...]:
    """The names that a rule may have: those of calibration.json, of what was measured, and of flight.json."""
    models = (Calibration, Column, Flight)
    return tuple(name for model in models for name, field in model.model_fields.items() if field.annotation is Quantity)


def judged(material: Material) -> list[Judged]:
    """The outcome of every rule, in the order of the file. Raises InputError for a limit in a unit of another kind."""
    return [_judged(rule, material) for rule in material.rules]


def _judged(rule: Rule, material: Material) -> Judged:
    name, found = in_words(rule.quantity), quantities(material).get(rule.quantity)
    if found is None or found.value is None:
        return Judged(
            OPEN, name, f"not known: {found.reason if found is not None else 'no product of this test has it'}"
        )
    has = shown(replace(found, std=None, ci95=None), name=rule.quantity).with_unit
    if found.verdict == DOUBTED:
        return Judged(OPEN, name, f"{has} is doubted: {found.why}" if found.why else f"{has} is doubted")
    limits = list(_limits(rule, found, material))
    if not limits:
        return Judged(OPEN, name, f"{has}, and there is no last time to compare it with")
    states = {_state(found, limit) for limit in limits}
    state = next(s for s in (BROKEN, OPEN, KEPT) if s in states)
    rest = "; its 95 % interval holds the limit" if state == OPEN else ""
    return Judged(state, name, f"{has}, limit {' and '.join(dict.fromkeys(limit.words for limit in limits))}{rest}")


def _state(found: Quantity, limit: Limit) -> str:
    assert found.value is not None
    low, high = found.interval or (found.value, found.value)
    if low < limit.at < high:
        return OPEN
    return KEPT if (found.value >= limit.at) == limit.above or found.value == limit.at else BROKEN


def _limits(rule: Rule, found: Quantity, material: Material) -> Iterator[Limit]:
    for key, text, above in (("min", rule.min, True), ("max", rule.max, False)):
        if text is not None:
            at = parse_as(text, found.unit, f"{FILE}, {rule.quantity}.{key}")
            yield Limit(at, above, f"{key} {text}")
    last = _last(rule.quantity, material) if rule.within is not None else None
    if rule.within is not None and last is not None and last.value is not None:
        share = parse(rule.within, "dimensionless", f"{FILE}, {rule.quantity}.within").value
        was = shown(replace(last, std=None, ci95=None), name=rule.quantity).with_unit
        words = f"{rule.within} of {was} last time"
        yield Limit(last.value - share * abs(last.value), True, words)
        yield Limit(last.value + share * abs(last.value), False, words)


def _last(name: str, material: Material) -> Quantity | None:
    if material.last is None:
        return None
    return quantities(replace(material, products=material.last.products, last=None)).get(name)


def quantities(material: Material) -> dict[str, Quantity]:
    """What rules are held against [SI], by name."""
    calibration, validation, flight = material.get(Calibration), material.get(Validation), material.get(Flight)
    out: dict[str, Quantity] = {}
    if flight is not None:
        out |= flight.quantities
    if validation is not None:
        out |= validation.performance.measured.quantities
    return out | (calibration.quantities if calibration is not None else {})
