"""Every channel: where it came from, what it reads, how far it can be trusted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.charts.colors import COLORS
from hfanalysis.products.ingest import ChannelSummary, Ingest
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import tidy
from hfanalysis.wording.scales import SYSTEMS, scale

_CAPTION = "Ranges are those of the good samples. Accuracy: one standard deviation of the bias."
_COLUMNS = ("channel", "column in the log", ">range", ">accuracy", ">zero", ">drift", ">rate", "flagged samples")


def render(material: Material) -> Iterator[Block]:
    """One row per channel."""
    rows = (_row(name, channel) for name, channel in material.need(Ingest).channels.items())
    yield html.table("Sensors", _CAPTION, _COLUMNS, rows)


def _row(name: str, channel: ChannelSummary) -> tuple[Any, ...]:
    unit = channel.unit
    assumed = Markup() if channel.accuracy_stated else Markup(" <em>(assumed)</em>")
    flags = ", ".join(f"{count} {flag}" for flag, count in channel.flags.items()) or "none"
    return (
        _name(name),
        Markup("<bdi>{}</bdi>").format(channel.label),
        _range(channel.least, channel.largest, unit),
        html.amount(channel.accuracy, unit, 3, True) + assumed,
        "–" if channel.zero_std is None else html.amount(channel.zero, unit, 3, True),
        html.amount(channel.drift, unit, 3, True) if channel.drift else "–",
        f"{tidy(channel.rate)} Hz" if channel.rate else "–",
        f"{flags} of {channel.samples}",
    )


def _name(name: str) -> Markup:
    style = name if name in COLORS else "other"
    return Markup('<span class="swatch {}" aria-hidden="true"></span><bdi>{}</bdi>').format(style, name)


def _range(least: float | None, largest: float | None, unit: str) -> Markup:
    if least is None or largest is None:
        return Markup("–")
    scales = (scale(unit, system) for system in SYSTEMS)
    si, team = (f"{tidy(s(least))} … {tidy(s(largest))} {s.unit}".strip() for s in scales)
    return html.both(si, team)


SECTION = Section("Sensors", 80, ("ingest",), render, folded=True)
