"""The tank on its load cell."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.errors import AbsentError
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.sections.thrust import about_zero, cell
from hfanalysis.report.time_charts import over_time


def render(material: Material) -> Iterator[Block]:
    """What hangs on the cell, over time."""
    channel = material.log.get("m_tank")
    if channel is None:
        raise AbsentError("the log has no tank mass")
    words = about_zero(material, channel)
    yield over_time(material, "tank-mass", "Tank mass", ("mass", "kg"), cell(material, channel), words, height=260.0)


SECTION = Section("Tank mass", 45, (), render, folded=True)
