"""What the page of a test is made from: the products that there are, and why the others are not."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.report.envelope import Floats
from hfanalysis.report.svg import Event, Phase
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog

EVENTS = ("t_feed", "t_v", "t_purge", "t_fuel_out", "t_end")
_BEFORE, _AFTER = 2.0, 3.0
"""[s] shown before the opening and after the last event."""


@dataclass(frozen=True)
class Residuals:
    """Measured against modelled p_tank of the tank-free run: time [s], all else [Pa]."""

    time: Floats
    measured: Floats
    model: Floats
    residual: Floats
    noise_std: Floats

    def between(self, start: float, end: float) -> Residuals:
        """The part between two instants."""
        part = (self.time >= start) & (self.time <= end)
        return Residuals(*(values[part] for values in vars(self).values()))


@dataclass(frozen=True)
class Material:
    """All that the page shows. ``segments`` and ``calibration`` are None where ``absent`` says why."""

    definition: TestDefinition
    log: TestLog
    ingest: Mapping[str, Any]
    segments: Mapping[str, Any] | None = None
    calibration: Mapping[str, Any] | None = None
    residuals: Residuals | None = None
    absent: Mapping[str, str] | None = None

    @property
    def opening(self) -> float:
        """The instant of the opening [s, log time]; 0 where the log has none, so that charts show log time."""
        return _value(self.segments, "t_open") or 0.0

    def event(self, name: str) -> float | None:
        """An event's instant [s after the opening]."""
        return _value(self.segments, name)


def _value(product: Mapping[str, Any] | None, name: str) -> float | None:
    quantity = (product or {}).get(name) or {}
    value = quantity.get("value")
    return None if value is None else float(value)


def window(material: Material) -> tuple[float, float]:
    """The stretch of time that the charts show [s after the opening]: the firing, or the whole log without one."""
    first = min(float(np.nanmin(c.time)) for c in material.log.channels.values()) - material.opening
    last = max(float(np.nanmax(c.time)) for c in material.log.channels.values()) - material.opening
    if material.segments is None:
        return first, max(last, first + 1.0)
    times = [t for name in EVENTS if (t := material.event(name)) is not None]
    end = max(times) + _AFTER if material.event("t_end") is not None else max([*times, 10.0]) * 1.5 + _AFTER
    return max(first, -_BEFORE), min(last, end)


def event_list(material: Material) -> list[Event]:
    """The events that the test has."""
    if material.segments is None:
        return []
    found = [Event(0.0, material.segments["t_open"].get("std") or 0.0, "t_open")]
    for name in EVENTS:
        time = material.event(name)
        if time is not None:
            found.append(Event(time, material.segments[name].get("std") or 0.0, name))
    return found


def phase_list(material: Material) -> list[Phase]:
    """What flows between one event and the next: the line filling, liquid, vapour, nitrogen; they may overlap."""
    end = material.event("t_end")
    if material.segments is None or end is None:
        return []
    names = ("t_feed", "t_v", "t_purge")
    inner = sorted(t for name in names if (t := material.event(name)) is not None and 0.0 < t < end)
    edges = [0.0, *inner, end]
    return [_phase(material, a, b) for a, b in itertools.pairwise(edges) if b > a]


def _phase(material: Material, start: float, end: float) -> Phase:
    middle = 0.5 * (start + end)
    feed, dry, purge = (material.event(name) for name in ("t_feed", "t_v", "t_purge"))
    nitrogen = purge is not None and middle >= purge
    if feed is not None and middle < feed:
        return Phase(start, end, "line filling", "fill")
    if dry is None or middle < dry:
        return Phase(start, end, "liquid + N₂" if nitrogen else "liquid", "liquid")
    return Phase(start, end, "vapour + N₂" if nitrogen else "vapour", "nitrogen" if nitrogen else "vapor")


def read_residuals(path: Path, group: str = "tank_free/p_tank") -> Residuals | None:
    """The residuals of the tank-free run; None where there are none."""
    if not path.exists():
        return None
    import h5py

    with h5py.File(path, "r") as file:
        if group not in file:
            return None
        data = file[group]
        time = data["time"][:]
        noise = np.broadcast_to(data["noise_std"][()], time.shape).astype(float)
        return Residuals(time, data["measured"][:], data["model"][:], data["residual"][:], noise)
