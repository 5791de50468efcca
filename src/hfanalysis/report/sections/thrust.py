"""Thrust: as the cell gave it, and freed of zero and drift."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.charts.chart import Series
from hfanalysis.charts.svg import value_range
from hfanalysis.errors import AbsentError
from hfanalysis.record.log import Channel
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.names import called
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import lines_of, of_channel, over_time


def render(material: Material) -> Iterator[Block]:
    """The thrust cell."""
    channel = material.log.get("thrust")
    if channel is None:
        raise AbsentError("the log has no thrust")
    yield over_time(
        material, "thrust", "Thrust", ("thrust", "N"), cell(material, channel), about_zero(material, channel)
    )


def cell(material: Material, channel: Channel) -> Iterator[Series]:
    """A weighed or pushed cell: as logged, where a zero was taken off, and corrected."""
    if channel.raw is not None:
        yield of_channel(material, channel, "as logged", "raw", raw=True)
    yield from lines_of(
        material, channel, "corrected" if channel.raw is not None else called(channel.name), channel.name
    )


def about_zero(material: Material, channel: Channel) -> Markup:
    """What was subtracted, and which readings the chart leaves outside."""
    if channel.raw is None:
        return Markup("As logged: no zero was taken.") + _doubts(channel) + beyond(material, channel)
    words = Markup("Zero of {} subtracted").format(html.amount(channel.zero, channel.unit, 3))
    if channel.drift:
        words += Markup("; drift of {} removed, linear in time").format(html.amount(channel.drift, channel.unit, 3))
    return words + Markup(".") + _doubts(channel) + beyond(material, channel)


def _doubts(channel: Channel) -> Markup:
    """What the taking of the zero could not do."""
    said = [text.partition(": ")[2] for text in channel.history if text.startswith("tare: no ")]
    return Markup().join(Markup(" {}.").format(text.capitalize()) for text in said)


def beyond(material: Material, channel: Channel) -> Markup:
    """What a few wild readings leave outside the chart."""
    values = of_channel(material, channel).values
    if not values.size:
        return Markup()
    low, high = value_range([values])
    wild = [float(end) for end in (np.min(values), np.max(values)) if not low <= end <= high]
    ends = Markup(" and ").join(html.amount(end, channel.unit, 3) for end in wild)
    return Markup(" A few readings lie outside the chart, as far as {}.").format(ends) if wild else Markup()


SECTION = Section("Thrust", 40, (), render, folded=True)
