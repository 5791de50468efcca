"""Two tests laid over each other: the same charts in two colors, and their numbers side by side."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any
from urllib.parse import quote

from markupsafe import Markup

from hfanalysis.charts.chart import Chart, Series
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.figure import figure
from hfanalysis.report.material import Material
from hfanalysis.report.page import kind, render
from hfanalysis.report.payload import payload
from hfanalysis.report.sections import charts
from hfanalysis.wording.numbers import MINUS, Shown, fixed, ordered, shown
from hfanalysis.wording.scales import SYSTEMS

_LEFT_OUT = {"raw", "model", "residual"}
"""Lines that say something of one test only."""

_FAR, _VERY_FAR = 3.0, 100.0
"""Standard deviations beyond which a difference is pointed out, and beyond which nobody counts them."""


_LONG_UNIT = 16
"""Letters of a unit that need not be said again with a difference."""


def compare(one: Material, other: Material) -> str:
    """The HTML of the page of two tests, which lies beside the page of the first."""
    pairs = list(both_charts(one, other))
    return render(
        "compare.html.j2",
        tests=[(material.definition.test, kind(material)) for material in (one, other)],
        tables=list(_tables(one, other)),
        pages=["report.html", f"../{quote(other.definition.test.id)}/report.html"],
        figures=[figure(chart) for chart in pairs],
        data=payload(pairs),
    )


def both_charts(one: Material, other: Material) -> Iterator[Chart]:
    """A chart for every line that both tests have, time from the opening of the valve."""
    theirs = {(chart.key, line.label): (chart, line) for chart in charts(other) for line in _lines(chart)}
    names = [material.definition.test.id for material in (one, other)]
    for chart in charts(one):
        for line in _lines(chart):
            found = theirs.get((chart.key, line.label))
            if found is not None:
                yield _laid_over((chart, line), found, names)


def _lines(chart: Chart) -> list[Series]:
    return [line for line in chart.lines if line.style not in _LEFT_OUT and line.label != "measured"]


def _laid_over(mine: tuple[Chart, Series], theirs: tuple[Chart, Series], names: list[str]) -> Chart:
    chart, line = mine
    span = (min(chart.span[0], theirs[0].span[0]), max(chart.span[1], theirs[0].span[1]))
    alone = len(_lines(chart)) == 1
    return replace(
        chart,
        key=f"{chart.key}-{chart.lines.index(line)}",
        title=chart.title if alone else f"{chart.title}: {line.label}",
        series=(
            replace(line, label=names[0], style="one"),
            replace(theirs[1], label=names[1], style="two", dashed=True),
        ),
        span=span,
        caption="",
        phases=(),
        events=(),
        value_span=None,
        height=260.0,
    )


def _tables(one: Material, other: Material) -> Iterator[tuple[str, Markup]]:
    columns = ("quantity", f">{one.definition.test.id}", f">{other.definition.test.id}", ">difference", ">in std")
    for title, pick in (("Performance", _performance), ("Calibration", _calibration), ("Phases", _phases)):
        mine, theirs = pick(one), pick(other)
        rows = [_row(name, mine.get(name), theirs.get(name)) for name in dict.fromkeys([*mine, *theirs])]
        if rows:
            caption = "Difference: the second less the first; in standard deviations of both together."
            yield title, html.table(title, caption, columns, rows)


def _performance(material: Material) -> Mapping[str, Quantity]:
    validation = material.get(Validation)
    return ordered(validation.performance.measured.quantities) if validation is not None else {}


def _calibration(material: Material) -> Mapping[str, Quantity]:
    calibration = material.get(Calibration)
    return ordered(calibration.quantities) if calibration is not None else {}


def _phases(material: Material) -> Mapping[str, Quantity]:
    segments = material.get(Segments)
    return segments.events if segments is not None else {}


def _row(name: str, mine: Quantity | None, theirs: Quantity | None) -> tuple[Any, ...]:
    cells = [Markup("–") if quantity is None else _cell(name, quantity) for quantity in (mine, theirs)]
    return (html.symbol_and_words(name), *cells, *_difference(name, mine, theirs))


def _cell(name: str, quantity: Quantity) -> Markup:
    verdict = quantity.verdict or ""
    judged = Markup(" ") + html.verdict(verdict) if verdict and html.mark(verdict) != "good" else Markup()
    return html.value(quantity, name) + judged


def _difference(name: str, mine: Quantity | None, theirs: Quantity | None) -> tuple[Markup, Markup]:
    """The difference of two quantities with its standard deviation, and how many of those it is."""
    if mine is None or theirs is None or mine.value is None or theirs.value is None:
        return Markup(), Markup()
    value, std = theirs.value - mine.value, math.hypot(mine.std or 0.0, theirs.std or 0.0)
    between = Quantity(value, mine.unit, std)
    si, team = (_signed(shown(between, system, name, True)) for system in SYSTEMS)
    return html.both(si, team), _sigmas(value, std)


def _signed(text: Shown) -> str:
    spread = f" ± {text.std}" if text.std else ""
    number = f"{'' if text.value.startswith(MINUS) else '+'}{text.value}{spread}"
    unit = text.unit if len(text.unit) <= _LONG_UNIT else text.unit.partition(" ")[0]
    return f"({number}) {unit}" if unit.startswith("×") else f"{number} {unit}".strip()


def _sigmas(value: float, std: float) -> Markup:
    if not std:
        return Markup()
    share = abs(value) / std
    number = fixed(share, 1) if share < _VERY_FAR else f"> {_VERY_FAR:.0f}"
    return Markup("<strong>{}</strong>").format(number) if share > _FAR else Markup(number)
