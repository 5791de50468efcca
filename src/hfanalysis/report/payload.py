"""What the page's script needs to draw a chart anew: its series with the detail to zoom into, as JSON."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts import draw
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.charts.envelope import Envelope
from hfanalysis.wording.scales import SYSTEMS

MOST_SAMPLES, LEAST_SAMPLES = 24_000, 1_500
"""Samples of a line that a page keeps as they are (24 s at 1 kHz), and how few it may be asked to keep [samples]."""

BUDGET = 520_000
"""Numbers on a page. Evidence: at 5.3 bytes each, with everything else, a page stays below 5 MB."""

_HALVINGS = 12
"""Halvings of the range between MOST_SAMPLES and LEAST_SAMPLES. Source: 22,500 samples halved twelve times leave 6."""


def detail(charts: Sequence[Chart]) -> int:
    """How many samples a line of weight 1 may keep: as many as the page's budget lets all of them have."""
    low, high = LEAST_SAMPLES, MOST_SAMPLES
    if _numbers(charts, high) <= BUDGET:
        return high
    for _ in range(_HALVINGS):
        middle = (low + high) // 2
        low, high = (middle, high) if _numbers(charts, middle) <= BUDGET else (low, middle)
    return low


def _numbers(charts: Sequence[Chart], most: int) -> float:
    """How many numbers a page holds; an envelope has a third as many instants, with three numbers each."""
    total = 0.0
    for chart in charts:
        kept = [min(one.time.size, most * chart.weight) for one in chart.series if one.kind != "level"]
        total += sum(kept) + max(kept, default=0)
    return total


def payload(charts: Sequence[Chart]) -> Markup:
    """All charts as JSON, for an element that browsers do not run."""
    most = detail(charts)
    return as_json({"charts": {chart.key: _chart(chart, int(most * chart.weight)) for chart in charts}})


def as_json(data: Any) -> Markup:
    """JSON that may stand in an HTML script element, whatever its texts are."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)


def _chart(chart: Chart, most: int) -> dict[str, Any]:
    clocks: list[str] = []
    return {
        "title": chart.title,
        "si": chart.unit.partition(",")[0],
        "quantity": chart.quantity,
        "scales": {system: list(vars(chart.scale(system)).values()) for system in SYSTEMS},
        "span": list(chart.span),
        "values": list(_si_span(chart)),
        "height": chart.height,
        "label": chart.x_label,
        "across": list(across(chart)),
        "clock": chart.clock,
        "phases": [vars(phase) for phase in chart.phases],
        "events": [vars(event) for event in chart.events],
        "series": [_series(chart, one, most, clocks) for one in chart.series],
        "clocks": clocks,
    }


def across(chart: Chart) -> tuple[str, str]:
    """What the cursor calls the quantity along the axis, and its unit."""
    name, _, unit = chart.x_label.rstrip("]").partition(" [")
    return ("t" if unit == "s" else name), unit


def _si_span(chart: Chart) -> tuple[float, float]:
    scale = chart.scale()
    low, high = draw.value_span(chart, scale)
    return (low - scale.zero) / scale.factor, (high - scale.zero) / scale.factor


def _series(chart: Chart, one: Series, most: int, clocks: list[str]) -> dict[str, Any]:
    out: dict[str, Any] = {"label": one.label, "style": one.style, "css": one.css, "kind": one.kind}
    out |= {"faint": one.faint} if one.faint else {}
    if one.kind == "level":
        return out | {"level": float(one.values[0])}
    data = _kept(chart, one.time, one.values, most)
    clock = _packed(data.time - chart.span[0])
    if clock not in clocks:
        clocks.append(clock)
    out |= {"clock": clocks.index(clock), "mean": _packed(data.mean)}
    if one.upper is not None:
        out["high"] = _packed(_kept(chart, one.time, one.upper, most).mean)
    elif data.low is not data.mean:
        out |= {"low": _packed(data.low), "high": _packed(data.high)}
    return out


def _kept(chart: Chart, time: Array, values: Array, most: int) -> Envelope:
    """All samples where there are few, else an envelope of a third as many bins, each with three numbers."""
    start, end = chart.span
    inside = int(np.count_nonzero((time >= start) & (time <= end)))
    return Series("", "", time, values).reduced(start, end, most if inside <= most else most // 3)


def _packed(values: Array) -> str:
    """Numbers as base64 of little-endian 32-bit floats."""
    return base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")
