"""What the test identifies, what it does not, and what looks wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from markupsafe import Markup

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import KINDS, Health
from hfanalysis.products.ingest import Ingest
from hfanalysis.quantity import (
    CONDITIONAL,
    DERIVED,
    DOUBTED,
    IDENTIFIED,
    NOT_IDENTIFIABLE,
    STATED,
    UNPHYSICAL,
    Quantity,
)
from hfanalysis.record.flag_notes import of_one, with_flag
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.names import called
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording import numbers as wording
from hfanalysis.wording.numbers import in_words, listed


class Group(NamedTuple):
    """Quantities of some verdicts: how their sentence begins, their head in the list, and their mark."""

    verdicts: tuple[str, ...]
    lead: str
    head: str
    mark: str


GROUPS = {
    "identified": Group((IDENTIFIED,), "Identified", "Identified", "good"),
    "doubted": Group((DOUBTED,), "Doubted, for what a sensor shows", "Doubted", "doubt"),
    "conditional": Group((CONDITIONAL,), "Conditional, for the reasons below", "Conditional", "doubt"),
    "known": Group((DERIVED, STATED), "Derived from others, or stated", "Derived or stated", "good"),
    "bad": Group((UNPHYSICAL,), "Outside its physical range", "Outside its physical range", "bad"),
    "open": Group((NOT_IDENTIFIABLE,), "Not identifiable from this test", "Not identified", "open"),
}
"""What the verdict sorts by; a quantity without a verdict is open."""


def render(material: Material) -> Iterator[Block]:
    """A sentence, and a list for each of GROUPS."""
    yield html.paragraph(sentence(material), "lead")
    yield Markup('<div class="findings">{}</div>').format(Markup().join(_findings(material)))


def sentence(material: Material) -> str:
    """The verdict in a few sentences."""
    if not material.fired:
        return "No firing was found in this log, so there is nothing to calibrate."
    if not material.has("calibration"):
        return " ".join(["This test could not be calibrated; the reason is given below.", *_sensor_sentence(material)])
    groups = by_group(material)
    parts = [f"{GROUPS[group].lead}: {listed(list(map(in_words, found)))}." for group, found in groups.items() if found]
    nothing = [] if groups["identified"] or groups["doubted"] else ["Nothing could be identified."]
    return " ".join([*nothing, *parts, *_sensor_sentence(material)])


def _sensor_sentence(material: Material) -> list[str]:
    """What is found of the channels, in a sentence of its own."""
    found = [
        f"{listed(list(map(called, d.channels)))} {KINDS[d.finding.kind]}" for d in material.reasons if not d.trust
    ]
    return [f"Sensors: {'; '.join(dict.fromkeys(found))}."] if found else []


def by_group(material: Material) -> dict[str, dict[str, Quantity]]:
    """What a calibration is asked for first [SI], by how far it can be trusted: one of GROUPS each."""
    calibration = material.get(Calibration)
    out: dict[str, dict[str, Quantity]] = {group: {} for group in GROUPS}
    found = calibration.quantities if calibration is not None else {}
    for name, quantity in ((name, found[name]) for name in wording.MASTHEAD if name in found):
        groups = (group for group, kind in GROUPS.items() if quantity.verdict in kind.verdicts)
        out[next(groups, "open")][name] = quantity
    return out


def _findings(material: Material) -> Iterator[Markup]:
    for group, found in by_group(material).items():
        if found:
            kind = GROUPS[group]
            items = (_judged(*one) for one in _by_reason(found, group, material))
            yield _finding(kind.mark, kind.head, items)
    reasons = [_reason(number, doubt.sentence) for number, doubt in enumerate(material.reasons, 1)]
    logged, others = warnings(material)
    if reasons or logged:
        yield _finding("sensor", "Sensors and log", [*reasons, *map(html.switchable, logged)])
    elif material.log.channels:
        yield _finding("good", "Sensors and log", [Markup("Nothing looks wrong with the sensors.")])
    if others:
        yield _finding("open", "To bear in mind", map(html.switchable, others))


def _finding(kind: str, head: str, items: Any) -> Markup:
    block = '<div class="finding {}"><h3><span class="sign" aria-hidden="true">{}</span>{}</h3>{}</div>'
    return Markup(block).format(kind, html.MARKS[kind], head, html.bullets(items, "plain"))


def _reason(number: int, sentence: str) -> Markup:
    """Why a channel is doubted, where the marks of that number lead."""
    item = Markup('<span id="{}" class="reason">[{}]</span> {}')
    return item.format(html.reason_id(number), number, html.switchable(sentence))


def _by_reason(
    found: Mapping[str, Quantity], group: str, material: Material
) -> list[tuple[Markup, dict[str, Quantity]]]:
    """The quantities with their reason, those together that have the same one."""
    if group == "identified":
        return [(Markup(), {name: quantity}) for name, quantity in found.items()]
    groups: dict[Markup, dict[str, Quantity]] = {}
    for name, quantity in found.items():
        groups.setdefault(html.remark(quantity, material.reasons), {})[name] = quantity
    return list(groups.items())


def _judged(why: Markup, found: Mapping[str, Quantity]) -> Markup:
    names = Markup().join(_named(name, quantity) for name, quantity in found.items())
    return names + (Markup('<details class="why"><summary>why</summary>{}</details>').format(why) if why else Markup())


def _named(name: str, quantity: Quantity) -> Markup:
    number = Markup()
    if quantity.value is not None:
        number = Markup('<span class="judged">{}</span>').format(html.value(quantity, name))
    return Markup('<span class="names">{}{}</span>').format(html.symbol_and_words(name), number)


def warnings(material: Material) -> tuple[list[str], list[str]]:
    """What the products warn of beside the channels' health, each once: of the log, and of the rest."""
    said = {str(doubt.sentence) for doubt in material.reasons}
    others = [
        text
        for product in reversed(list(material.products.values()))
        if not isinstance(product, (Ingest, Health))
        for text in product.warned
        if text not in said
    ]
    logged = list(dict.fromkeys(_logged(material.get(Ingest))))
    return logged, list(dict.fromkeys([*others, *material.definition.warnings]))


def _logged(ingest: Ingest | None) -> list[str]:
    """What the ingest warns of; flagged samples of single channels in one line for each flag, after all else."""
    if ingest is None:
        return []
    flagged = {
        with_flag(of_one(name, f"{share} samples"), flag): (flag, f"{name} ({share})")
        for name, channel in ingest.channels.items()
        for flag, share in ((flag, f"{count} of {channel.samples}") for flag, count in channel.flags.items())
    }
    by_flag: dict[str, list[str]] = {}
    for flag, samples in (flagged[words] for words in ingest.warnings if words in flagged):
        by_flag.setdefault(flag, []).append(samples)
    together = [f"samples flagged {flag}: {listed(samples)}" for flag, samples in by_flag.items()]
    return [words for words in ingest.warnings if words not in flagged] + together


SECTION = Section("What the test identifies", 13, (), render)
