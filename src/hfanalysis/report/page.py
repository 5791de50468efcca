"""The page of a test: one HTML file that needs nothing else."""

from __future__ import annotations

import base64
import functools
import hashlib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from hfanalysis.charts.chart import Chart
from hfanalysis.charts.style import sheet
from hfanalysis.products.segments import Segments
from hfanalysis.report.figure import figure
from hfanalysis.report.glance import four, key_numbers
from hfanalysis.report.limits import KEPT, judged
from hfanalysis.report.material import Material
from hfanalysis.report.payload import as_json, payload
from hfanalysis.report.sections import Laid, lay_out
from hfanalysis.report.spark import spark
from hfanalysis.wording import numbers as wording
from hfanalysis.wording.numbers import in_words, listed, shown
from hfanalysis.wording.scales import SYSTEMS

SUMMARY = '<script type="application/json" id="summary">'
"""How the part of a page begins that the index reads."""


@functools.cache
def script() -> Markup:
    """The page's script: small files, one after the other, in a scope of their own."""
    folder = files("hfanalysis.report") / "script"
    parts = sorted((item.name, item.read_text(encoding="utf-8")) for item in folder.iterdir() if item.is_file())
    return Markup('(() => {\n"use strict";\n' + "\n".join(text for _, text in parts) + "})();\n")


@functools.cache
def policy() -> str:
    """What the page may do: run this one script, and load nothing from anywhere."""
    digest = base64.b64encode(hashlib.sha256(script().encode()).digest()).decode()
    return f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{digest}'"


@functools.cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("hfanalysis.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {"style": sheet, "script": script, "policy": policy, "source_words": _source_words}
    return environment


def render(template: str, **values: Any) -> str:
    """Fill one of the templates; everything that is put in is escaped."""
    return _environment().get_template(template).render(**values)


def page(material: Material) -> str:
    """The HTML of a test's page."""
    laid = lay_out(material)
    charts = [chart for section in laid for chart in section.charts]
    return render(
        "page.html.j2",
        test=material.definition.test,
        kind=kind(material),
        sections=[(section, body(section)) for section in laid if section.blocks],
        absent=absences(laid),
        summary=as_json(summary(material)),
        data=payload(charts),
    )


def absences(laid: Sequence[Laid]) -> list[tuple[str, str]]:
    """What is not on the page and why: sections that lack the same thing together."""
    by_reason: dict[str, list[str]] = {}
    for section in laid:
        if not section.blocks and section.absent:
            by_reason.setdefault(section.absent, []).append(section.title)
    return [(listed(titles), reason) for reason, titles in by_reason.items()]


def body(section: Laid) -> Markup:
    """A section's charts and texts."""
    return Markup("\n").join(
        figure(block, block.title != section.title) if isinstance(block, Chart) else block for block in section.blocks
    )


def summary(material: Material) -> dict[str, Any]:
    """What the index says about the test."""
    test = material.definition.test
    numbers = key_numbers(material)
    return {
        "id": test.id,
        "kind": kind(material) if material.fired else "no firing found",
        "date": str(test.date or ""),
        "source": test.source,
        "sentence": " ".join(told.words for told in four(material)[:3]),
        "numbers": [[in_words(name), *_in_both(name, quantity)] for name, quantity in numbers.items()],
        "limits": [[one.state, one.name] for one in judged(material) if one.state != KEPT],
        "kept": sum(one.state == KEPT for one in judged(material)),
        "spark": spark(material),
    }


def _in_both(name: str, quantity: Any) -> Sequence[str]:
    return [shown(quantity, system, name).with_unit for system in SYSTEMS]


def _source_words(source: str) -> str:
    return wording.SOURCES.get(source, source)


def kind(material: Material) -> str:
    """What kind of test it was, as recognized, else as stated."""
    segments = material.get(Segments)
    found = segments.kind if segments is not None else material.definition.test.kind
    return wording.KINDS.get(found, found)
