"""The thrust as the burn saw it: the cell's zero is also known where the chamber is back at ambient pressure.

Ingest takes the tare from quiet times before and after the firing. A cell that was heated takes minutes to settle, so
that many a log ends before there is such a time; but an engine without chamber pressure has no thrust, and what the
cell then reads is its error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.flight.motor import OUT
from hfanalysis.performance.stand import without_stand
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

AT_AMBIENT = 0.04
"""Chamber pressure above ambient, relative, below which the thrust is nothing. Source: a nozzle that is not choked
gives 0.1 p_a A_t or less."""

LONG_ENOUGH = 0.5
"""[s] at ambient pressure from which on the cell's reading counts."""

FIRST = 2.0
"""[s] from the return to ambient pressure on, over which the cell's error is read."""

CELL_SMOOTHING = 0.5
"""[s] of the running mean of the cell after the burn."""

NOTICEABLE = 0.02
"""Part of the largest thrust from which on a reading without chamber pressure is the cell's error. Evidence:
test_thrust.py: a cell that reads next to nothing is left alone."""


FADED = (0.1, 0.025)
"""Parts of it [-] between which it passes OUT: how well that instant is told."""


@dataclass(frozen=True)
class Thrust:
    """Good samples of the thrust [N] over time [s after the opening].

    ``error`` [N]: what the cell reads beyond its zero before the firing once the chamber is at ambient pressure, from
    ``since`` [s] on (NaN where the log does not show it).
    """

    signal: Signal
    error: float
    since: float


def thrust_of(log: TestLog, segments: Segments, definition: TestDefinition) -> Thrust:
    """The thrust [N] without the cell's drift, and without what the stand puts on the cell beside it.

    Raises AbsentError where the log has none.
    """
    found = _without_drift(log, segments, definition)
    removed = bool(log["thrust"].drift) or bool(np.isfinite(found.since))
    return replace(found, signal=without_stand(found.signal, log, segments, definition, removed))


def _without_drift(log: TestLog, segments: Segments, definition: TestDefinition) -> Thrust:
    channel, origin = log["thrust"], segments.t_open.value or 0.0
    signal = Signal.of(channel).shifted(origin)
    since = _at_ambient(log, segments, definition)
    rest = signal.between(since, np.inf) if since is not None else signal.between(np.inf, np.inf)
    if since is None or rest.time.size < 8 or np.ptp(rest.time) < LONG_ENOUGH:
        return Thrust(signal, channel.drift, np.nan)
    raw = signal if channel.raw is None else Signal.of(replace(channel, values=channel.raw)).shifted(origin)
    error, left = (float(np.median(s.between(since, since + FIRST).value)) for s in (raw, signal))
    error -= channel.zero if channel.raw is not None else 0.0
    peak = float(np.percentile(signal.between(0.0, since).value, 99.0))
    if abs(left) < NOTICEABLE * abs(peak):
        return Thrust(signal, error, since)
    return Thrust(replace(signal, value=signal.value - _drift(signal, rest, since)), error, since)


def _drift(signal: Signal, rest: Signal, since: float) -> Array:
    """What is left in the cell: linear from the opening to where the chamber is at ambient, then as it reads."""
    smooth = rest.smooth(max(CELL_SMOOTHING, 3.0 * rest.step))
    time = np.concatenate(([0.0, since], rest.time[rest.time > since]))
    value = np.concatenate(([0.0, smooth[0]], smooth[rest.time > since]))
    return np.interp(signal.time, time, value, left=0.0)


def _at_ambient(log: TestLog, segments: Segments, definition: TestDefinition) -> float | None:
    """From when on the chamber stays at ambient pressure [s]; None where it does not, or is not measured from there."""
    channel = log.get("p_chamber")
    if channel is None or channel.zero_std is None:
        return None
    chamber = Signal.of(channel).shifted(segments.t_open.value or 0.0).between(0.0, np.inf)
    if chamber.time.size < 8:
        return None
    smooth = chamber.smooth(max(CELL_SMOOTHING, 3.0 * chamber.step))
    fire = np.flatnonzero(smooth > (1.0 + AT_AMBIENT) * definition.ambient_pressure.value)
    if not fire.size or fire[-1] >= smooth.size - 8:
        return None
    return float(chamber.time[fire[-1] + 1])


def burnt_out(signal: Signal) -> tuple[float, float] | None:
    """When the thrust is gone for good [s after the opening] and its standard deviation [s]; None where it is not.

    ``signal``: the thrust [N], its zero taken off.
    """
    after = signal.between(0.0, np.inf)
    if after.time.size < 16:
        return None
    width = 3.0 * after.step
    smooth = after.smooth(width)
    peak = float(smooth.max())
    if peak <= 10.0 * signal.noise:
        return None
    first, last, late = (int(np.flatnonzero(smooth > part * peak)[-1]) for part in (FADED[0], OUT, FADED[1]))
    if last >= smooth.size - 8:
        return None
    told = after.time[min(late + 1, smooth.size - 1)] - after.time[first]
    return float(after.time[last + 1]), float(np.hypot(width, 0.5 * told) / np.sqrt(12.0))
