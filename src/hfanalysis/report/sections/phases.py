"""Phases: when what happened."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.charts.svg import Phase
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material, phase_list
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words

_CAPTION = Markup("Seconds after the valve opens; t<sub>open</sub> in log time.")


def render(material: Material) -> Iterator[Block]:
    """A strip of the phases, and the events as a table."""
    found = phase_list(material)
    if found:
        yield _strip(found)
    yield html.table(
        "Events", _CAPTION, ("event", "what happens", ">time", ">95 % interval", "remark"), _rows(material)
    )
    for note in material.need(Segments).notes:
        yield html.paragraph(note)


def _strip(found: list[Phase]) -> Markup:
    items = Markup().join(_item(phase) for phase in found)
    return Markup('<ul class="phases" aria-label="Phases, seconds after the valve opens">{}</ul>').format(items)


def _item(phase: Phase) -> Markup:
    times = f"{phase.start:.2f} … {phase.end:.2f} s"
    item = '<li><span class="swatch phase-swatch {}" aria-hidden="true"></span>{} <span class="unit">{}</span></li>'
    return Markup(item).format(phase.kind, phase.name, times)


def _rows(material: Material) -> Iterator[tuple[Any, ...]]:
    segments = material.need(Segments)
    for name, event in segments.quantities.items():
        yield _row(name, event, name in segments.engineer, material)


def _row(name: str, quantity: Quantity, by_hand: bool, material: Material) -> tuple[Any, ...]:
    hand = Markup("<strong>set by the engineer</strong> ") if by_hand else Markup()
    why = hand + html.judged(quantity, material.reasons)
    return html.symbol(name), in_words(name), html.value(quantity), html.interval(quantity), why


SECTION = Section("Phases", 20, ("segments",), render, folded=True)
