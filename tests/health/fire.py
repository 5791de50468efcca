"""A made-up firing, healthy: 20 s at 100 Hz, with the noise of ordinary sensors."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tests.record import make

from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log

Columns = dict[str, NDArray[np.float64]]

CHANNELS = {
    "p_tank": ("bar", 'accuracy = "0.15 bar"'),
    "p_run": ("bar", 'accuracy = "0.15 bar"', 'zero = "ambient"'),
    "p_chamber": ("bar", 'accuracy = "0.1 bar"', 'zero = "ambient"'),
    "thrust": ("N", 'accuracy = "7 N"', 'tare = "auto"'),
}
"""Unit and further lines of test.toml of each channel."""


def columns(seed: int = 0) -> Columns:
    """Time [s] and readings: the valve opens at 0, the burn ends at 8 s."""
    time = np.round(np.arange(-5.0, 15.0, 0.01), 4)
    rng = np.random.default_rng(seed)
    on = (time > 0.0) & (time < 8.0)
    fall = np.exp(-np.clip(time, 0.0, 8.0) / 20.0)
    shapes = {
        "p_tank": (60.0 * fall, 0.1),
        "p_run": (np.where(on, 38.0 * fall, 1.0), 0.1),
        "p_chamber": (np.where(on, 20.0 * fall, 1.0), 0.08),
        "thrust": (np.where(on, 2000.0 * fall, 0.0) + 12.0, 8.0),
    }
    return {"time": time} | {name: mean + rng.normal(0.0, std, time.size) for name, (mean, std) in shapes.items()}


def toml(**more: str) -> str:
    """test.toml of the firing; ``more``: further lines of a channel by name."""
    tables = (make.channel(name, *about, *([more[name]] if name in more else [])) for name, about in CHANNELS.items())
    return make.LOG + "\n".join(tables)


def ingested(root: Path, read: Mapping[str, NDArray[np.float64]], text: str = "") -> tuple[TestLog, TestDefinition]:
    """The log of these columns as ingested, and its definition."""
    definition = load_definition(make.write(root, text or toml(), {"log.csv": make.csv(**read)}))
    ingest(definition, root / "ingest.h5")
    return read_log(root / "ingest.h5"), definition
