"""t_open: the main valve opens. From the valve channel where there is one, else from what the pressures do first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal
from hfanalysis.segment.refine import refine_step

COARSE_STEP = 0.02
"""Spacing of the first look for the opening [s]."""
RISE_TIME = 0.6
"""Over this time [s] the first response to the valve is looked for: filling the line takes 0.1 to 0.9 s. Evidence:
test_opening.py: filling the tank and settling, which are slower, are no opening valve."""

SMALLEST_CHANGE = {"p_run": 3e5, "p_chamber": 0.5e5, "p_tank": 1e5, "thrust": 50.0}
"""Changes within RISE_TIME below these [Pa, N] are not an opening valve, whatever the noise."""


@dataclass(frozen=True)
class Opening:
    """The instant [s, log time], its standard deviation and the channels that show it."""

    time: float
    std: float
    channels: tuple[str, ...]


def find_opening(signals: Mapping[str, Signal]) -> Opening | None:
    """The opening of the main valve, or None where no channel shows one.

    The run line fills from ambient within a second, and the tank falls at the same instant; chamber and thrust follow
    when the line is full. Slow changes before (filling the tank, settling) and the end of the test are not as fast or
    not as large.
    """
    if "valve" in signals and (found := _valve(signals["valve"])) is not None:
        return found
    rough = _rough(signals)
    if rough is None:
        return None
    time, lead = rough
    followers = [
        signals[n] for n in dict.fromkeys((lead, "p_run", "p_tank")) if n in signals and _responds(signals[n], time)
    ]
    return _refined(followers or [signals[lead]], time)


def under_way(signals: Mapping[str, Signal]) -> str | None:
    """The channel that shows a firing already under way in the first sample, where there is one.

    The chamber pressure tells; the thrust only where nothing else is measured, for its sign and zero may be anything.
    """
    alone = not {"p_chamber", "p_run", "p_tank"} & set(signals)
    first = min((float(s.time[0]) for s in signals.values()), default=0.0)
    names: tuple[str, ...] = ("p_chamber", "thrust") if alone else ("p_chamber",)
    for name in names:
        if name not in signals or signals[name].time[0] > first + 0.2:
            continue
        value = _despiked(signals[name].value)
        start, end = float(np.median(value[:5])), float(np.median(value[-5:]))
        span = float(np.ptp(np.percentile(value, (2.0, 99.5))))
        if start - end > 0.5 * span > 0.5 * SMALLEST_CHANGE[name]:
            return name
    return None


def _valve(signal: Signal) -> Opening | None:
    low, high = np.percentile(signal.value, (1.0, 99.0))
    if high - low <= 0.0:
        return None
    opened = np.flatnonzero(signal.value > 0.5 * (low + high))
    if opened.size == 0 or opened[0] == 0:
        return None
    before, after = signal.time[opened[0] - 1], signal.time[opened[0]]
    return Opening(float(0.5 * (before + after)), float((after - before) / np.sqrt(12.0)), ("valve",))


def _rough(signals: Mapping[str, Signal]) -> tuple[float, str] | None:
    """Start of the fastest large change in the first channel that has one, in order of how early it shows."""
    tank = signals["p_tank"].reduced(COARSE_STEP) if "p_tank" in signals else None
    for name, sign in (("p_run", 1.0), ("p_chamber", 1.0), ("p_tank", -1.0), ("thrust", 1.0)):
        if name not in signals or signals[name].time.size < 8:
            continue
        coarse = signals[name].reduced(COARSE_STEP)
        start = _start_of_change(coarse, sign, _threshold(coarse, name), tank)
        if start is not None:
            return start, name
    return None


def _threshold(coarse: Signal, name: str) -> float:
    span = float(np.ptp(np.percentile(coarse.value, (0.5, 99.5))))
    return max(SMALLEST_CHANGE[name], 0.15 * span, 12.0 * coarse.noise)


def _start_of_change(coarse: Signal, sign: float, threshold: float, tank: Signal | None) -> float | None:
    value = sign * _despiked(coarse.value)
    later = np.interp(coarse.time + RISE_TIME, coarse.time, value)
    change = later - value
    if tank is not None and sign > 0.0:
        # what rises together with the tank is being filled, not fired
        rise = tank.at(coarse.time + RISE_TIME) - tank.at(coarse.time)
        change = np.where(rise > 0.25 * SMALLEST_CHANGE["p_tank"] + 6.0 * tank.noise, 0.0, change)
    top = int(np.argmax(change))
    if change[top] < threshold:
        return None
    middle = int(np.searchsorted(coarse.time, coarse.time[top] + RISE_TIME))
    base = slice(int(np.searchsorted(coarse.time, coarse.time[top] - 2.0)), max(top, 1))
    level = float(np.median(value[base])) if top > 0 else float(value[0])
    quiet = float(np.median(np.abs(value[base] - level))) * 1.4826 if top > 0 else 0.0
    limit = level + max(8.0 * quiet, 0.04 * float(change[top]))
    below = np.flatnonzero(value[: middle + 1] <= limit)
    last = int(below[-1]) if below.size else top
    return float(coarse.time[last])


def _despiked(value: Array) -> Array:
    """Running median of five: single wild samples are no opening valve."""
    if value.size < 5:
        return value
    stack = np.lib.stride_tricks.sliding_window_view(np.pad(value, 2, mode="edge"), 5)
    return np.median(stack, axis=1)


def _responds(signal: Signal, time: float) -> bool:
    before = signal.between(time - 0.5, time - 0.05).value
    after = signal.between(time + 0.15, time + 0.4).value
    if before.size < 4 or after.size < 4:
        return False
    change = abs(float(np.median(after) - np.median(before)))
    return change > max(10.0 * signal.noise, 0.3 * SMALLEST_CHANGE.get(signal.name, 0.0))


def _refined(signals: list[Signal], rough: float) -> Opening:
    step = max(s.step for s in signals)
    before, after = max(0.5, 12 * step), max(0.08, 6 * step)
    found = refine_step(signals, rough, before, after, max(0.08, 3 * step), order=0)
    if found is None:
        return Opening(rough, step, tuple(s.name for s in signals))
    return Opening(found.time, found.std, found.channels)
