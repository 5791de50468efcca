"""Every chart of a page as PNG, and its data as CSV."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts import draw
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.charts.colors import COLORS
from hfanalysis.products.disk import atomic

_BINS = 2000
"""Points across a picture: more than its 1500 pixels."""
_INCHES = 10.0
"""Width of a picture [in]."""
_LIGHT = {name: pair[0] for name, pair in COLORS.items()} | {
    "noise": COLORS["soft"][0],
    "zero": COLORS["soft"][0],
    "one": COLORS["p_tank"][0],
    "two": COLORS["p_run"][0],
}


def write_plots(charts: Iterable[Chart], folder: Path, about: str) -> list[Path]:
    """Write ``KEY.png`` and ``KEY.csv`` for every chart to ``folder``; ``about`` (test, source) stands above each."""
    made = []
    for chart in charts:
        with atomic(folder / f"{chart.key}.csv") as scratch:
            scratch.write_text(csv(chart), encoding="utf-8")
        with atomic(folder / f"{chart.key}.png") as scratch:
            png(chart, scratch, about)
        made += [folder / f"{chart.key}.csv", folder / f"{chart.key}.png"]
    return made


def csv(chart: Chart) -> str:
    """All samples of the chart's lines in SI: a row for each instant, empty where a line has no sample then."""
    columns = list(_columns(chart))
    times = np.unique(np.concatenate([time for _, time, _ in columns])) if columns else np.zeros(0)
    table = np.full((times.size, len(columns)), np.nan)
    for number, (_, time, values) in enumerate(columns):
        table[np.searchsorted(times, time), number] = values
    head = ",".join(_quoted(text) for text in (chart.x_label, *(name for name, _, _ in columns)))
    rows = (",".join([f"{t:.6f}", *map(_cell, row)]) for t, row in zip(times, table.tolist(), strict=True))
    return "\n".join([head, *rows, ""])


def _columns(chart: Chart) -> Iterator[tuple[str, Array, Array]]:
    unit = chart.unit.partition(",")[0] or "-"
    for one in chart.series:
        if one.kind == "line":
            yield f"{one.label} [{unit}]", one.time, one.values
        elif one.kind == "band" and one.upper is not None:
            yield f"{one.label}: from [{unit}]", one.time, one.values
            yield f"{one.label}: to [{unit}]", one.time, one.upper


def _quoted(text: str) -> str:
    """A field that a spreadsheet takes for text, not for a formula."""
    safe = f"'{text}" if text[:1] in "=+-@\t" else text
    return '"' + safe.replace('"', '""') + '"'


def _cell(value: float) -> str:
    return f"{value:.8g}" if np.isfinite(value) else ""


def png(chart: Chart, path: Path, about: str) -> None:
    """Draw the chart with matplotlib, in SI."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_INCHES, _INCHES * chart.height / 800.0 + 0.6), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    _frame(axes, chart, about)
    for one in chart.series:
        _add(axes, chart, one)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9)
    figure.savefig(path, format="png", metadata={"Software": "hfanalysis"})


def _frame(axes: Any, chart: Chart, about: str) -> None:
    scale = chart.scale()
    axes.set_xlim(chart.span)
    axes.set_ylim(draw.value_span(chart, scale))
    axes.set_title(_plain(f"{about}: {chart.title}"), loc="left", fontsize=11, pad=26)
    axes.set_xlabel(chart.x_label)
    axes.set_ylabel(_plain(draw.axis_label(chart, scale)))
    axes.grid(axis="y", color=_LIGHT["grid"])
    axes.spines[["top", "right"]].set_visible(False)
    for phase in chart.phases:
        axes.axvspan(phase.start, phase.end, color=_LIGHT[phase.kind], alpha=0.11, linewidth=0)
    for number, event in enumerate(chart.events):
        if chart.span[0] <= event.time <= chart.span[1]:
            _event(axes, event.time, event.name, number % 2)


def _event(axes: Any, time: float, name: str, row: int) -> None:
    axes.axvline(time, color=_LIGHT["ink"], linewidth=0.8, linestyle=":")
    place = {"xy": (time, 1.0), "xycoords": ("data", "axes fraction"), "xytext": (0, 3 + 10 * row)}
    axes.annotate(name, **place, textcoords="offset points", ha="center", fontsize=8, annotation_clip=False)


def _plain(text: str) -> str:
    """Text in which a dollar sign is one."""
    return text.replace("$", r"\$")


def _add(axes: Any, chart: Chart, one: Series) -> None:
    scale, color, label = chart.scale(), _LIGHT.get(one.style, _LIGHT["ink"]), _plain(one.label).lstrip("_")
    if one.kind == "level":
        axes.axhline(scale(float(one.values[0])), color=color, linewidth=1.0, linestyle="--", label=label)
        return
    if one.kind == "band" and one.upper is not None:
        edges = (scale.factor * edge + scale.zero for edge in (one.values, one.upper))
        axes.fill_between(one.time, *edges, color=color, alpha=0.22, linewidth=0, label=label)
        return
    data = draw.scaled(draw.reduced(chart, one, _BINS), scale)
    width = 0.6 if one.faint else 1.3
    axes.plot(data.time, data.mean, color=color, linewidth=width, linestyle="--" if one.dashed else "-", label=label)
    if data.low is not data.mean:
        axes.fill_between(data.time, data.low, data.high, color=color, alpha=0.22, linewidth=0)
