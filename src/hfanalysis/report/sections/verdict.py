"""The verdict: what is identified, what is not, and what looks wrong."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.sections.diagnosis import headline
from hfanalysis.wording import numbers as wording
from hfanalysis.wording.numbers import in_words, listed, quantities

KEY_NUMBERS = ("burn_time", "total_impulse", "specific_impulse", "peak_thrust", "peak_chamber_pressure")
"""What is asked for first, where the validation has it."""


def render(material: Material) -> Iterator[Block]:
    """A sentence, the key numbers, and four lists."""
    yield html.paragraph(sentence(material), "lead")
    yield _diagnosed(material)
    if material.adopted:
        yield html.paragraph(material.adopted)
    for stage, reason in spoken_absences(material).items():
        absent = Markup('<p class="absent"><strong>{}:</strong> {}</p>')
        yield absent.format(stage, html.switchable(reason))
    yield _numbers(key_numbers(material))
    yield Markup('<div class="findings">{}</div>').format(Markup().join(_findings(material)))


def _diagnosed(material: Material) -> Markup | None:
    """The first sentence of the diagnosis."""
    said = headline(material.product("diagnosis"))
    words = Markup('<p class="lead diagnosed"><a href="#diagnosis">Diagnosis</a>: {}</p>')
    return words.format(html.switchable(said)) if said else None


def spoken_absences(material: Material) -> dict[str, str]:
    """Why there are no phases or no calibration, each reason once."""
    told: dict[str, str] = {}
    for name, words in (("segments", "phases"), ("calibration", "calibration"), ("validation", "validation")):
        if not material.has(name) and name in material.absent and material.absent[name] not in told.values():
            told[words] = material.absent[name]
    return told


def key_numbers(material: Material) -> dict[str, Mapping[str, Any]]:
    """The measured numbers that come first; where there are none, what the calibration has instead."""
    performance = material.product("validation").get("performance") or {}
    measured = performance.get("measured") or {}
    found = {name: measured[name] for name in KEY_NUMBERS if (measured.get(name) or {}).get("value") is not None}
    flow = material.product("calibration").get("oxidizer_flow_peak") or {}
    return found or ({"oxidizer_flow_peak": flow} if flow.get("value") is not None else {})


def _numbers(found: Mapping[str, Mapping[str, Any]]) -> Markup | None:
    if not found:
        return None
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (item.format(in_words(name), html.value(quantity, name, True)) for name, quantity in found.items())
    return Markup('<dl class="key-numbers">{}</dl>').format(Markup().join(items))


def sentence(material: Material) -> str:
    """The verdict in a few sentences."""
    if not material.fired:
        return "No firing was found in this log, so there is nothing to calibrate."
    if not material.has("calibration"):
        return " ".join(["This test could not be calibrated; the reason is given below.", *_sensor_sentence(material)])
    names = {kind: [in_words(name) for name in found] for kind, found in by_mark(material).items()}
    parts = [
        f"Identified: {listed(names['good'])}." if names["good"] else "Nothing could be identified.",
        f"Outside its physical range: {listed(names['bad'])}." if names["bad"] else "",
        f"Not identifiable from this test: {listed(names['open'])}." if names["open"] else "",
    ]
    return " ".join([*filter(None, parts), *_sensor_sentence(material)])


def _sensor_sentence(material: Material) -> list[str]:
    """What looks wrong with the sensors, in a sentence of its own."""
    found = [_of_channels(fault) for fault in material.product("validation").get("sensors", [])]
    return [f"Sensors: {'; '.join(found)}."] if found else []


def _of_channels(fault: Mapping[str, Any]) -> str:
    channels, verdict = list(map(str, fault.get("channels", []))), str(fault.get("verdict", ""))
    return verdict if not channels or verdict.startswith(channels[0]) else f"{listed(channels)} {verdict}"


def by_mark(material: Material) -> dict[str, dict[str, Mapping[str, Any]]]:
    """What a calibration is asked for first, by how far it can be trusted."""
    found = quantities(material.product("calibration"))
    out: dict[str, dict[str, Mapping[str, Any]]] = {"good": {}, "bad": {}, "open": {}}
    for name in wording.MASTHEAD:
        if name in found:
            out[html.mark(str(found[name].get("verdict") or ""))][name] = found[name]
    return out


def _findings(material: Material) -> Iterator[Markup]:
    heads = {"good": "Identified", "bad": "Outside its physical range", "open": "Not identified"}
    for kind, found in by_mark(material).items():
        if found:
            yield _finding(kind, heads[kind], map(_judged, *zip(*_by_reason(found, kind), strict=True)))
    faults, others = warnings(material)
    if faults:
        yield _finding("sensor", "Sensors and log", map(html.switchable, faults))
    elif material.log.channels:
        yield _finding("good", "Sensors and log", [Markup("Nothing looks wrong with the sensors.")])
    if others:
        yield _finding("open", "To bear in mind", map(html.switchable, others))


def _finding(kind: str, head: str, items: Any) -> Markup:
    block = '<div class="finding {}"><h3><span class="sign" aria-hidden="true">{}</span>{}</h3>{}</div>'
    return Markup(block).format(kind, html.MARKS[kind], head, html.bullets(items, "plain"))


def _by_reason(found: Mapping[str, Mapping[str, Any]], kind: str) -> list[tuple[str, dict[str, Mapping[str, Any]]]]:
    """The quantities with their reason, those together that have the same one."""
    groups: dict[str, dict[str, Mapping[str, Any]]] = {}
    for name, quantity in found.items():
        why = "" if kind == "good" else str(quantity.get("why") or quantity.get("reason") or "")
        groups.setdefault(why, {})[name] = quantity
    return list(groups.items()) if kind != "good" else [("", {name: found[name]}) for name in found]


def _judged(why: str, found: Mapping[str, Mapping[str, Any]]) -> Markup:
    names = Markup().join(_named(name, quantity) for name, quantity in found.items())
    return names + (Markup('<span class="because">{}</span>').format(html.switchable(why)) if why else Markup())


def _named(name: str, quantity: Mapping[str, Any]) -> Markup:
    number = Markup()
    if quantity.get("value") is not None:
        number = Markup('<span class="judged">{}</span>').format(html.value(quantity, name))
    return Markup('<span class="names">{}{}</span>').format(html.symbol_and_words(name), number)


_OF_SENSORS = re.compile(r"^channel |\b(cell|gauge|thermometer|clock|sensor|disagree)\b", re.IGNORECASE)
_FLAGGED = re.compile(r"^channel (.+): (\d+ of \d+) samples flagged (\w+)$")
_RETURNS = re.compile(r"^channel (\w+): does not return to zero")


def warnings(material: Material) -> tuple[list[str], list[str]]:
    """What every product warns of, each once: of the sensors and the log, and of the rest."""
    validation = material.product("validation").get("sensors", [])
    faults = [str(fault["text"]) for fault in validation]
    covered = {channel for fault in validation for channel in fault.get("channels", [])}
    logged = list(map(str, material.product("ingest").get("warnings", [])))
    sensors = [text for text in logged if not _repeats(text, covered)]
    others: list[str] = []
    for name, product in reversed(list(material.products.items())):
        for text in map(str, product.get("warnings", []) if name != "ingest" else []):
            (faults if _OF_SENSORS.search(text) else others).append(text)
    faults += [text for text in sensors if not _FLAGGED.match(text)] + _flagged(sensors)
    return list(dict.fromkeys(faults)), list(dict.fromkeys([*others, *material.definition.warnings]))


def _repeats(text: str, covered: Collection[str]) -> bool:
    """Whether the ingest says in short what the validation says at length."""
    found = _RETURNS.match(text)
    return bool(found and found[1] in covered)


def _flagged(texts: list[str]) -> list[str]:
    """Flagged samples of many channels, one line for each flag."""
    by_flag: dict[str, list[str]] = {}
    for found in filter(None, map(_FLAGGED.match, texts)):
        by_flag.setdefault(found[3], []).append(f"{found[1]} ({found[2]})")
    return [f"samples flagged {flag}: {listed(channels)}" for flag, channels in by_flag.items()]


SECTION = Section("Verdict", 10, (), render)
