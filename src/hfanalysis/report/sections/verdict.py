"""The verdict: what is identified, what is not, and what looks wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.report import html, wording
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.wording import in_words, listed, quantities

KEY_NUMBERS = ("burn_time", "total_impulse", "specific_impulse", "peak_thrust", "peak_chamber_pressure")
"""What is asked for first, where the validation has it."""


def render(material: Material) -> Iterator[Block]:
    """A sentence, the key numbers, and four lists."""
    yield html.paragraph(sentence(material), "lead")
    for stage, reason in spoken_absences(material).items():
        absent = Markup('<p class="absent"><strong>{}:</strong> {}</p>')
        yield absent.format(stage, html.switchable(reason))
    yield _numbers(key_numbers(material))
    yield Markup('<div class="findings">{}</div>').format(Markup().join(_findings(material)))


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
    return found | ({"oxidizer_flow_peak": flow} if flow.get("value") is not None else {})


def _numbers(found: Mapping[str, Mapping[str, Any]]) -> Markup | None:
    if not found:
        return None
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (item.format(in_words(name), html.value(quantity, name)) for name, quantity in found.items())
    return Markup('<dl class="key-numbers">{}</dl>').format(Markup().join(items))


def sentence(material: Material) -> str:
    """The verdict in a sentence."""
    if not material.fired:
        return "No firing was found in this log, so there is nothing to calibrate."
    marked = by_mark(material)
    if not material.has("calibration"):
        return "This test could not be calibrated; the reason is given below."
    names = {kind: [in_words(name) for name in found] for kind, found in marked.items()}
    parts = [
        f"Identified: {listed(names['good'])}." if names["good"] else "Nothing could be identified.",
        f"Outside its physical range: {listed(names['bad'])}." if names["bad"] else "",
        f"Not identifiable from this test: {listed(names['open'])}." if names["open"] else "",
    ]
    return " ".join(filter(None, parts))


def by_mark(material: Material) -> dict[str, dict[str, Mapping[str, Any]]]:
    """What a calibration is asked for first, by how far it can be trusted."""
    found = quantities(material.product("calibration"))
    out: dict[str, dict[str, Mapping[str, Any]]] = {"good": {}, "bad": {}, "open": {}}
    for name in wording.MASTHEAD:
        if name in found:
            out[html.mark(str(found[name].get("verdict") or ""))][name] = found[name]
    return out


def _findings(material: Material) -> Iterator[Markup]:
    marked = by_mark(material)
    heads = {"good": "Identified", "bad": "Outside its physical range", "open": "Not identified"}
    for kind, found in marked.items():
        if found:
            yield _finding(kind, heads[kind], (_judged(kind, *item) for item in found.items()))
    sensors, others = warnings(material)
    if sensors:
        yield _finding("sensor", "Sensors and log", map(html.switchable, sensors))
    elif material.log.channels:
        yield _finding("good", "Sensors and log", [Markup("Nothing looks wrong with the sensors.")])
    if others:
        yield _finding("open", "To bear in mind", map(html.switchable, others))


def _finding(kind: str, head: str, items: Any) -> Markup:
    block = '<div class="finding {}"><h3><span class="sign" aria-hidden="true">{}</span>{}</h3>{}</div>'
    return Markup(block).format(kind, html.MARKS[kind], head, html.bullets(items, "plain"))


def _judged(kind: str, name: str, quantity: Mapping[str, Any]) -> Markup:
    why = str(quantity.get("why") or quantity.get("reason") or "")
    known = quantity.get("value") is not None
    number = Markup('<span class="judged">{}</span>').format(html.value(quantity, name)) if known else Markup()
    said = Markup(' <span class="because">{}</span>').format(html.switchable(why)) if why and kind != "good" else ""
    return html.symbol_and_words(name) + number + said


_OF_SENSORS = ("channel", "thrust", "clock", "sensor", "cell")


def warnings(material: Material) -> tuple[list[str], list[str]]:
    """What every product warns of, each once: of the sensors and the log, and of the rest."""
    sensors = [str(text) for text in material.product("ingest").get("warnings", [])]
    others: list[str] = []
    for name, product in reversed(list(material.products.items())):
        for text in map(str, product.get("warnings", []) if name != "ingest" else []):
            (sensors if text.casefold().startswith(_OF_SENSORS) else others).append(text)
    return list(dict.fromkeys(sensors)), list(dict.fromkeys([*others, *material.definition.warnings]))


SECTION = Section("Verdict", 10, (), render)
