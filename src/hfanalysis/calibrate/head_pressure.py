"""A chamber pressure that is read aft of the grain: what the injector has behind it, and the nozzle before it.

The gauge reads the static pressure of gas that moves. The nozzle's stagnation pressure follows from the chamber's area,
the head's from the port's, which opens as the fuel burns: in proportion to the impulse of the chamber's pressure, since
a and n are not known yet. A gauge at the head reads what the injector has; where nobody says where it sits, so it is
taken.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import Grain
from hfanalysis.engine.port import heads_over_nozzle, stagnation_over_static
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO

GAMMA = 1.24
"""Heat capacity ratio of burnt nitrous oxide and paraffin [-]. Evidence: equilibrium at 20 bar has it from an O/F of 7
on, 1.31 at 3, with which the head is 1 % of itself higher."""

RECOVERY = 0.5
"""How the flow widens behind the grain, middle of what it may [-]. Source: :mod:`hfanalysis.engine.port`."""


def read_aft(definition: TestDefinition) -> bool:
    """Whether test.toml says that the chamber's gauge sits aft of the grain."""
    channel = definition.channels.get("p_chamber")
    return channel is not None and channel.tap == "aft"


def before_injector(log: TestLog, segments: Segments, definition: TestDefinition) -> TestLog:
    """The log with the head's pressure [Pa] as p_chamber; the same where the gauge is not aft or the port not known."""
    sizes = _sizes(definition)
    if not read_aft(definition) or "p_chamber" not in log or sizes is None:
        return log
    throat, outer, port = sizes
    channel = log["p_chamber"]
    opened = port**2 + (outer**2 - port**2) * _burnt(channel, segments, definition)
    gamma, chamber = np.full(opened.size, GAMMA), pi * outer**2 / throat
    head = heads_over_nozzle(gamma, pi * opened / throat, chamber, RECOVERY)
    return _scaled(log, definition, head * stagnation_over_static(GAMMA, chamber))


def before_nozzle_of(log: TestLog, definition: TestDefinition) -> TestLog:
    """The log with the nozzle's stagnation pressure [Pa] as p_chamber; the same where the gauge is not aft."""
    sizes = _sizes(definition)
    if not read_aft(definition) or "p_chamber" not in log or sizes is None:
        return log
    throat, outer, _ = sizes
    return _scaled(log, definition, np.asarray(stagnation_over_static(GAMMA, pi * outer**2 / throat)))


def _sizes(definition: TestDefinition) -> tuple[float, float, float] | None:
    """Throat area [m^2], outer radius and first port radius of the grain [m]; None where test.toml lacks one."""
    grain, nozzle = definition.grain, definition.nozzle
    if grain is None or nozzle is None or nozzle.throat_radius is None:
        return None
    if grain.mass is None or grain.length is None or grain.density is None or grain.outer_radius is None:
        return None
    outer = grain.outer_radius.value
    made = Grain(grain.length.value, outer, grain.density.value, 0.0, 0.0)
    return pi * nozzle.throat_radius.value**2, outer, made.port_radius(grain.mass.value)


def _burnt(channel: Channel, segments: Segments, definition: TestDefinition) -> Array:
    """Share of the fuel that is burnt [-], (n,) at the channel's samples."""
    ambient, time = definition.ambient_pressure.value, channel.time - (segments.t_open.value or 0.0)
    seen = definition.observed.burn_time.value if definition.observed and definition.observed.burn_time else None
    end = seen or segments.time("t_fuel_gone") or segments.time("t_end") or float(time[-1])
    read = np.where(channel.good, channel.values, np.interp(time, time[channel.good], channel.values[channel.good]))
    push = np.where((time > 0.0) & (time < end), np.maximum(read - ambient, 0.0), 0.0)
    passed = np.concatenate(([0.0], np.cumsum(0.5 * (push[1:] + push[:-1]) * np.diff(time))))
    return passed / passed[-1] if passed[-1] > 0.0 else passed


def _scaled(log: TestLog, definition: TestDefinition, factor: Array) -> TestLog:
    """p_chamber times the factor [-] above CRITICAL_RATIO, where any throat is sonic; less below it, none at rest."""
    channel, ambient = log["p_chamber"], definition.ambient_pressure.value
    flows = np.clip((channel.values / ambient - 1.0) / (CRITICAL_RATIO - 1.0), 0.0, 1.0)
    moved = replace(channel, values=channel.values * (1.0 + flows * (factor - 1.0)))
    return replace(log, channels={**log.channels, "p_chamber": moved})
