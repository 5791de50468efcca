"""What a channel's health makes of the numbers that rest on it: doubted, with the reason in the same line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from hfanalysis.health.rests_on import TOGETHER, channels_of, concerns
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.health import HEALTHY, TRUSTED, UNUSABLE, Finding, Health
from hfanalysis.products.model import Part, Product
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import DOUBTED, NOT_IDENTIFIABLE, UNPHYSICAL, Quantity
from hfanalysis.sentences import joined, text

P = TypeVar("P", bound=Part)
NEAR = 1.0
"""[s] about an event in which a stretch may have moved it. Evidence: ignition is late by a second at most, and the
searches look at less."""
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
    if isinstance(product, Diagnosis):
        return product.but(warnings=tuple(dict.fromkeys((*product.warnings, *health.warnings))))
    together = isinstance(product, Calibration) and product.oxidizer_mass_fitted is not None
    return _part(product, product.file + TOGETHER * together, health)


def _events(product: Segments, health: Health) -> Segments:
    """The events, each with the doubts about what was found near it."""
    origin, changes = product.t_open.value, {}
    for name, event in product.quantities.items():
        after = 0.0 if name == "t_open" else event.value
        instant = None if origin is None or after is None else origin + after
        changes[name] = with_doubt(event, list(reasons(product.file, name, event, health, instant)))
    return product.but(**changes)


def _part(part: P, product: str, health: Health) -> P:
    """A part of a product, and what is in it."""
    changes = {name: _value(name, value, product, health) for name, value in part.content.items()}
    return part.but(**{name: new for name, new in changes.items() if new is not getattr(part, name)})


def _value(name: str, value: Any, product: str, health: Health) -> Any:
    if isinstance(value, Quantity):
        return with_doubt(value, list(reasons(product, name, value, health)))
    if isinstance(value, Part):
        return _part(value, product, health)
    if isinstance(value, Mapping) and any(isinstance(inner, (Quantity, Part)) for inner in value.values()):
        return {key: _value(key, inner, product, health) for key, inner in value.items()}
    return value


def reasons(
    product: str, name: str, quantity: Quantity, health: Health, instant: float | None = None
) -> Iterator[tuple[bool, str]]:
    """Why a quantity of a product is doubted (True), or what the engineer overruled (False): sentences.

    Channels that the same is said of stand in one. Of an event, ``instant`` is when it is [s, log time].
    """
    whose: dict[tuple[bool, str, str], list[str]] = {}
    for channel in channels_of(product, name, quantity):
        trust = health.of(channel).trust
        for finding in health.of(channel).findings:
            if finding.verdict == HEALTHY or not concerns(product, name, finding.kind):
                continue
            if instant is not None and not _near(finding, instant):
                continue
            if trust or finding.verdict != UNUSABLE or _in_firing(finding, health):
                whose.setdefault((not trust, trust or "", _words(finding)), []).append(channel)
    for (doubt, trust, words), names in whose.items():
        trusted = f"{TRUSTED}{trust}) against" if trust else ""
        yield doubt, text("{names}{trusted} {words}", names=", ".join(names), trusted=trusted, words=words)


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


def _words(finding: Finding) -> str:
    left = ", left out" if finding.verdict == UNUSABLE else ""
    return text("({kind}{left}): {evidence}", kind=finding.kind.replace("_", " "), left=left, evidence=finding.evidence)


def with_doubt(quantity: Quantity, why: list[tuple[bool, str]]) -> Quantity:
    """A quantity with these reasons beside it; doubted where one of them is a doubt, unless it is worse already."""
    if not why:
        return quantity
    said = list(dict.fromkeys(words for _, words in why))
    if quantity.value is None:
        if quantity.verdict not in WORSE:
            return quantity
        return replace(quantity, reason=joined("; ", [str(quantity.reason), *said]))
    doubt = any(is_doubt for is_doubt, _ in why) and quantity.verdict not in WORSE
    told = [quantity.why] if quantity.why else []
    # what makes a number doubtful, or the engineer vouch for it, comes before where it is from
    line = joined("; ", [*told, *said] if quantity.verdict in WORSE else [*said, *told])
    return replace(quantity, verdict=DOUBTED if doubt else quantity.verdict, why=line)
