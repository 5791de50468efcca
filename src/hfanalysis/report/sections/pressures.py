"""Pressures along the feed, from the tank to the chamber."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.charts.chart import Series
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import lines_of, over_time

PRESSURES = {"p_tank": "tank", "p_run": "run line", "p_chamber": "chamber", "p_purge": "purge line", "p_fill": "fill"}
_CAPTION = "Absolute. Line: mean of the samples; lighter: their extremes. Flagged samples are left out."


def series(material: Material) -> Iterator[Series]:
    """Every pressure that the log has."""
    for name, label in PRESSURES.items():
        channel = material.log.get(name)
        if channel is not None:
            yield from lines_of(material, channel, label, name)


def render(material: Material) -> Iterator[Block]:
    """All pressures on one scale."""
    yield over_time(material, "pressures", "Pressures", ("pressure", "Pa"), series(material), _CAPTION, height=380.0)


SECTION = Section("Pressures", 30, (), render)
