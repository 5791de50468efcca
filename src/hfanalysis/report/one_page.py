"""The first screen on one sheet of paper: sentences, numbers and charts, drawn with matplotlib."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

from hfanalysis.charts.chart import Chart
from hfanalysis.quantity import DOUBTED
from hfanalysis.report.glance import Told, against_last, four, key_numbers, motor_class
from hfanalysis.report.material import Material
from hfanalysis.report.page import kind
from hfanalysis.report.plots import draw_on, plain_text
from hfanalysis.report.sections.verdict import glance_charts
from hfanalysis.wording.numbers import MINUS, SOURCES, fixed, in_words, shown

SIZES = {"a4": (8.27, 11.69), "letter": (8.5, 11.0)}
"""Sheets of paper [in]. Source: ISO 216, ANSI/ASME Y14.1."""

_WRAP = 78
"""Letters of a line of a sentence: what is left of an A4 or Letter sheet beside the heads."""

_LINE, _TOP = 0.0165, 0.965
"""Height of a line of text, and where the first stands [share of the sheet]."""

_MARGIN, _TEXT = 0.085, 0.22
"""Left edges of heads and of sentences [share of the sheet]."""


def write_summary(material: Material, path: Path, size: str = "a4") -> None:
    """Draw the summary of a test to a PDF of one page; ``size``: one of SIZES."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZES[size])
    FigureCanvasPdf(figure)
    place = _head(figure, material)
    for told in four(material):
        place = _told(figure, told, place)
    place = _numbers(figure, material, place - _LINE)
    _charts(figure, glance_charts(material), place)
    figure.text(_MARGIN, 0.03, "Made by hfanalysis. Times count from the opening of the valve.", fontsize=7)
    figure.savefig(path, format="pdf", metadata={"Creator": "hfanalysis", "Producer": None, "CreationDate": None})


def _head(figure: Any, material: Material) -> float:
    """What it was; returns where the next line stands."""
    test = material.definition.test
    figure.text(_MARGIN, _TOP, plain_text(test.id), fontsize=20, fontweight="bold", va="top")
    engine = f"engine {test.engine}" if test.engine else ""
    stand = f"stand {test.stand}" if test.stand else ""
    about = " · ".join(filter(None, (kind(material), str(test.date or ""), engine, stand)))
    figure.text(_MARGIN, _TOP - 0.034, plain_text(about), fontsize=9, va="top")
    weight = "normal" if test.source == "measured" else "bold"
    source = SOURCES.get(test.source, test.source)
    figure.text(_MARGIN, _TOP - 0.052, source, fontsize=9, fontweight=weight, va="top")
    return _TOP - 0.085


def _told(figure: Any, told: Told, place: float) -> float:
    lines = textwrap.wrap(told.words, _WRAP) or [""]
    figure.text(_MARGIN, place, told.head, fontsize=9, color="0.35", va="top")
    figure.text(_TEXT, place, plain_text("\n".join(lines)), fontsize=9, va="top", linespacing=1.35)
    return place - _LINE * (len(lines) + 0.6)


def _numbers(figure: Any, material: Material, place: float) -> float:
    """The numbers, three in a row, with what they were last time; returns where the charts begin."""
    last = {row.name: row for row in against_last(material)}
    found = list(key_numbers(material).items())
    for number, (name, quantity) in enumerate(found):
        left, top = _MARGIN + 0.285 * (number % 3), place - 0.075 * (number // 3)
        text = shown(quantity, "si", name)
        letter = motor_class(material) if name == "total_impulse" else ""
        unit = f"{text.unit}, class {letter}" if letter else text.unit
        spread = f"± {text.std}" if text.std else ""
        doubt = ", doubted" if quantity.verdict == DOUBTED else ""
        figure.text(left, top, in_words(name), fontsize=8, color="0.35", va="top")
        figure.text(left, top - 0.014, f"{text.value} {unit}", fontsize=12, fontweight="bold", va="top")
        figure.text(left, top - 0.034, f"{spread}{doubt}".removeprefix(", "), fontsize=8, va="top")
        if name in last and material.last is not None:
            was = shown(last[name].was, "si", name)
            change = _percent(last[name].change)
            said = f"{material.last.id}: {was.with_unit}{change}"
            figure.text(left, top - 0.049, plain_text(said), fontsize=8, color="0.35", va="top")
    return place - 0.075 * -(-len(found) // 3)


def _percent(change: float | None) -> str:
    if change is None:
        return ""
    text = fixed(100.0 * change, 0)
    return f", {text if text.startswith(MINUS) else f'+{text}'} %"


def _charts(figure: Any, charts: list[Chart], top: float) -> None:
    """One above the other, on what is left of the sheet."""
    height = (top - 0.09) / max(len(charts), 1)
    for number, chart in enumerate(charts):
        bottom = top - (number + 1) * height + 0.05
        axes = figure.add_axes((_MARGIN + 0.03, bottom, 0.8, height - 0.105))
        draw_on(axes, chart, chart.title)
