"""A small picture of a test for the index: chamber pressure, else whatever tells a firing best, over the burn."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.report.material import Material, window
from hfanalysis.report.time_charts import of_channel

WIDTH, HEIGHT = 240.0, 44.0
"""Of the box that the line is drawn in [px]."""
_BINS = 80
"""Points of the line: one in three pixels."""
_CHANNELS = ("p_chamber", "thrust", "p_tank", "m_tank")


def spark(material: Material) -> dict[str, Any]:
    """The path of the line in a box of WIDTH by HEIGHT, what it is, and its color; empty where there is nothing."""
    for name in _CHANNELS:
        channel = material.log.get(name)
        path = "" if channel is None or not channel.good.any() else _path(material, name)
        if path:
            return {"path": path, "of": LONG_NAMES[name], "style": name}
    return {}


def _path(material: Material, name: str) -> str:
    start, end = window(material)
    data = of_channel(material, material.log[name]).reduced(start, end, _BINS)
    known = np.isfinite(data.mean)
    if np.count_nonzero(known) < 2:
        return ""
    low, high = np.percentile(data.mean[known], [0.0, 100.0])
    x = (data.time[known] - start) / (end - start) * WIDTH
    y = HEIGHT - 2.0 - (data.mean[known] - low) / ((high - low) or 1.0) * (HEIGHT - 4.0)
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x, y, strict=True))
