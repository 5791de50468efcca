"""Temperatures, and channels that have no place of their own."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from hfanalysis.charts.chart import Chart
from hfanalysis.charts.colors import style_of
from hfanalysis.errors import AbsentError
from hfanalysis.record.channels import CANONICAL, LONG_NAMES
from hfanalysis.record.log import Channel
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.sections.pressures import PRESSURES
from hfanalysis.report.time_charts import lines_of, over_time
from hfanalysis.wording.numbers import in_words

_ELSEWHERE = {*PRESSURES, "thrust", "m_tank"}
_MOST = 6
"""Lines in one chart; more could not be told apart."""


def render(material: Material) -> Iterator[Block]:
    """Temperatures in one chart; of the others those that share a unit."""
    groups: dict[str, list[Channel]] = {}
    for name, channel in material.log.channels.items():
        if name not in _ELSEWHERE and np.isfinite(channel.values).any():
            groups.setdefault(channel.unit, []).append(channel)
    if not groups:
        raise AbsentError("the log holds no other channels")
    for unit, channels in groups.items():
        for first in range(0, len(channels), _MOST):
            yield _chart(material, unit, channels[first : first + _MOST])


def _chart(material: Material, unit: str, channels: list[Channel]) -> Chart | None:
    warm = all(CANONICAL.get(channel.name) == "temperature" for channel in channels) or unit == "K"
    title = "Temperatures" if warm else ", ".join(in_words(channel.name) for channel in channels)
    lines = [
        line
        for number, channel in enumerate(channels)
        for line in lines_of(
            material, channel, LONG_NAMES.get(channel.name, channel.name), style_of(channel.name, number)
        )
    ]
    key = re.sub(r"\W+", "-", f"other-{channels[0].name}")[:60]
    quantity = "temperature" if warm else "reading"
    return over_time(material, key, title, (quantity, unit), lines, height=260.0, with_zero=not warm)


SECTION = Section("Temperatures and other channels", 62, (), render, folded=True)
