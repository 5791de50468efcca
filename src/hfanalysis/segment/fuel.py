"""t_fuel_out: the solid fuel is gone; chamber pressure and thrust fall together while the feed does not change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.segment.refine import refine_step
from hfanalysis.segment.signals import Array, Signal, sample_noise

GRID = 0.01
WINDOW = 0.3
"""Seconds looked at on either side of a sudden fall."""

GAP = 0.04
"""Seconds left out on either side of it: the chamber empties and the smoothing spreads within these."""

SUDDEN_FALL = 0.3
"""Least part of the chamber's response that has to go at once."""

SMALLEST_FALL = 0.1e5
"""Least size of a sudden fall [Pa]: near ambient the wander of the sensor looks the same."""

SUDDEN = 0.2
"""A sudden fall is over within this time [s]."""

RESIDENCE = 0.006
"""Standard deviation [s] of how far the pressure lags the end of the fuel: the chamber has to flush first."""

CLEAR_FALL = 8.0
"""Least size of a sudden fall in standard deviations of its own scatter."""

FADE_FALL = 0.3
"""Least fall of ln of the response over a fade in the liquid phase."""

FADE_THRUST = 0.1
"""Least part of the thrust that has to go with it: a third of the pressure's, for the cell drifts with heat."""

CLEAR = 0.08e5
"""Chamber pressure above ambient [Pa] below which nothing can be said of the fire."""


@dataclass(frozen=True)
class FuelEnd:
    """t_fuel_out [s] with its standard deviation, and how long the fall takes [s]."""

    time: float
    std: float
    duration: float


@dataclass(frozen=True)
class _Response:
    """(p_c - p_a) sqrt(median dp / dp) [Pa] on a grid of times, and the scatter of a grid value."""

    time: Array
    value: Array
    noise: float


def find_fuel_end(
    signals: Mapping[str, Signal], ambient: float, t_feed: float, t_v: float | None, end: float
) -> FuelEnd | str:
    """When the fuel is gone, from signals with time counted from the opening; else the reason why it does not show.

    The chamber's response to the feed is (p_c - p_a) / sqrt(p_run - p_c): steady while the fire burns, two to five
    times smaller without it. At the end of the liquid (``t_v``) the feed itself changes, and windows do not reach
    across.
    """
    if "p_run" not in signals:
        return "without p_run a fall of the chamber pressure cannot be told from one of the feed"
    response = _response(signals, ambient, end)
    if response is None:
        return "the chamber pressure is not above ambient for long enough"
    sudden = _sudden(response, t_feed, t_v)
    if sudden is not None and _thrust_falls(
        signals, (sudden - WINDOW, sudden - GAP), (sudden + GAP, sudden + WINDOW), 0.03
    ):
        dated = _dated(signals, sudden, t_v)
        if dated.duration <= SUDDEN:
            return dated
    fade = _fade(response, t_feed, t_v) if t_v is not None else None
    if fade is not None and t_v is not None:
        start = t_v - 0.1 - fade.duration
        if _thrust_falls(signals, (start - WINDOW, start), (t_v - 0.1 - GAP, t_v - GAP), FADE_THRUST):
            return fade
    last = float(response.time[-1])
    return (
        f"chamber pressure and thrust do not fall against the feed up to {last:.1f} s, where the chamber nears ambient"
    )


def _response(signals: Mapping[str, Signal], ambient: float, end: float) -> _Response | None:
    chamber, run = signals["p_chamber"], signals["p_run"]
    width = max(0.03, 2.0 * chamber.step)
    grid = np.arange(0.1, min(end, chamber.time[-1], run.time[-1]), max(GRID, chamber.step))
    excess = np.interp(grid, chamber.time, chamber.smooth(width)) - ambient
    drop = np.interp(grid, run.time, run.smooth(width)) - ambient - excess
    fire = (excess > CLEAR) & (drop > 0.2e5)
    if fire.sum() < 20:
        return None
    stop = min(int(np.flatnonzero(fire)[-1]) + int(WINDOW / GRID), grid.size)
    drop = np.maximum(drop[:stop], 0.2e5)
    value = excess[:stop] * np.sqrt(np.median(drop) / drop)
    return _Response(grid[:stop], value, sample_noise(value))


def _sudden(response: _Response, t_feed: float, t_v: float | None) -> float | None:
    best, at = 0.0, None
    for t in response.time[(response.time > t_feed + 0.2) & (response.time < response.time[-1] - 0.1)]:
        size = _fall_at(response, float(t), t_v)
        if size > best:
            best, at = size, float(t)
    return at


def _fall_at(response: _Response, t: float, t_v: float | None) -> float:
    """Size of a sudden fall at t in standard deviations; 0 where it is too small, unclear, or the windows too short."""
    start, end = t - WINDOW, t + WINDOW
    if t_v is not None:
        start = max(start, t_v + GAP) if t > t_v else start
        end = min(end, t_v - GAP) if t < t_v else end
    a, b, c, d = np.searchsorted(response.time, (start, t - GAP, t + GAP, end))
    if b - a < 6 or d - c < 4:
        return 0.0
    left, right = response.value[a:b], response.value[c:d]
    x = response.time[a:b] - response.time[a:b].mean()
    slope = float(x @ left / (x @ x))
    ahead = float(response.time[c:d].mean() - response.time[a:b].mean())
    predicted = float(left.mean()) + min(slope, 0.0) * ahead
    fall = predicted - float(right.mean())
    scatter = np.hypot(float((left - left.mean() - slope * x).std()), float(right.std()))
    error = max(scatter, response.noise) * np.sqrt(3.0 / (b - a) + 1.0 / (d - c))
    clear = fall > max(SUDDEN_FALL * predicted, SMALLEST_FALL, CLEAR_FALL * error)
    return float(fall / error) if clear else 0.0


def _thrust_falls(
    signals: Mapping[str, Signal], early: tuple[float, float], late: tuple[float, float], share: float
) -> bool:
    """Whether the thrust, where it is measured, falls by this share between two intervals [s], beyond scatter."""
    if "thrust" not in signals:
        return True
    thrust = signals["thrust"]
    before, after = thrust.between(*early).value, thrust.between(*late).value
    if before.size < 4 or after.size < 4:
        return True
    error = 2.0 * np.hypot(before.std() / np.sqrt(before.size), after.std() / np.sqrt(after.size))
    return bool(before.mean() - after.mean() > max(share * abs(before.mean()), error))


def _dated(signals: Mapping[str, Signal], rough: float, t_v: float | None) -> FuelEnd:
    chamber = signals["p_chamber"]
    reach = max(0.1, 4.0 * chamber.step)
    before = min(WINDOW, rough - t_v - GAP) if t_v is not None and rough > t_v else WINDOW
    found = refine_step([chamber], rough, max(before, 3.0 * chamber.step), WINDOW, reach)
    if found is None:
        return FuelEnd(rough, GRID, 0.0)
    return FuelEnd(found.time, float(np.hypot(found.std, RESIDENCE)), 3.0 * found.relaxation)


def _fade(response: _Response, t_feed: float, t_v: float) -> FuelEnd | None:
    """The fuel thins out before the liquid is gone: level, then a fall that goes on to t_v."""
    part = (response.time > t_feed + 0.2) & (response.time < t_v - 0.1)
    t, y = response.time[part], np.log(np.maximum(response.value[part], CLEAR))
    if t.size < 30:
        return None
    level = float(np.median(y[: t.size // 3]))
    last = float(np.median(y[-5:]))
    if level - last < FADE_FALL:
        return None
    start = _crossing(t, y, level - 0.15 * (level - last))
    half = _crossing(t, y, 0.5 * (level + last))
    duration = float(t[-1] - start)
    if duration > 0.6 * (t[-1] - t[0]):
        return None
    return FuelEnd(half, max(duration / np.sqrt(12.0), GRID), duration)


def _crossing(t: Array, y: Array, level: float) -> float:
    above = np.flatnonzero(y > level)
    return float(t[above[-1]]) if above.size else float(t[0])
