"""What a channel's health makes of the numbers that rest on it: doubted, with the reason in the same line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from hfanalysis.health.reasons import Doubt, reasons
from hfanalysis.health.rests_on import TOGETHER, channels_of, concerns, power_of_time, rests
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import HEALTHY, UNUSABLE, Finding, Health
from hfanalysis.products.model import Part, Product
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import DOUBTED, NORMAL_95, NOT_IDENTIFIABLE, UNPHYSICAL, Quantity
from hfanalysis.sentences import joined

P = TypeVar("P", bound=Part)
NEAR = 1.0
"""[s] about an event in which a stretch may have moved it. Evidence: ignition is late by a second at most, and the
searches look at less."""
ONLY_WARNED = "diagnosis.json"
"""A product whose quantities are not doubted one by one: what it weighs, it weighs with the doubts in."""
WORSE = (NOT_IDENTIFIABLE, UNPHYSICAL)
"""Verdicts that a doubt does not replace."""


def doubted(product: Product, health: Health) -> Product:
    """A product whose quantities say where they rest on a channel that is not healthy, or that is trusted all the same.

    Everything else is as it was.
    """
    if all(channel.verdict == HEALTHY and not channel.trust for channel in health.channels.values()):
        return product
    if isinstance(product, Segments):
        return _events(product, health)
    if product.file == ONLY_WARNED:
        return product.but(warnings=tuple(dict.fromkeys((*product.warnings, *health.warnings))))
    together = isinstance(product, Calibration) and product.oxidizer_mass_fitted is not None
    return _part(product, product.file + TOGETHER * together, health)


def _events(product: Segments, health: Health) -> Segments:
    """The events, each with the doubts about what was found near it."""
    origin, changes = product.t_open.value, {}
    for name, event in product.quantities.items():
        after = 0.0 if name == "t_open" else event.value
        instant = None if origin is None or after is None else origin + after
        changes[name] = asked(event, product.file, name, health, instant)
    return product.but(**changes)


def _part(part: P, product: str, health: Health) -> P:
    """A part of a product, and what is in it."""
    changes = {name: _value(name, value, product, health) for name, value in part.content.items()}
    return part.but(**{name: new for name, new in changes.items() if new is not getattr(part, name)})


def _value(name: str, value: Any, product: str, health: Health) -> Any:
    if isinstance(value, Quantity):
        return asked(value, product, name, health)
    if isinstance(value, Part):
        return _part(value, product, health)
    if isinstance(value, Mapping) and any(isinstance(inner, (Quantity, Part)) for inner in value.values()):
        # of a number by law, which is no name, the whole's counts
        names = {key: key if rests(product, key) or not rests(product, name) else name for key in value}
        return {key: _value(names[key], inner, product, health) for key, inner in value.items()}
    return value


def asked(quantity: Quantity, product: str, name: str, health: Health, instant: float | None = None) -> Quantity:
    """A quantity of a product with the doubts about it; of an event, ``instant`` is when it is [s, log time]."""
    found = _doubts(product, name, quantity, health, instant)
    wider = _wider(quantity, product, name, [doubt.finding for doubt in found if not doubt.trust])
    return with_doubts(wider, found)


def _doubts(product: str, name: str, quantity: Quantity, health: Health, instant: float | None) -> list[Doubt]:
    """The reasons that concern a channel that a quantity rests on."""
    rest = channels_of(product, name, quantity)
    found = [doubt for doubt in reasons(health.channels) if set(rest) & set(doubt.channels)]
    return [doubt for doubt in found if concerns(product, name, doubt.finding.kind)
            and (not doubt.trust if quantity.value is None else _counts(doubt, health, instant))]  # fmt: skip


def _counts(doubt: Doubt, health: Health, instant: float | None) -> bool:
    """Whether a reason is one of those that a number of its channel, or an event at an instant [s], has to do with."""
    if instant is not None and not _near(doubt.finding, instant):
        return False
    return bool(doubt.trust) or doubt.finding.verdict != UNUSABLE or _in_firing(doubt.finding, health)


def _near(finding: Finding, instant: float) -> bool:
    """Whether an event's search may have looked at a stretch."""
    start, end = finding.span
    return start - NEAR <= instant <= end + NEAR


def _in_firing(finding: Finding, health: Health) -> bool:
    """Whether a stretch that is left out is one of the firing, and not all of the channel."""
    if finding.whole or health.firing is None:
        return not finding.whole
    (start, end), (first, last) = finding.span, health.firing
    return start < last and end > first


def _wider(quantity: Quantity, product: str, name: str, findings: Sequence[Finding]) -> Quantity:
    """A quantity with what late and mistimed channels may mean for it in its deviation and interval.

    Offsets and factors are in it already: they are in the accuracy of the log that it was made from.
    """
    if quantity.value is None:
        return quantity
    late = [finding.delay for finding in findings if finding.delay and product == Segments.file]
    paces = [abs(power_of_time(name)) * float(np.log1p(finding.pace)) for finding in findings if finding.pace]
    delay, pace = float(np.linalg.norm(late)), float(np.linalg.norm(paces))
    if delay == pace == 0.0:
        return quantity
    value = quantity.value
    low, high = quantity.interval or (value, value)
    ends = [_stretched(value, value + sign * float(np.hypot(end - value, NORMAL_95 * delay)), sign, pace)
            for sign, end in ((-1.0, low), (1.0, high))]  # fmt: skip
    std = float(np.linalg.norm((quantity.std or 0.0, delay, value * pace)))
    return replace(quantity, std=std, ci95=(ends[0], ends[1]))


def _stretched(value: float, end: float, side: float, pace: float) -> float:
    """The lower or upper (``side`` -1 or 1) end of a value's interval where the value may be off by a factor, too.

    ``pace``: the standard deviation of the factor's logarithm [-]. A factor leaves the sign: a clock that is eight
    hundred times too slow makes no flow negative.
    """
    if value * end <= 0.0:
        return end * float(np.exp(NORMAL_95 * pace))
    own = float(np.log(end / value))
    return value * float(np.exp(np.copysign(side, value * side) * np.hypot(own, NORMAL_95 * pace)))


def with_doubts(quantity: Quantity, found: Sequence[Doubt]) -> Quantity:
    """A quantity with these beside it; doubted where one of them is not overruled, unless it is worse already."""
    if quantity.value is None and quantity.verdict not in WORSE:
        found = [doubt for doubt in found if doubt.finding.verdict == UNUSABLE]
    if not found:
        return quantity
    said = list(dict.fromkeys(doubt.words for doubt in found))
    if quantity.value is None:
        return replace(quantity, reason=joined("; ", [str(quantity.reason), *said]))
    doubted = not all(doubt.trust for doubt in found) and quantity.verdict not in WORSE
    told = [quantity.why] if quantity.why else []
    # what makes a number doubtful, or the engineer vouch for it, comes before where it is from
    line = joined("; ", [*told, *said] if quantity.verdict in WORSE else [*said, *told])
    return replace(quantity, verdict=DOUBTED if doubted else quantity.verdict, why=line)
