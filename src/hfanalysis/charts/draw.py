"""A chart as static SVG: what is seen without the page's script, and on paper."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from markupsafe import Markup

from hfanalysis.charts import svg
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.charts.envelope import BINS, Envelope
from hfanalysis.wording.numbers import fixed, tidy
from hfanalysis.wording.scales import SYSTEMS, Scale


def static(chart: Chart) -> Markup:
    """The chart in SI."""
    scale = chart.scale()
    names = [one.label for one in chart.lines]
    plot = svg.new_plot(chart.span, value_span(chart, scale), chart.height, names)
    svg.phases(plot, chart.phases)
    svg.axes(plot, chart.x_label, axis_label(chart, scale))
    svg.events(plot, chart.events)
    for one in chart.series:
        _add(plot, chart, one, scale)
    si, team = (text_alternative(chart, system) for system in SYSTEMS)
    return svg.render(plot, chart.key, chart.title, si, team)


def axis_label(chart: Chart, scale: Scale) -> str:
    """What the values are, and in which unit."""
    return f"{chart.quantity} [{scale.unit or '–'}]"


def reduced(chart: Chart, series: Series, bins: int = BINS) -> Envelope:
    """A line within the chart's span, with few points."""
    return series.reduced(*chart.span, bins)


def value_span(chart: Chart, scale: Scale) -> tuple[float, float]:
    """The ends of the value axis, in the scale's unit [``scale.unit``]."""
    if chart.value_span is not None:
        low, high = chart.value_span
        return scale(low), scale(high)
    believed = [one for one in chart.lines if not one.faint and one.finite] or chart.lines
    envelopes = [reduced(chart, one) for one in believed]
    arrays = [array for data in envelopes for array in (data.low, data.high)]
    return svg.value_range([scale.factor * array + scale.zero for array in arrays], chart.with_zero)


def _add(plot: svg.Plot, chart: Chart, one: Series, scale: Scale) -> None:
    if one.kind == "level":
        svg.level(plot, scale(float(one.values[0])), one.style)
        return
    data = scaled(reduced(chart, one), scale)
    if one.kind == "band" and one.upper is not None:
        upper = scaled(Series("", "", one.time, one.upper).reduced(*chart.span, BINS), scale)
        svg.band(plot, data.time, data.mean, upper.mean, one.style)
    else:
        svg.line(plot, data, one.css, one.label)


def scaled(data: Envelope, scale: Scale) -> Envelope:
    """An envelope [SI] in the scale's unit."""
    mean, low, high = (scale.factor * array + scale.zero for array in (data.mean, data.low, data.high))
    return Envelope(data.time, mean, mean if data.low is data.mean else low, mean if data.high is data.mean else high)


def text_alternative(chart: Chart, system: str = "si") -> str:
    """The text alternative: what each line does, and when."""
    scale = chart.scale(system)
    sentences = [_behavior(chart, one, scale) for one in chart.lines]
    events = [f"{event.name} at {fixed(event.time, 2)} s" for event in _inside(chart)]
    return " ".join([*sentences, f"Events: {', '.join(events)}." if events else ""]).strip()


def _inside(chart: Chart) -> Iterable[svg.Event]:
    return (event for event in chart.events if chart.span[0] <= event.time <= chart.span[1])


def _behavior(chart: Chart, one: Series, scale: Scale) -> str:
    data = reduced(chart, one)
    if data.empty:
        return f"{one.label}: no good samples here."
    known = np.flatnonzero(np.isfinite(data.mean))
    least, most = int(np.nanargmin(data.low)), int(np.nanargmax(data.high))
    unit = f" {scale.unit}" if scale.unit else ""

    def at(index: int, values: np.ndarray) -> str:
        return f"{tidy(scale(float(values[index])), 3)}{unit} at {fixed(float(data.time[index]), 1)} s"

    return (
        f"{one.label}: {at(known[0], data.mean)}, {at(known[-1], data.mean)}; "
        f"highest {at(most, data.high)}, lowest {at(least, data.low)}."
    )
