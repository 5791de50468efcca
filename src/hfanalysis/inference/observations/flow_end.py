"""Until when the tank empties through the injector in a test whose fuel is gone first.

Then what was noted at the stand is the end of the fire. The flow goes on until the valve closes or the tank is empty:
before either shows in the tank's channels there is nothing to fear from them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.recorded import LONGEST_RECORD, accuracy_of, signal_of
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

AROUND_END = 0.3
"""Seconds before the end of the flow that was noted at the stand from which on nothing is compared."""

WORTH_IT = 0.5
"""Seconds of flow after the end of the fuel from which on they are compared."""

APART = 0.25
"""Seconds by which the ends of liquid and fuel have to lie apart for that: the model keeps to both."""

AT_ONCE = 0.05
"""Standard deviation [s] of the end of the fuel up to which it is one: a fire that fades goes on beyond its middle."""

AFTER_CHANGE = 0.1
"""Seconds after the end of fuel or liquid in which the feed settles."""

WITHOUT_FIRE = 0.1
"""Part of the flow into a chamber without fire by which that of a model may be wrong: nobody knows what pressure the
walls of the chamber make of what still enters. Evidence: in a test without an effect the pressure of a cold chamber was
taken for a choked vapor."""

LOOK_STEP, SPAN = 0.05, 0.5
"""Seconds between the instants that are looked at, and over which a change is sudden."""

LONGEST_GAP = 0.2
"""Seconds without a good sample after which a channel counts as ended: an engineer excludes what follows the valve."""

CLOSED_BEFORE = 0.7
"""Part of its pressure over the tank's, relative to SPAN before, below which p_run shows a line that drains."""

DRAINED = 0.6
"""The same relative to what it was right after the fuel's end, for a line that drains slowly."""

CLOSED_BEHIND = 0.5
"""Part of the feed's loss over the pressure, relative to SPAN before, below which nothing flows through the line."""

STANDS = 0.3
"""Part of the tank's fall, relative to the SPAN before, below which it empties no more."""

CLEAR_LOSS = 2.0
"""How many times the sensors' accuracy a loss has to be before its end can show: zeros wander within it."""

CLEAR_FALL = 1.0
"""The same of the tank's fall or rise over SPAN."""

EMPTY = 0.3e5
"""Excess of the tank's over the ambient pressure [Pa] below which hardly anything flows."""


def flow_end_without_fuel(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> float | None:
    """Until when the tank goes on emptying after the end of the fuel [s]; None where that is not worth following.

    What was noted at the stand is the end of the fuel. Where it is clearly later, it may be that of the flow. Times [s
    after the opening]; ``origin`` [s of the log].
    """
    gone, t_v = segments.time("t_fuel_gone"), segments.time("t_v")
    if gone is None or segments.std("t_fuel_gone") > AT_ONCE or not {"p_tank", "p_run"} <= set(log.channels):
        return None
    if t_v is not None and abs(gone - t_v) < APART:
        return None
    last = gone if t_v is None else max(gone, t_v)
    tank, run = (signal_of(log, name, origin) for name in ("p_tank", "p_run"))
    if tank.dead or run.dead:
        return None
    of_tank, of_run = (accuracy_of(definition, s.name, s.value) for s in (tank, run))
    accuracy = float(np.hypot(of_tank, of_run))
    end = find_flow_end(tank, run, last, definition.ambient_pressure.value, accuracy, segments.time("t_purge"))
    noted = noted_flow_end(definition, 0.0)
    if end is not None and noted > gone + AROUND_END:
        end = min(end, noted)
    return end if end is not None and min(end - AROUND_END, LONGEST_RECORD) > gone + WORTH_IT else None


def noted_flow_end(definition: TestDefinition, end: float) -> float:
    """Until when something flowed, as noted at the stand, but not before ``end``; both [s after the opening]."""
    seen = definition.observed.burn_time if definition.observed is not None else None
    return max(float(seen.value), end) if seen is not None else end


def find_flow_end(
    tank: Signal, run: Signal, after: float, ambient: float, accuracy: float, t_purge: float | None = None
) -> float | None:
    """The earliest instant ``after`` fuel and liquid at which the flow may have ended; None where none can be told.

    ``tank`` and ``run``: the tank's pressure and that ahead of the injector [Pa], with times after the opening, and the
    ``accuracy`` of their difference [Pa]; ``ambient`` [Pa]; instants [s after the opening]. The flow ends where one of
    them is no longer logged, where p_run falls away from the tank's pressure (a valve ahead of it), where it rises to
    it or the tank stops emptying (a valve behind it), or where the tank is empty. Nitrogen that enters from ``t_purge``
    on may hold the tank's pressure as well, but raises it only when nothing leaves.
    """
    start = after + AFTER_CHANGE
    last = min(_logged(signal, start) for signal in (tank, run))
    times = np.arange(start, last - 0.5 * LOOK_STEP, LOOK_STEP)
    if times.size < 2 * round(SPAN / LOOK_STEP) + 1:
        return None
    p_tank, p_run = (_means(signal, times) - ambient for signal in (tank, run))
    ended = (p_tank < EMPTY) | _drains(p_tank, p_run) | _no_loss(p_tank, p_run, CLEAR_LOSS * accuracy)
    held = times > t_purge - SPAN if t_purge is not None else np.zeros(times.size, dtype=bool)
    ended |= _stands(p_tank, CLEAR_FALL * accuracy) & ~held
    ended |= p_tank - _earlier(p_tank) > CLEAR_FALL * accuracy
    return float(times[np.flatnonzero(ended)[0]]) if ended.any() else last


def _logged(signal: Signal, start: float) -> float:
    """Until when a channel is logged without a long gap [s]."""
    time = signal.time[signal.time >= start]
    if time.size == 0 or time[0] > start + LONGEST_GAP:
        return start
    gaps = np.flatnonzero(np.diff(time) > max(LONGEST_GAP, 4.0 * signal.step))
    return float(time[gaps[0]] if gaps.size else time[-1])


def _means(signal: Signal, times: Array) -> Array:
    """Means over LOOK_STEP about instants; between samples that lie farther apart, by interpolation."""
    found = np.array([signal.mean(t - 0.5 * LOOK_STEP, t + 0.5 * LOOK_STEP) for t in times])
    missing = ~np.isfinite(found)
    found[missing] = signal.at(times[missing])
    return found


def _earlier(values: Array) -> Array:
    """What a history was SPAN before; at first, what it began with."""
    back = round(SPAN / LOOK_STEP)
    return np.concatenate([np.full(back, values[0]), values[:-back]])


def _drains(p_tank: Array, p_run: Array) -> NDArray[np.bool_]:
    part = p_run / np.maximum(p_tank, EMPTY)
    first = float(np.median(part[: round(SPAN / LOOK_STEP)]))
    return np.asarray((part < CLOSED_BEFORE * _earlier(part)) | (part < DRAINED * first))


def _no_loss(p_tank: Array, p_run: Array, clear: float) -> NDArray[np.bool_]:
    loss = p_tank - p_run
    part = loss / np.maximum(p_tank, EMPTY)
    return np.asarray((part < CLOSED_BEHIND * _earlier(part)) & (_earlier(loss) > clear))


def _stands(p_tank: Array, clear: float) -> NDArray[np.bool_]:
    """Where the tank begins to stand: its fall over the next SPAN against that over the last."""
    ahead = round(SPAN / LOOK_STEP)
    fell = _earlier(p_tank) - p_tank
    falls = np.concatenate([p_tank[:-ahead] - p_tank[ahead:], np.full(ahead, np.inf)])
    return np.asarray((falls < STANDS * fell) & (fell > clear))
