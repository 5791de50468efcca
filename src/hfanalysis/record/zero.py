"""Zero and tare: what is subtracted from a channel, from the quiet time around the firing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.logspec import ChannelSpec
from hfanalysis.record.quiet import FiringSpan, Level, Trace, after, before, level
from hfanalysis.sentences import said, text
from hfanalysis.units import Value

FAR_FROM_AMBIENT = 50e3
"""[Pa] from ambient at which a quiet reading is no longer the open air, whatever the sensor's accuracy. Evidence:
test_zero.py: a zero far from ambient is refused with a warning."""


@dataclass(frozen=True)
class Zero:
    """What is subtracted from a channel: ``value`` [SI] at the zero, drifting linearly between two times.

    ``std``: standard deviation of the bias left; None where no zero was taken.
    """

    value: float = 0.0
    std: float | None = None
    drift: float = 0.0
    times: tuple[float, ...] = ()
    history: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def at(self, time: Array) -> Array | float:
        """What is subtracted at these times (n,) [s], in the channel's unit [SI]; one number where nothing drifts."""
        if len(self.times) < 2:
            return self.value
        curve: Array = np.interp(time, self.times, (self.value, self.value + self.drift))
        return curve


def ambient_zero(spec: ChannelSpec, trace: Trace, firing: FiringSpan | None, ambient: Value, accuracy: float) -> Zero:
    """The zero [Pa] of a pressure that is open to the air before ignition.

    Args:
        spec: the channel.
        trace: its good samples [s], [Pa].
        firing: when the log departs from rest; None where it does not.
        ambient: pressure [Pa] that the open sensor should read.
        accuracy: standard deviation of the sensor's bias [Pa].
    """
    found, reason = _quiet_level(trace, firing)
    if found is None:
        return _none(f"channel {spec.name}: zero not taken: {reason}")
    error = found.value - ambient.value
    if abs(error) > max(5.0 * accuracy, FAR_FROM_AMBIENT):
        return _none(
            text(
                "channel {name}: zero not taken: it reads {level} in the quiet time, not ambient {ambient}",
                name=spec.name,
                level=said(found.value, "bar", ".3f"),
                ambient=said(ambient.value, "bar", ".3f"),
            )
        )
    std = float(np.hypot(found.std, ambient.std or 0.0))
    return Zero(error, std, history=(f"zero: {error:.6g} Pa taken off, so that {found.time:.3f} s reads ambient",))


def tare(spec: ChannelSpec, trace: Trace, firing: FiringSpan | None) -> Zero:
    """The zero [N or kg] of a load cell: from before the firing, and after it where the cell is at rest again.

    ``trace`` holds its good samples [s], [SI]. A cell that does not come back is for its health to tell.
    """
    first, reason = _quiet_level(trace, firing)
    if first is None or firing is None:
        return _none(f"channel {spec.name}: tare not taken: {reason}")
    only = Zero(first.value, first.std, history=(f"tare: {first.value:.6g} taken off, the level before the firing",))
    if spec.tare == "before":
        return only
    window = after(trace, firing)
    last = level(window) if window is not None else None
    if last is None:
        return _only_before(only, spec)
    return _with_drift(first, last, firing.start)


def _quiet_level(trace: Trace, firing: FiringSpan | None) -> tuple[Level | None, str]:
    if firing is None:
        return None, "no firing found, hence no quiet time before it"
    found = level(before(trace, firing)) if len(trace.time) else None
    return found, f"the quiet time before the firing at {firing.start:.2f} s is too short"


def _only_before(only: Zero, spec: ChannelSpec) -> Zero:
    note = "no settled level after the firing: drift not removed"
    warned = (f"channel {spec.name}: {note}",) if spec.tare == "before_after" else ()
    return Zero(only.value, only.std, history=(*only.history, f"tare: {note}"), warnings=warned)


def _with_drift(first: Level, last: Level, start: float) -> Zero:
    """The drift is linear from the firing's ``start`` [s], before which nothing warms the cell, to the last level."""
    drift = last.value - first.value
    std = float(np.sqrt((first.std**2 + last.std**2) / 2.0))
    history = (f"tare: {first.value:.6g} taken off at {first.time:.3f} s, {last.value:.6g} at {last.time:.3f} s",)
    return Zero(first.value, std, drift, (max(first.time, start), last.time), history)


def _none(warning: str) -> Zero:
    return Zero(history=(warning.split(": ", 1)[1],), warnings=(warning,))
