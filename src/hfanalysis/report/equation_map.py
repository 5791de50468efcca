"""Where the model fails, in one picture: a row for each governing equation, time along it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup, escape

from hfanalysis.arrays import Array
from hfanalysis.charts import svg
from hfanalysis.charts.chart import TIME, around
from hfanalysis.diagnose.answer.words import EQUATIONS
from hfanalysis.products.diagnosis import Diagnosis, Lacking
from hfanalysis.report import html
from hfanalysis.report.material import Material, event_list, window
from hfanalysis.wording.numbers import fixed

ROWS = ("tank_energy", "tank_volume", "feed", "injector", "grain", "chamber_mass", "chamber_energy", "nozzle")
"""From the tank to the nozzle, as it flows."""

_ROW, _LEFT = 26.0, 200.0
"""Height of a row, and where its cells begin [px]."""

_Z90 = 1.6449
"""Half-width of a 90 % band, in standard deviations. Source: the normal distribution's quantile of 95 %."""

STEPS = (2.0, 4.0, 8.0)
"""Standard deviations from which on a cell is drawn darker each."""


def equation_map(material: Material, product: Diagnosis) -> Markup | None:
    """The picture with its words; None where no equation could be asked."""
    asked = [(name, product.weak_form[name]) for name in ROWS if name in product.weak_form]
    asked = [(name, found) for name, found in asked if found.reason is None and len(found.time) > 1]
    if not asked:
        return None
    caption = (
        "By the measured channels alone, without running the model. A cell is empty within two standard deviations, "
        "then the darker the further beyond. Red: the model has too little; blue: too much."
    )
    figure = Markup('<figure class="map"><h3>Where the model fails</h3>{}<figcaption>{}</figcaption>{}</figure>')
    return figure.format(_picture(material, asked), caption, _table(asked))


def _picture(material: Material, asked: list[tuple[str, Lacking]]) -> Markup:
    height = svg.TOP + _ROW * len(asked) + svg.BOTTOM
    start, end = window(material)
    span = (start, end) if end > start else around([np.asarray(found.time) for _, found in asked])
    plot = svg.new_plot(span, (0.0, 1.0), height)
    plot.x = svg.Axis(*span, _LEFT, svg.WIDTH - 10.0)
    for row, (name, found) in enumerate(asked):
        top = svg.TOP + _ROW * row
        plot.parts.append(svg.lettering(_LEFT - 8.0, top + 0.68 * _ROW, EQUATIONS[name], "label", "end"))
        plot.parts.append(f'<path class="grid" d="M{_LEFT:.1f} {top:.1f}H{svg.WIDTH - 10.0:.1f}"/>')
        plot.parts += _cells(plot, name, found, top)
    svg.events(plot, event_list(material))
    bottom = height - svg.BOTTOM
    for value in svg.nice_ticks(plot.x.low, plot.x.high, 12):
        plot.parts.append(svg.lettering(plot.x(value), bottom + 19, f"{value:g}".replace("-", "−"), "tick"))
    plot.parts.append(f'<path class="axis" d="M{_LEFT:.1f} {bottom:.1f}H{svg.WIDTH - 10.0:.1f}"/>')
    plot.parts.append(svg.lettering(0.5 * (_LEFT + svg.WIDTH), height - 8, TIME, "label"))
    words = " ".join(_said(name, found) for name, found in asked)
    return svg.render(plot, "equation-map", "Where the model fails, equation by equation", words)


def deviations(found: Lacking) -> Array:
    """What an equation lacks beyond what effects explain, in standard deviations, (n,)."""
    columns = (found.value, found.explained, found.low90, found.high90)
    value, explained, low, high = (np.asarray(column, dtype=float) for column in columns)
    left = value - explained if explained.size == value.size else value
    return np.asarray(left / np.maximum(0.5 * (high - low) / _Z90, 1e-300))


def _cells(plot: svg.Plot, name: str, found: Lacking, top: float) -> Iterator[str]:
    time, off = np.asarray(found.time, dtype=float), deviations(found)
    half = 0.5 * float(np.median(np.diff(time)))
    for t, z in zip(time.tolist(), off.tolist(), strict=True):
        level = sum(abs(z) >= step for step in STEPS)
        left, right = (min(max(plot.x(t + d), plot.x.start), plot.x.end) for d in (-half, half))
        if level and right > left:
            side = "little" if z > 0.0 else "much"
            words = f"{EQUATIONS[name]} at {fixed(t, 1)} s: {fixed(z, 1)} standard deviations"
            yield (
                f'<rect class="cell {side} level-{level}" x="{left:.1f}" y="{top + 2.0:.1f}" '
                f'width="{right - left:.1f}" height="{_ROW - 4.0:.1f}"><title>{escape(words)}</title></rect>'
            )


def _said(name: str, found: Lacking) -> str:
    off = np.abs(deviations(found))
    worst = int(np.argmax(off))
    share = 100.0 * float(np.mean(off >= STEPS[0]))
    return f"{EQUATIONS[name]}: beyond two deviations in {share:.0f} % of the time, most at {found.time[worst]:.1f} s."


def _table(asked: list[tuple[str, Lacking]]) -> Markup:
    rows = [(EQUATIONS[name], *_row(found)) for name, found in asked]
    columns = ("equation", ">time beyond two deviations", ">most, in deviations", ">at")
    fold = Markup("<details><summary>Values as a table</summary>{}</details>")
    return fold.format(html.table("Where the model fails: values", "Equation by equation.", columns, rows))


def _row(found: Lacking) -> tuple[str, str, str]:
    off = deviations(found)
    worst = int(np.argmax(np.abs(off)))
    share = 100.0 * float(np.mean(np.abs(off) >= STEPS[0]))
    return f"{share:.0f} %", fixed(float(off[worst]), 1), html.seconds(found.time[worst], 1)
