"""A chart on the page: legend, picture, caption, and its values as a table for those who do not see it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts import draw
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.report import html
from hfanalysis.wording.numbers import fixed, tidy
from hfanalysis.wording.scales import SYSTEMS

ROWS = 12
"""Instants of the table between the ends of the chart, besides the events."""

_KEYS = "Arrow keys move the cursor, plus and minus zoom, zero shows all."

_FIGURE = Markup("""<figure id="chart-{key}" data-chart="{key}">
{heading}<div class="legend-row"><ul class="legend" aria-label="{title}: lines">{legend}</ul>
<p class="instant"></p></div>
<div class="plot" tabindex="0" role="group" aria-roledescription="chart" aria-label="{title}. {keys}">{picture}</div>
<figcaption>{caption}</figcaption>
<details><summary>Values as a table</summary>{table}
<p class="controls" hidden><button type="button" class="save-csv">Save as CSV what is in view</button></p></details>
</figure>""")


def figure(chart: Chart, heading: bool = True) -> Markup:
    """The chart as HTML; ``heading`` where its title is not that of the section."""
    head = Markup("<h3>{}</h3>\n").format(chart.title) if heading else Markup()
    return _FIGURE.format(
        key=chart.key,
        title=chart.title,
        keys=_KEYS,
        heading=head,
        legend=Markup().join(map(_entry, chart.series)),
        picture=draw.static(chart),
        caption=chart.caption,
        table=values(chart),
    )


def _entry(one: Series) -> Markup:
    """A line's name beside a sample of it."""
    shape = {"band": "M0 0h22v10H0Z"}.get(one.kind, "M0 5h22")
    style = f"{one.kind} {one.css}"
    sample = '<svg class="sample" viewBox="0 0 22 10" aria-hidden="true"><path class="{}" d="{}"/></svg>'
    return Markup(f"<li>{sample}<bdi>{{}}</bdi></li>").format(style, shape, one.label)


def values(chart: Chart) -> Markup:
    """What the lines read at some instants and at the events."""
    lines = chart.lines
    columns = (chart.x_label, *(f">{one.label}" for one in lines), "")
    rows = ((_time(chart, t), *(_reading(chart, one, t) for one in lines), name) for t, name in _instants(chart))
    return html.table(f"{chart.title}: values", chart.quantity, columns, rows)


def _time(chart: Chart, t: float) -> str:
    decimals = 2 if chart.span[1] - chart.span[0] < 200.0 else 0
    return fixed(t, decimals)


def _instants(chart: Chart) -> Iterator[tuple[float, str]]:
    """Round instants across the chart, and those of the events with their names."""
    even = [(float(t), "") for t in np.linspace(*chart.span, ROWS + 2)[1:-1]]
    events = [(event.time, event.name) for event in chart.events if chart.span[0] <= event.time <= chart.span[1]]
    yield from sorted([*even, *events])


def _reading(chart: Chart, one: Series, t: float) -> Markup:
    value = near(one.time, one.values, t)
    if value is None:
        return Markup("–")
    si, team = (f"{tidy(s(value))} {s.unit}".strip() for s in map(chart.scale, SYSTEMS))
    return html.both(si, team)


def near(time: Array, values: Array, t: float) -> float | None:
    """The value, in the unit of ``values`` (n,), of the sample nearest to ``t`` [s]; None outside of ``time`` (n,) [s].

    None also where there is no number.

    >>> near(np.array([0.0, 1.0, 2.0]), np.array([5.0, 6.0, np.nan]), 0.7), near(np.array([0.0]), np.array([5.0]), 1.0)
    (6.0, None)
    """
    if not time.size or not time[0] <= t <= time[-1]:
        return None
    after = int(np.searchsorted(time, t))
    nearest = after - 1 if after > 0 and t - time[after - 1] < time[min(after, time.size - 1)] - t else after
    found = float(values[min(nearest, time.size - 1)])
    return found if np.isfinite(found) else None
