"""t_open: the main valve opens. From the valve channel where there is one, else from what the pressures do first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal
from hfanalysis.segment.refine import refine_step

COARSE_STEP = 0.02
"""Spacing of the first look for the opening [s]."""
RISE_TIME = 0.6
"""Over this time [s] the first response to the valve is looked for: filling the line takes 0.1 to 0.9 s. Evidence:
test_opening.py: filling the tank and settling, which are slower, are no opening valve."""

LEADS = {"p_run": 1.0, "p_chamber": 1.0, "p_tank": -1.0, "thrust": 1.0}
"""Channels that respond, in order of how early each shows it, and whether they rise or fall."""

JUMPS = (0.005, 0.013, 0.03, 0.08, 0.2)
"""Time constants tried for what follows a jump that is only a part of the change [s]. Evidence: an injector's drop is
there at once, the chamber's pressure follows; a relaxation alone put such openings up to two samples early."""

AT_ONCE = 0.1
"""Seconds within which chamber or thrust follow the tank where they and not the line show the opening: then the line's
sensor lags or is smoothed, and half the distance is doubt."""

AROUND = 2.5
"""Seconds around the line's first rise in which the tank's own first fall is looked for."""

LATE_RESPONSE = 1.0
"""Seconds by which the pressures may follow the valve's channel: its stroke and the filling of the line."""

SMALLEST_CHANGE = {"p_run": 1e5, "p_chamber": 0.5e5, "p_tank": 1e5, "thrust": 50.0}
"""Changes within RISE_TIME below these [Pa, N] are not an opening valve, whatever the noise. Evidence: a water flow
gives the line two bar and more; interference of 0.1 bar is on record."""

SMALLEST_ALONE = 2.0
"""The same [N] where the thrust is all there is: small motors give tens of newtons."""


@dataclass(frozen=True)
class Opening:
    """The instant [s, log time], its standard deviation and the channels that show it."""

    time: float
    std: float
    channels: tuple[str, ...]


def find_opening(signals: Mapping[str, Signal]) -> Opening | None:
    """The opening of the main valve, or None where no channel shows one.

    Of the valve's own channel and the pressures the one that resolves it best, where the two agree; the valve's
    otherwise. The run line fills from ambient within a second, and the tank falls at the same instant; chamber and
    thrust follow when the line is full. Slow changes before (filling the tank, settling) and the end of the test are
    not as fast or not as large.
    """
    shown = _by_response(signals)
    valve = _valve(signals["valve"], shown) if "valve" in signals else None
    if valve is None or shown is None:
        return valve or shown
    apart = abs(valve.time - shown.time)
    return shown if shown.std < valve.std and apart < LATE_RESPONSE + 3.0 * np.hypot(valve.std, shown.std) else valve


def _by_response(signals: Mapping[str, Signal]) -> Opening | None:
    """Line and tank together; the tank where chamber or thrust change with it, and the line by itself long before."""
    rough = {name: time for name in LEADS if (time := _rough(signals, name)) is not None}
    if not rough:
        return None
    lead = next(iter(rough))
    names = dict.fromkeys(
        (lead, *(n for n in ("p_run", "p_tank") if n in signals and _responds(signals[n], rough[lead])))
    )
    together = _refined([signals[n] for n in names], rough[lead])
    if lead != "p_run" or "p_tank" in names or "p_tank" not in signals:
        return together
    around = {n: s.between(rough[lead] - AROUND, rough[lead] + AROUND) for n, s in signals.items()}
    tank = _rough(around, "p_tank")
    follows = [rough[name] for name in ("p_chamber", "thrust") if name in rough]
    if tank is None or not follows or min(abs(t - tank) for t in follows) > AT_ONCE or tank - rough[lead] < RISE_TIME:
        return together
    sharper = _refined([signals["p_tank"]], tank)
    doubt = 0.5 * abs(sharper.time - together.time)
    return replace(sharper, std=float(np.hypot(sharper.std, doubt)))


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
        value = despiked(signals[name].value)
        start, end = float(np.median(value[:5])), float(np.median(value[-5:]))
        span = float(np.ptp(np.percentile(value, (2.0, 99.5))))
        if start - end > 0.5 * span > 0.5 * SMALLEST_CHANGE[name]:
            return name
    return None


def _valve(signal: Signal, shown: Opening | None) -> Opening | None:
    """The opening by the valve's channel: of several the one nearest to what the pressures show, else the first."""
    low, high = np.percentile(signal.value, (1.0, 99.0))
    if high - low <= 0.0:
        return None
    is_open = signal.value > 0.5 * (low + high)
    opened = np.flatnonzero(np.diff(is_open.astype(int)) > 0) + 1
    if opened.size == 0 or is_open[0]:
        return None
    nearest = opened[0] if shown is None else opened[np.argmin(np.abs(signal.time[opened] - shown.time))]
    before, after = signal.time[nearest - 1], signal.time[nearest]
    return Opening(float(0.5 * (before + after)), float((after - before) / np.sqrt(12.0)), ("valve",))


def _rough(signals: Mapping[str, Signal], name: str) -> float | None:
    """Start of the fastest large change in a channel [s]; None where it has none."""
    if name not in signals or signals[name].time.size < 8:
        return None
    tank = signals["p_tank"].reduced(COARSE_STEP) if "p_tank" in signals else None
    coarse = signals[name].reduced(COARSE_STEP)
    return _start_of_change(coarse, LEADS[name], _threshold(coarse, name, len(signals) == 1), tank)


def _threshold(coarse: Signal, name: str, alone: bool) -> float:
    span = float(np.ptp(np.percentile(coarse.value, (0.5, 99.5))))
    least = SMALLEST_ALONE if alone and name == "thrust" else SMALLEST_CHANGE[name]
    return max(least, 0.15 * span, 12.0 * coarse.noise)


def _start_of_change(coarse: Signal, sign: float, threshold: float, tank: Signal | None) -> float | None:
    value = sign * despiked(coarse.value)
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


def despiked(value: Array) -> Array:
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
    found = refine_step(signals, rough, before, after, max(0.08, 3 * step), 0, JUMPS)
    if found is None:
        return Opening(rough, step, tuple(s.name for s in signals))
    return Opening(found.time, found.std, found.channels)
