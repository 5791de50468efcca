"""Charts as inline SVG. Colors are left to the page's style sheet, so that charts follow light, dark and print."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup, escape

from hfanalysis.arrays import Array
from hfanalysis.charts.envelope import Envelope
from hfanalysis.wording.numbers import fixed

WIDTH = 960.0
"""Width of every chart [px of its view box]; the page scales it."""
LEFT, RIGHT, TOP, BOTTOM = 58.0, 116.0, 56.0, 46.0
"""Margins [px]: for the values, the least for the names at the lines' ends, the events, and the time."""
_WIDEST = 250.0
"""The most for the names at the lines' ends [px]."""

_ROWS = 3
"""Rows for the names of events above a chart."""

_LETTER = 6.6
"""Width of a letter of the charts' text [px]."""


@dataclass(frozen=True)
class Axis:
    """From values to pixels."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def all(self, values: Array) -> Array:
        """The places [px], (n,), of ``values`` (n,) in the axis's unit."""
        return self.start + (values - self.low) * ((self.end - self.start) / (self.high - self.low))


@dataclass(frozen=True)
class Phase:
    """A stretch of time with a name; ``kind`` picks its tint."""

    start: float
    end: float
    name: str
    kind: str


@dataclass(frozen=True)
class Event:
    """An instant with its standard deviation."""

    time: float
    std: float
    name: str


@dataclass
class Plot:
    """A chart being drawn: its axes, what is drawn already, and the names still to be put at the lines' ends."""

    x: Axis
    y: Axis
    height: float
    parts: list[str] = field(default_factory=list)
    ends: list[tuple[float, str, str]] = field(default_factory=list)
    over: list[str] = field(default_factory=list)


def new_plot(
    times: tuple[float, float], values: tuple[float, float], height: float = 320.0, names: Sequence[str] = ()
) -> Plot:
    """An empty chart over the given ranges: ``times`` [s], ``values`` [as shown], of a ``height`` [px], with room for
    the ``names`` of its lines."""
    low, high = values
    return Plot(Axis(*times, LEFT, WIDTH - right_of(names)), Axis(low, high, height - BOTTOM, TOP), height)


def right_of(names: Sequence[str]) -> float:
    """The right margin [px] that the names at the lines' ends take.

    >>> right_of(["tank"]), right_of(["model with the effects"])
    (116.0, 175.2)
    """
    return min(max(RIGHT, *(30.0 + _LETTER * len(name) for name in names)) if names else RIGHT, _WIDEST)


def value_range(arrays: Iterable[Array], with_zero: bool = True) -> tuple[float, float]:
    """A range with a little air around the finite values; a few wild ones (under 1 %) may be left outside.

    Args:
        arrays: what is to be drawn, each (n,), in the unit of the axis; NaN where there is nothing.
        with_zero: whether zero belongs to the range.
    """
    finite = [array[np.isfinite(array)] for array in arrays]
    joined = np.concatenate(finite) if finite else np.zeros(0)
    low, high = _without_wild(joined) if joined.size else (0.0, 1.0)
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    air = 0.04 * (high - low) or abs(high) * 0.1 or 1.0
    return (low - air if low < 0.0 or not with_zero else low, high + air)


def _without_wild(values: Array) -> tuple[float, float]:
    """The extremes, but no further than the width of the inner 98 % beyond it on either side."""
    low, high = (float(value) for value in np.percentile(values, [1.0, 99.0]))
    width = high - low
    if width == 0.0:
        return float(values.min()), float(values.max())
    return max(float(values.min()), low - width), min(float(values.max()), high + width)


def nice_ticks(low: float, high: float, most: int = 7) -> list[float]:
    """Round values between ``low`` and ``high`` [one unit], no more than ``most``.

    >>> nice_ticks(0.0, 66.0)
    [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
    """
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= rough)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(i * step, 12) for i in range(first, last + 1)]


def axes(plot: Plot, x_label: str, y_label: str) -> None:
    """Grid, values and the names of the axes."""
    right, bottom = plot.x.end, plot.height - BOTTOM
    plot.parts += _y_ticks(plot, right)
    plot.parts += _x_ticks(plot, bottom)
    plot.parts.append(f'<path class="axis" d="M{LEFT:.1f} {TOP:.1f}V{bottom:.1f}H{right:.1f}"/>')
    plot.parts.append(lettering(0.5 * (LEFT + right), plot.height - 8, x_label, "label", "middle"))
    plot.parts.append(lettering(4, 11, y_label, "label", "start"))


def _y_ticks(plot: Plot, right: float) -> Iterator[str]:
    ticks = nice_ticks(plot.y.low, plot.y.high, 6)
    for value in ticks:
        y = plot.y(value)
        yield f'<path class="grid" d="M{LEFT:.1f} {y:.1f}H{right:.1f}"/>'
        yield lettering(LEFT - 8, y + 4, tick_text(value, ticks), "tick", "end")


def _x_ticks(plot: Plot, bottom: float) -> Iterator[str]:
    ticks = nice_ticks(plot.x.low, plot.x.high, 12)
    for value in ticks:
        x = plot.x(value)
        yield f'<path class="axis" d="M{x:.1f} {bottom:.1f}v5"/>'
        yield lettering(x, bottom + 19, tick_text(value, ticks), "tick", "middle")


def tick_text(value: float, ticks: Sequence[float]) -> str:
    """A tick's value with as many decimals as its neighbors need."""
    step = ticks[1] - ticks[0] if len(ticks) > 1 else abs(value) or 1.0
    return fixed(value, max(0, -math.floor(math.log10(step) + 1e-9)))


def lettering(x: float, y: float, text: str, style: str, anchor: str = "middle") -> str:
    """A text of the picture at a place [px]; ``style`` is its class."""
    return f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def phases(plot: Plot, found: Sequence[Phase]) -> None:
    """Shade the phases and name those that are wide enough; the page lists them all."""
    top, height = TOP, plot.height - BOTTOM - TOP
    for phase in found:
        left, right = (_clamped(plot.x, t) for t in (phase.start, phase.end))
        if right <= left:
            continue
        plot.parts.append(
            f'<rect class="phase {phase.kind}" x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
            f'height="{height:.1f}"><title>{escape(phase.name)}</title></rect>'
        )
        if right - left > _LETTER * len(phase.name) + 6:
            plot.over.append(lettering(0.5 * (left + right), top + 15, phase.name, "phase-name", "middle"))


def _clamped(axis: Axis, value: float) -> float:
    return min(max(axis(value), axis.start), axis.end)


def events(plot: Plot, found: Sequence[Event]) -> None:
    """A line per event with its 95 % interval, named above the chart, in rows where names stand close."""
    ends = [-math.inf] * _ROWS
    for event in sorted(found, key=lambda item: item.time):
        if not plot.x.low <= event.time <= plot.x.high:
            continue
        x, half = plot.x(event.time), 0.5 * _LETTER * len(event.name) + 3.0
        row = next((row for row, end in enumerate(ends) if end < x - half), _ROWS - 1)
        ends[row] = x + half
        plot.parts.append(_event(plot, event, x))
        plot.parts.append(lettering(x, TOP - 6 - 13 * row, event.name, "event-name", "middle"))


def _event(plot: Plot, event: Event, x: float) -> str:
    half = max(0.0, plot.x(event.time + 1.96 * event.std) - x)
    bottom = plot.height - BOTTOM
    words = f"{event.name} = {event.time:.3f} s ± {event.std:.3f} s"
    return (
        f"<g><title>{escape(words)}</title>"
        f'<rect class="event-band" x="{x - half:.1f}" y="{TOP:.1f}" width="{2 * half:.1f}" '
        f'height="{bottom - TOP:.1f}"/><path class="event" d="M{x:.1f} {TOP:.1f}V{bottom:.1f}"/></g>'
    )


def line(plot: Plot, data: Envelope, style: str, name: str) -> None:
    """The mean of a channel over the band of its extremes, in the color of ``style``."""
    if data.empty:
        return
    if data.low is not data.mean:
        plot.parts.append(f'<path class="band {style}" d="{band_path(plot, data.time, data.low, data.high)}"/>')
    plot.parts.append(f'<path class="line {style}" d="{line_path(plot, data.time, data.mean)}"/>')
    last = data.mean[np.isfinite(data.mean)][-1]
    plot.ends.append((plot.y(float(last)), name, style))


def band(plot: Plot, time: Array, low: Array, high: Array, style: str) -> None:
    """An interval over time: ``time`` [s], its ends ``low`` and ``high`` [as shown], each (n,)."""
    plot.parts.append(f'<path class="band {style}" d="{band_path(plot, time, low, high)}"/>')


def level(plot: Plot, value: float, style: str) -> None:
    """A horizontal line across the chart at a ``value`` [as shown]."""
    plot.parts.append(f'<path class="level {style}" d="M{LEFT:.1f} {plot.y(value):.1f}H{plot.x.end:.1f}"/>')


def line_path(plot: Plot, time: Array, values: Array) -> str:
    """An SVG path through the finite points of ``values`` [as shown] at ``time`` [s], each (n,); it breaks where there
    are none.
    """
    return "".join("M" + "L".join(_points(plot, time[part], values[part])) for part in _runs(values))


def band_path(plot: Plot, time: Array, low: Array, high: Array) -> str:
    """An SVG path around the band between two curves [as shown] over ``time`` [s], each (n,)."""
    out = []
    for part in _runs(low + high):
        there = _points(plot, time[part], high[part])
        back = _points(plot, time[part][::-1], low[part][::-1])
        out.append("M" + "L".join([*there, *back]) + "Z")
    return "".join(out)


def _points(plot: Plot, time: Array, values: Array) -> list[str]:
    xs = plot.x.all(time)
    ys = np.clip(plot.y.all(values), TOP, plot.height - BOTTOM)
    return [f"{x:.1f} {y:.1f}" for x, y in zip(xs, ys, strict=True)]


def _runs(values: Array) -> list[slice]:
    """The stretches of finite values."""
    finite = np.concatenate([[False], np.isfinite(values), [False]])
    edges = np.flatnonzero(finite[1:] != finite[:-1])
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def render(plot: Plot, name: str, title: str, description: str, other_units: str = "") -> Markup:
    """The finished chart; ``title`` and ``description`` are its text alternative, ``other_units`` the team's."""
    _name_ends(plot)
    body = "".join([*plot.parts, *plot.over])
    texts = f' data-si="{escape(description)}" data-team="{escape(other_units)}"' if other_units else ""
    return Markup(
        f'<svg class="chart" viewBox="0 0 {WIDTH:.0f} {plot.height:.0f}" role="img" '
        f'aria-labelledby="{name}-title" aria-describedby="{name}-desc">'
        f'<title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-desc"{texts}>{escape(description)}</desc>{body}</svg>'
    )


def _name_ends(plot: Plot) -> None:
    """Names at the right ends of the lines, moved apart where they would overlap."""
    ordered = sorted(plot.ends)
    places = _apart([y for y, _, _ in ordered], 15.0, plot.height - BOTTOM)
    for place, (_, name, style) in zip(places, ordered, strict=True):
        x = plot.x.end + 8
        plot.parts.append(f'<path class="line {style}" d="M{x:.1f} {place:.1f}h12"/>')
        plot.parts.append(lettering(x + 17, place + 4, shortened(name), "end-name", "start"))


def shortened(name: str, most: int = 33) -> str:
    """A name that fits beside a chart."""
    return name if len(name) <= most else f"{name[: most - 1]}…"


def _apart(places: list[float], gap: float, lowest: float) -> list[float]:
    """Move sorted places down so that they are ``gap`` apart, then up again where they leave the chart."""
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + gap)
    for i in range(len(places) - 1, -1, -1):
        limit = lowest if i == len(places) - 1 else places[i + 1] - gap
        places[i] = min(places[i], limit)
    return places
