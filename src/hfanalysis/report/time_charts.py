"""Charts of a test over time: with its phases and events, within the page's window."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from markupsafe import Markup

from hfanalysis.charts.chart import LOG_TIME, TIME, Chart, Series
from hfanalysis.record.log import Channel, Flag
from hfanalysis.report.material import Material, event_list, phase_list, window
from hfanalysis.report.names import called


def over_time(
    material: Material,
    key: str,
    title: str,
    axis: tuple[str, str],
    series: Iterable[Series],
    caption: str | Markup = "",
    *,
    span: tuple[float, float] | None = None,
    height: float = 300.0,
    with_zero: bool = True,
    value_span: tuple[float, float] | None = None,
    difference: bool = False,
    weight: float = 1.0,
    repeats: bool = False,
) -> Chart | None:
    """A chart over the test's phases and events; None where no series has anything to draw.

    Args:
        material: the test.
        key: the chart's name in files and addresses.
        title: its heading.
        axis: (quantity, SI unit) of the values.
        series: what is drawn.
        caption: below it; text is escaped.
        span: of time [s]; by default the page's window.
        height: in pixels at a width of 960.
        with_zero: whether zero belongs to the value axis.
        value_span: of the value axis, where the data should not set it.
        difference: whether the values are differences.
        weight: of the chart's lines where the page's detail is shared out.
        repeats: whether another chart of the page shows its lines as well.
    """
    kept = tuple(one for one in series if one.finite)
    if not any(one.kind == "line" for one in kept):
        return None
    return Chart(
        key,
        title,
        *axis,
        kept,
        span or window(material),
        Markup.escape(caption),
        tuple(phase_list(material)),
        tuple(event_list(material)),
        TIME if material.fired else LOG_TIME,
        height,
        with_zero,
        value_span,
        difference=difference,
        weight=weight,
        repeats=repeats,
    )


def lines_of(
    material: Material, channel: Channel, label: str = "", style: str = "other", raw: bool = False
) -> Iterator[Series]:
    """A channel's good samples within the page's window, and dashed what its health leaves out, where there is that."""
    yield of_channel(material, channel, label, style, raw)
    lost = (channel.flags & Flag.UNUSABLE) != 0
    if lost.any():
        values = channel.raw if raw and channel.raw is not None else channel.values
        start, end = window(material)
        time = channel.time - material.opening
        part = (time >= start) & (time <= end)
        left = np.where(lost & ((channel.flags & Flag.DROPOUT) == 0), values, np.nan)[part]
        yield Series(f"{label or called(channel.name)}, not used", style, time[part], left, dashed=True, faint=True)


def broken(material: Material, line: Series) -> Series:
    """A line that a tank's liquid makes, broken where that is gone: what it reads before says nothing of after."""
    gone = material.event("t_v")
    inside = gone is not None and line.time.size and line.time[0] < gone < line.time[-1]
    if gone is None or not inside:
        return line
    at = int(np.searchsorted(line.time, gone, side="right"))
    upper = None if line.upper is None else np.insert(line.upper, at, np.nan)
    return replace(line, time=np.insert(line.time, at, gone), values=np.insert(line.values, at, np.nan), upper=upper)


def of_channel(
    material: Material, channel: Channel, label: str = "", style: str = "other", raw: bool = False
) -> Series:
    """A channel's good samples within the page's window."""
    values = channel.raw if raw and channel.raw is not None else channel.values
    start, end = window(material)
    time = channel.time - material.opening
    part = channel.good & (time >= start) & (time <= end)
    return Series(label or called(channel.name), style, time[part], values[part])
