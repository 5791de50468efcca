"""Every column of the logs in one picture, one below the other."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts import svg
from hfanalysis.charts.colors import style_of
from hfanalysis.charts.envelope import envelope
from hfanalysis.charts.style import alone, ground
from hfanalysis.drafting.columns import Column
from hfanalysis.drafting.document import facts, plain
from hfanalysis.drafting.guesses import Judged
from hfanalysis.drafting.survey import Surveyed

PANEL = 170.0
"""Height of a column's panel [px]."""
AIR = 8.0
"""Above the first of them [px]."""


def picture(found: Surveyed) -> str:
    """An SVG with a panel per column that holds numbers."""
    panels = [_panel(found, one, i) for i, one in enumerate(found.columns) if one.column.good.size > 1]
    height = PANEL * len(panels) + AIR
    placed = "".join(f'<g transform="translate(0 {PANEL * i + AIR:.0f})">{part}</g>' for i, part in enumerate(panels))
    head = f'<svg class="chart" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {svg.WIDTH:.0f} {height:.0f}"'
    return f"{head}><style><![CDATA[{alone()}]]></style>{ground(svg.WIDTH, height)}{placed}</svg>\n"


def _panel(found: Surveyed, one: Judged, number: int) -> str:
    guess = found.guess(one)
    time = times(found, one.column)
    inside = np.isfinite(time) & np.isfinite(one.column.values)
    time, values = time[inside], one.column.values[inside]
    span = float(time[0]), float(time[-1])
    plot = svg.new_plot(
        span if span[1] > span[0] else (span[0], span[0] + 1.0), svg.value_range([values], False), PANEL
    )
    svg.axes(plot, "", _title(one, guess.channel if guess else ""))
    data = envelope(time, values, *plot_span(plot))
    svg.line(plot, data, style_of(guess.channel if guess else "raw", number), "")
    drawn = str(svg.render(plot, f"column-{number}", plain(one.column.shown), plain("; ".join(facts(one)))))
    return drawn.partition(">")[2].removesuffix("</svg>")


def plot_span(plot: svg.Plot) -> tuple[float, float]:
    """The ends of a plot's time axis [s]."""
    return plot.x.low, plot.x.high


def _title(one: Judged, channel: str) -> str:
    unit = f" [{plain(one.column.unit)}]" if one.column.unit else ""
    open_guess = f"{one.best.channel}?" if one.best else ""
    taken = channel or open_guess
    return re.sub(r"[\x00-\x08\x0b-\x1f]", "?", f"{plain(one.column.shown)}{unit}{taken and f' — {taken}'}")


def times(found: Surveyed, column: Column) -> Array:
    """When a column's kept values (n,) were read [s], from the first on; their count where there are no stamps that
    run.
    """
    file = next(one for one in found.files if one.name == column.file)
    stamps = found.stamps[column.file]
    own = file.numbered(column.stamps) if column.stamps else stamps.column
    count = np.arange(column.values.size, dtype=np.float64)
    if own is None or own.values.size != column.values.size:
        return count
    known = own.values[np.isfinite(own.values)]
    if known.size < 2 or np.any(np.diff(known) < 0.0):
        return count
    seconds: Array = (own.values - known[0]) * (1.0 if column.stamps else stamps.factor)
    return seconds


def strips(values: Array, width: int = 30) -> str:
    """A column as a line of blocks, for a terminal.

    >>> strips(np.linspace(0.0, 1.0, 80), 8)
    '▁▂▃▄▅▆▇█'
    """
    good = np.isfinite(values)
    if not good.any():
        return ""
    means = list(_means(values, min(width, values.size)))
    known = np.array([mean for mean in means if np.isfinite(mean)])
    low, high = float(known.min()), float(known.max())
    step = (high - low) or 1.0
    return "".join(" " if not np.isfinite(m) else "▁▂▃▄▅▆▇█"[min(7, int(8.0 * (m - low) / step))] for m in means)


def _means(values: Array, width: int) -> Iterator[float]:
    """Medians of equal parts, NaN where a part has no numbers."""
    for part in np.array_split(values, width):
        known = part[np.isfinite(part)]
        yield float(np.median(known)) if known.size else float("nan")
