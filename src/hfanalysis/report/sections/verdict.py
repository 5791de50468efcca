"""The verdict: what is identified, what is not, and what looks wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from markupsafe import Markup

from hfanalysis.health.reasons import marked
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.health import KINDS, TRUSTED, Health
from hfanalysis.products.ingest import Ingest
from hfanalysis.products.validation import Validation
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
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.sections.diagnosis import headline
from hfanalysis.wording import numbers as wording
from hfanalysis.wording.numbers import in_words, listed

KEY_NUMBERS = ("burn_time", "total_impulse", "specific_impulse", "peak_thrust", "peak_chamber_pressure")
"""What is asked for first, where the validation has it."""


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
    """A sentence, the key numbers, and a list for each of GROUPS."""
    yield html.paragraph(sentence(material), "lead")
    yield _diagnosed(material)
    if material.adopted:
        yield html.paragraph(material.adopted)
    for stage, reason in absence_reasons(material).items():
        absent = Markup('<p class="absent"><strong>{}:</strong> {}</p>')
        yield absent.format(stage, html.switchable(reason))
    yield _numbers(key_numbers(material), material)
    yield Markup('<div class="findings">{}</div>').format(Markup().join(_findings(material)))


def _diagnosed(material: Material) -> Markup | None:
    """The first sentence of the diagnosis."""
    diagnosis = material.get(Diagnosis)
    said = headline(diagnosis) if diagnosis else ""
    words = Markup('<p class="lead diagnosed"><a href="#diagnosis">Diagnosis</a>: {}</p>')
    return words.format(html.switchable(said)) if said else None


def absence_reasons(material: Material) -> dict[str, str]:
    """Why there are no phases or no calibration, each reason once."""
    told: dict[str, str] = {}
    for name, words in (("segments", "phases"), ("calibration", "calibration"), ("validation", "validation")):
        if not material.has(name) and name in material.absent and material.absent[name] not in told.values():
            told[words] = material.absent[name]
    return told


def key_numbers(material: Material) -> dict[str, Quantity]:
    """The measured numbers [SI] that come first; where there are none, what the calibration has instead."""
    validation, calibration = material.get(Validation), material.get(Calibration)
    if validation is not None:
        measured = validation.performance.measured.quantities
        if found := {name: measured[name] for name in KEY_NUMBERS if measured[name].value is not None}:
            return found
    flow = calibration.oxidizer_flow_peak if calibration is not None else None
    return {"oxidizer_flow_peak": flow} if flow is not None and flow.value is not None else {}


def _numbers(found: Mapping[str, Quantity], material: Material) -> Markup | None:
    if not found:
        return None
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (item.format(in_words(name), _key_number(name, quantity, material)) for name, quantity in found.items())
    return Markup('<dl class="key-numbers">{}</dl>').format(Markup().join(items))


def _key_number(name: str, quantity: Quantity, material: Material) -> Markup:
    """With a badge where it is doubted, or rests on a channel that the engineer trusts, which says why."""
    number, why = html.value(quantity, name, True), quantity.why or ""
    if quantity.verdict != DOUBTED and TRUSTED not in why:
        return number
    badge = html.verdict(DOUBTED) if quantity.verdict == DOUBTED else Markup("(trusted)")
    numbers, _ = marked(quantity, material.reasons)
    doubt = Markup('{} <span class="doubt" title="{}">{}</span> {}')
    return doubt.format(number, why, badge, html.marks(numbers))


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
    found = [f"{listed(list(d.channels))} {KINDS[d.finding.kind]}" for d in material.reasons if not d.trust]
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
    return names + (Markup('<span class="because">{}</span>').format(why) if why else Markup())


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


SECTION = Section("Verdict", 10, (), render)
