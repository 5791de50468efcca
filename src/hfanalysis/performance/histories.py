"""Histories of a hot fire: mixture, regression, flows, thrust; and their file, with the efficiencies."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.performance.flows import HISTORY_STEP, Flows
from hfanalysis.performance.thrust import thrust_of
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.signals import Signal

if TYPE_CHECKING:
    import h5py

BEFORE, AFTER = 2.0, 3.0
"""[s] shown before the opening and after the burn."""

ABOUT = {
    "time": ("s", "time after the valve opening"),
    "of_ratio": ("1", "oxidizer to fuel flow ratio"),
    "regression_rate": ("m/s", "regression rate of the fuel"),
    "port_radius": ("m", "radius of the port"),
    "oxidizer_flow": ("kg/s", "oxidizer mass flow"),
    "fuel_flow": ("kg/s", "fuel mass flow"),
    "c_star": ("m/s", "characteristic velocity: p_c A_t over mass flow, until nitrogen enters"),
    "c_star_efficiency": ("1", "characteristic velocity over that of shifting equilibrium, until nitrogen enters"),
    "c_star_efficiency_frozen": ("1", "characteristic velocity over that of frozen flow, until nitrogen enters"),
    "thrust_coefficient": ("1", "thrust coefficient: thrust over p_c A_t"),
    "thrust_coefficient_efficiency": ("1", "thrust coefficient over that of shifting equilibrium, nozzle full"),
    "thrust_coefficient_efficiency_frozen": ("1", "thrust coefficient over that of frozen flow"),
    "thrust_raw": ("N", "thrust as logged"),
    "thrust_corrected": ("N", "thrust without the cell's zero and drift"),
    "p_chamber": ("Pa", "chamber pressure"),
}
"""Unit and long name of each history."""


@dataclass(frozen=True)
class Histories:
    """Histories by name, all on ``time`` [s after the opening]; NaN where there is nothing to say.

    ``absent`` says why a history is missing.
    """

    time: Array
    values: dict[str, Array]
    absent: dict[str, str] = field(default_factory=dict)


def clock(log: TestLog, segments: Segments, end: float) -> Array:
    """Times of the histories [s after the opening], (n,), to the burn's ``end`` [s] and AFTER it."""
    origin = segments.t_open.value or 0.0
    name = next((n for n in ("thrust", "p_chamber", "p_tank") if n in log), next(iter(log.channels)))
    signal = Signal.of(log[name]).shifted(origin)
    first, last = max(float(signal.time[0]), -BEFORE), min(float(signal.time[-1]), end + AFTER)
    return np.arange(np.ceil(first / HISTORY_STEP), np.floor(last / HISTORY_STEP) + 1.0) * HISTORY_STEP


def measured_histories(log: TestLog, segments: Segments, definition: TestDefinition, time: Array) -> dict[str, Array]:
    """Thrust [N], raw and corrected, and chamber pressure [Pa], (n,) at ``time`` (n,) [s]; those that are logged."""
    out = {}
    if "thrust" in log:
        channel = log["thrust"]
        out["thrust_raw"] = _on(channel, segments, time, channel.raw)
        out["thrust_corrected"] = thrust_of(log, segments, definition).signal.reduced(HISTORY_STEP).at(time)
    if "p_chamber" in log:
        out["p_chamber"] = _on(log["p_chamber"], segments, time, None)
    return out


def _on(channel: Channel, segments: Segments, time: Array, raw: Array | None) -> Array:
    """Block means of the good samples on the histories' clock."""
    from dataclasses import replace

    shown = channel if raw is None else replace(channel, values=raw)
    signal = Signal.of(shown).shifted(segments.t_open.value or 0.0)
    if signal.time.size < 2:
        return np.full(time.size, np.nan)
    return signal.reduced(HISTORY_STEP).at(time)


def flow_histories(flows: Flows) -> dict[str, Array]:
    """Flows [kg/s], regression [m/s], port radius [m] and mixture [-], each (n,); NaN before the opening."""
    lit = flows.time >= 0.0
    found = {
        "oxidizer_flow": flows.oxidizer,
        "fuel_flow": flows.fuel,
        "regression_rate": flows.rate,
        "port_radius": flows.port,
        "of_ratio": flows.of_ratio,
    }
    return {name: np.where(lit, value, np.nan) for name, value in found.items()}


def write_histories(
    path: Path, histories: Histories, provenance: Mapping[str, Any], also: Callable[[h5py.File], None] | None = None
) -> None:
    """Write performance.h5: one time axis, a data set per history, and what ``also`` adds; byte-identical each time."""
    from hfanalysis.products import netcdf

    absent = json.dumps(histories.absent, sort_keys=True)
    with netcdf.product(path, "histories of a hot fire", provenance, absent=absent) as file:
        there = {name: histories.values[name] for name in ABOUT if name in histories.values}
        netcdf.table(file, {"time": histories.time} | there, ABOUT)
        if also is not None:
            also(file)
