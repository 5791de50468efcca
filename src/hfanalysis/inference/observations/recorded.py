"""What the sensors of a test recorded, as it is compared: which channels, how accurate they are, and until when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel as LogChannel
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

CHANNELS = ("p_tank", "p_run", "p_chamber", "thrust", "m_tank")
"""Canonical channels that are compared."""

TOGETHER = ("p_chamber", "thrust")
"""Channels that share the oscillation of the burn."""

ALIKE = ("p_tank", "p_purge")
"""Channels that show one pressure, where a purge line follows the tank through its check valve."""

LONGEST_RECORD = 30.0
"""Seconds before the opening and after it beyond which nothing is looked at."""

TANK_CELL = 0.03
"""Part of the loaded mass by which the tank's cell may be off at rest and still be compared."""


def recorded(log: TestLog, definition: TestDefinition, origin: float) -> dict[str, Signal]:
    """Signals of CHANNELS that are not dead, by name, their times [s] after the opening at ``origin``.

    The tank's cell is left out where it does not read what was loaded. ``origin`` [s of the log]; values [SI].
    """
    found = {name: signal_of(log, name, origin) for name in CHANNELS if name in log}
    if "m_tank" in found and not _cell_reads(found["m_tank"], definition):
        del found["m_tank"]
    return {name: signal for name, signal in found.items() if not signal.dead}


def signal_of(log: TestLog, name: str, origin: float) -> Signal:
    """A channel as read [SI], times [s] after the opening at ``origin`` [s of the log]."""
    return Signal.of(as_read(log[name])).shifted(origin)


def as_read(channel: LogChannel) -> LogChannel:
    """A channel [SI] with its zero taken off but not the drift that ingest removes: a drift is an effect to be
    found."""
    if channel.drift == 0.0 or channel.raw is None:
        return channel
    return replace(channel, values=channel.raw - channel.zero)


def _cell_reads(cell: Signal, definition: TestDefinition) -> bool:
    """Whether the tank's cell at rest reads what is loaded."""
    loaded = definition.tank.oxidizer_mass if definition.tank is not None else None
    still = cell.between(-LONGEST_RECORD, -0.1).value
    if loaded is None or still.size < 8:
        return False
    return abs(float(np.median(still)) - loaded.value) < TANK_CELL * loaded.value


def accuracy_of(definition: TestDefinition, name: str, value: Array) -> float:
    """Stated accuracy [SI] of a channel with these values (n,) [SI]; where none is stated, 0.25 % of the largest."""
    stated = definition.channels[name].accuracy if name in definition.channels else None
    return stated.value if stated is not None else 2.5e-3 * float(np.abs(value).max())


def log_start(log: TestLog, origin: float) -> float:
    """Where the log begins [s after the opening], below zero; ``origin``: of the opening [s of the log]."""
    return min(float(log[name].time.min()) for name in CHANNELS if name in log) - origin


def log_end(log: TestLog, origin: float) -> float:
    """Where the log ends [s after the opening at ``origin``]: beyond it nothing is compared, and no model need run."""
    return max(float(log[name].time.max()) for name in CHANNELS if name in log) - origin
