"""The measured thrust over the burn, tare and drift removed, and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.performance.load_cell import left_in
from hfanalysis.performance.measured import cell_error_of
from hfanalysis.performance.thrust import Thrust, burnt_out, thrust_of
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, Flag, TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text

EARLY = 0.5
"""[s] before the burn's end at which the thrust may end and still be flown: the model of a fire that goes out."""


@dataclass(frozen=True)
class MeasuredThrust:
    """Thrust [N] at increasing times [s after opening] over the burn, which starts at 0.

    ``bias_std`` [N]: of its zero and of the course of its drift; ``drift_std`` [N]: of what of its drift is left in at
    the burn's end; ``gain_std``: relative.
    """

    time: Array
    thrust: Array
    bias_std: float
    drift_std: float
    gain_std: float
    notes: tuple[str, ...]

    @property
    def burn_time(self) -> float:
        """From the opening to the burn's end [s]."""
        return float(self.time[-1])


def measured_thrust(log: TestLog, segments: Segments | None, definition: TestDefinition) -> MeasuredThrust:
    """The thrust from the valve's opening to the burn's end, the same that the performance table has.

    Raises AbsentError where the log has no thrust or no firing.
    """
    channel = log["thrust"]
    if Signal.of(channel).dead:
        raise AbsentError(f"test {definition.test.id}: the thrust channel is dead; there is nothing to fly")
    if segments is None or segments.t_open.value is None:
        raise AbsentError(f"test {definition.test.id}: no valve opening is known to count the thrust from")
    found = thrust_of(log, segments, definition)
    _check_whole(channel, segments, definition, float(found.signal.time[-1]))
    end, of = burn_end(segments, definition, found.signal)
    burn = found.signal.between(0.0, end)
    if burn.time.size < 8:
        raise AbsentError(f"test {definition.test.id}: the log has {burn.time.size} samples of thrust over the burn")
    time = np.unique(np.concatenate(([0.0], burn.time, [end])))
    notes = (f"burn from the opening to {end:.2f} s: {of}", *_drift_taken(found))
    off = cell_error_of(log, found, definition, end)
    bias = float(np.hypot(off.zero, off.course))
    return MeasuredThrust(time, found.signal.at(time), bias, off.left, off.gain, notes)


def _check_whole(channel: Channel, segments: Segments, definition: TestDefinition, last: float) -> None:
    """Raise AbsentError where the cell goes on in the burn after ``last`` [s] and means nothing there."""
    lost = channel.time[(channel.flags & Flag.UNUSABLE) != 0] - (segments.t_open.value or 0.0)
    whole = float(channel.time[-1]) - (segments.t_open.value or 0.0)
    end, _ = _told_end(segments, definition, whole) or (whole, "")
    if (lost > last).any() and end > last + EARLY:
        raise AbsentError(
            f"test {definition.test.id}: the thrust is not usable from {last:.2f} s on, before the burn ends "
            f"({end:.2f} s): there is no whole thrust to fly"
        )


def _drift_taken(thrust: Thrust) -> tuple[str, ...]:
    taken = thrust.error - left_in(thrust)
    if abs(taken) < 0.5:
        return ()
    return (text("{taken} of the load cell's drift taken off over the burn", taken=said(taken, "N", ".0f")),)


def burn_end(segments: Segments, definition: TestDefinition, thrust: Signal) -> tuple[float, str]:
    """When thrust ends [s after opening], and who says so; ``thrust`` [N] with its zero taken off.

    The engineer, else the later of chamber and fuel, else the thrust itself, else the log.
    """
    last = float(thrust.time[-1])
    if (told := _told_end(segments, definition, last)) is not None:
        return told
    gone = burnt_out(thrust)
    return (gone[0], "the thrust's own end") if gone is not None else (last, "the log's end")


def _told_end(segments: Segments, definition: TestDefinition, last: float) -> tuple[float, str] | None:
    """When thrust ends by the engineer or by the later of chamber and fuel, if that is before the ``last`` instant."""
    observed = definition.observed.burn_time if definition.observed is not None else None
    if observed is not None and observed.value <= last:
        return observed.value, "[observed] burn_time"
    found = {name: segments.time(name) for name in ("t_fuel_gone", "t_end")}
    times = {name: time for name, time in found.items() if time is not None and 0.0 < time <= last}
    name = max(times, key=lambda key: times[key], default=None)
    return None if name is None else (times[name], name)
