"""A fire that ends at once: the fuel is gone, and chamber and thrust fall within hundredths of a second."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.record.signals import Signal
from hfanalysis.segment.breaks import Break
from hfanalysis.segment.fade import date_fall
from hfanalysis.segment.falls import RELAXATION, abrupt_falls
from hfanalysis.segment.fire import GAP, GRID, SMOOTH, WINDOW, Response, response_of, thrust_falls
from hfanalysis.segment.refine import refine_step

SUDDEN_FALL = 0.3
"""Least part of the chamber's response that has to go at once. Evidence: test_fuel_bounds.py: a fall of a fifth is no
end of the fuel; without fire the response is two to five times smaller."""

SMALLEST_FALL = 0.1e5
"""Least size of a sudden fall [Pa]: near ambient the wander of the sensor looks the same. Evidence:
test_fuel_bounds.py: a fall of a twentieth of a bar is the wander of a sensor."""

SUDDEN = 0.2
"""A sudden fall is over within this time [s]. Evidence: test_events.py: a chamber that empties slowly after the liquid
is no end of the fuel."""

RESIDENCE = 0.006
"""Standard deviation [s] of how far the pressure lags the end of the fuel: the chamber has to flush first. Evidence:
the residence time of a chamber is milliseconds (docs/validation.md)."""

SHARPLY_DATED = 0.01
"""Standard deviation [s] within which a sudden fall has to be dated. Evidence: the bend where the chamber nears ambient
was taken for an end of the fuel (test_events.py)."""

CLOSE = 0.012
"""Seconds left out before a fall, and before t_v, where the two are close and the pressure is hardly smoothed.
Evidence: test_events.py: the two are told apart from 0.08 s on."""

CLOSE_FALL = 0.2
"""Least part of the response, and of the thrust, that has to go at once close to t_v. Evidence: test_events.py: near
the end of the liquid too the thrust has to fall with the chamber."""

SHORT = 0.03
"""Least length [s] of what is seen between t_v and a fall close to it. Evidence: test_events.py: from 0.08 s on fuel
and liquid are told apart."""

OUT_LEVEL, OUT_AFTER = 0.06, 0.15
"""Seconds [s] over which the chamber's level is taken before a fire goes out, and after it."""

OUT = 0.5
"""Least part of the chamber's level, and of the thrust, that goes at once where a fire goes out. Evidence:
test_events.py: a fire that fades is dated where what is left of it goes out, one that fades to its end at no
instant."""

FEED_FALLS, FEED_RISES = 0.12, 0.02
"""Parts of the feed's pressure by which it may change meanwhile: a tank empties by some percent in OUT_AFTER. Evidence:
test_events.py: where the feed ends, a fire goes out with fuel left."""

LEAST_DROP_LEFT = 0.8
"""Part of the drop over the injector that is left at least where the fuel ends: it grows, for the chamber falls."""

AT_ONCE = 0.05
"""Seconds within which the chamber of a fire that goes out has flushed."""

CLEAR_FALL = 8.0
"""Least size of a sudden fall in standard deviations of its own scatter."""

BLURRED = 0.03
"""Standard deviation [s] of t_v from which on no step of chamber or thrust dates it: a sudden fall within its interval
is then its own."""


@dataclass(frozen=True)
class Sudden:
    """A sudden end [s] with its standard deviation, and when the fall is over [s] with its."""

    time: float
    std: float
    gone: float
    gone_std: float


def sudden_end(
    signals: Mapping[str, Signal],
    response: Response,
    ambient: float,
    t_feed: float,
    liquid_out: tuple[float, float] | None,
    end: float,
) -> Sudden | None:
    """A fall at once that is no fall of the liquid's end."""
    t_v, std = liquid_out if liquid_out is not None else (None, 0.0)
    sudden = _sudden(signals, response, t_feed, t_v)
    if sudden is None and t_v is not None and std < BLURRED:
        sudden = _close(signals, ambient, end, t_feed, t_v)
    if sudden is None or _is_liquids(sudden, t_v, std):
        sudden = _goes_out(signals, ambient, t_feed, t_v, float(response.time[-1]))
    return None if sudden is None or _is_liquids(sudden, t_v, std) or not _feed_goes_on(signals, sudden) else sudden


def _feed_goes_on(signals: Mapping[str, Signal], sudden: Sudden) -> bool:
    """Whether the drop over the injector is still there after the fall: where a valve shuts, it is gone."""
    before, after = (
        signals["p_run"].mean(*span) - signals["p_chamber"].mean(*span)
        for span in (
            (sudden.time - GAP - SMOOTH, sudden.time - 0.5 * GAP),
            (sudden.gone + GAP, sudden.gone + OUT_AFTER),
        )
    )
    return not after < LEAST_DROP_LEFT * before


def _is_liquids(sudden: Sudden, t_v: float | None, std: float) -> bool:
    return t_v is not None and std >= BLURRED and abs(sudden.time - t_v) < WINDOW + 2.0 * std


def _close(signals: Mapping[str, Signal], ambient: float, end: float, t_feed: float, t_v: float) -> Sudden | None:
    """A sudden fall so close to t_v that only the hardly smoothed pressure tells the two apart."""
    response = response_of(signals, ambient, end, 0.25 * SMOOTH, 0.4 * GRID)
    if response is None:
        return None
    near = np.abs(response.time - t_v) < WINDOW + GAP
    seen = [_close_fall(response, float(t), t_v) for t in response.time[near & (response.time > t_feed + 0.2)]]
    best = max(seen, default=None, key=lambda fall: fall.size)
    if best is None or best.size == 0.0:
        return None
    if not _thrust_steps(signals, best):
        return None
    return _dated(signals, 0.5 * (best.before[1] + CLOSE + best.after[0] - GAP), t_v)


@dataclass(frozen=True)
class _Fall:
    """A fall's size in standard deviations (0 where it is none), and the intervals [s] before and after it."""

    size: float
    before: tuple[float, float]
    after: tuple[float, float]


def _close_fall(response: Response, t: float, t_v: float) -> _Fall:
    """A fall at t, close to t_v. One slope for both sides, of the longer: a short one cannot tell slope from ripple."""
    before = (max(t - WINDOW, t_v + GAP) if t > t_v else t - WINDOW, t - CLOSE)
    after = (t + GAP, min(t + WINDOW, t_v - CLOSE) if t < t_v else t + WINDOW)
    nothing = _Fall(0.0, before, after)
    a, b, c, d = np.searchsorted(response.time, (*before, *after))
    if min(before[1] - before[0], after[1] - after[0]) < SHORT or min(b - a, d - c) < 4:
        return nothing
    level, fall, error = _step(response.time, response.value, before, after, response.noise)
    clear = fall > max(CLOSE_FALL * level, SMALLEST_FALL, CLEAR_FALL * error)
    return _Fall(fall / error, before, after) if clear else nothing


def _step(
    time: Array, value: Array, before: tuple[float, float], after: tuple[float, float], noise: float
) -> tuple[float, float, float]:
    """Level before a step, how far it falls beyond the slope common to both sides, and the fall's deviation."""
    a, b, c, d = np.searchsorted(time, (*before, *after))
    instant = 0.5 * (before[1] + after[0])
    longer = slice(a, b) if before[1] - before[0] > after[1] - after[0] else slice(c, d)
    slope = min(float(np.polyfit(time[longer] - instant, value[longer], 1)[0]), 0.0)
    left, right = (value[side] - slope * (time[side] - instant) for side in (slice(a, b), slice(c, d)))
    scatter = max(float(np.hypot(left.std(), right.std())) / np.sqrt(2.0), noise)
    sides = (before[1] - before[0], after[1] - after[0])
    apart = 0.5 * (after[0] + after[1] - before[0] - before[1])
    of_slope = 12.0 * GRID * apart**2 / max(sides) ** 3
    error = scatter * np.sqrt(GRID / sides[0] + GRID / sides[1] + of_slope)
    return float(left.mean()), float(left.mean() - right.mean()), float(error)


def _thrust_steps(signals: Mapping[str, Signal], fall: _Fall) -> bool:
    """Whether the thrust, where it is measured, falls with the chamber beyond its own decline."""
    if "thrust" not in signals:
        return True
    thrust = signals["thrust"]
    if min(thrust.between(*fall.before).time.size, thrust.between(*fall.after).time.size) < 4:
        return True
    level, size, error = _step(thrust.time, thrust.value, fall.before, fall.after, thrust.noise)
    return size > max(CLOSE_FALL * abs(level), 2.0 * error)


def _sudden(signals: Mapping[str, Signal], response: Response, t_feed: float, t_v: float | None) -> Sudden | None:
    times = response.time[(response.time > t_feed + 0.2) & (response.time < response.time[-1] - 0.1)]
    sizes = _falls(response, times, t_v)
    if not sizes.any():
        return None
    at = float(times[np.argmax(sizes)])
    if not thrust_falls(signals, (at - WINDOW, at - GAP), (at + GAP, at + WINDOW), 0.03):
        return None
    return _dated(signals, at, t_v)


def _goes_out(
    signals: Mapping[str, Signal], ambient: float, t_feed: float, t_v: float | None, last: float
) -> Sudden | None:
    """The last instant at which a fire that fades goes out: what is left of it goes within hundredths of a second.

    The fade before it, which is no line, hides that fall from a search with windows of WINDOW. The feed goes on:
    its pressure falls away where a valve closes ahead of its sensor, and rises to the tank's where one does behind it.
    """
    chamber, start = signals["p_chamber"], max(t_feed + 0.2, t_v + 2.0 * GAP if t_v is not None else 0.0)
    for time in reversed(abrupt_falls(chamber, ambient, start, last)):
        before, after = (time - OUT_LEVEL, time), (time + RELAXATION, time + OUT_AFTER)
        level, left = chamber.mean(*before) - ambient, chamber.mean(*after) - ambient
        feed, then = (signals["p_run"].mean(*when) - ambient for when in (before, after))
        flows_on = (1.0 - FEED_FALLS) * feed < then < (1.0 + FEED_RISES) * feed
        if left > (1.0 - OUT) * level or not flows_on or not thrust_falls(signals, before, after, OUT):
            continue
        found = refine_step([chamber], time, OUT_LEVEL, OUT_AFTER, 0.5 * OUT_LEVEL)
        if found is not None and found.std < SHARPLY_DATED and 3.0 * found.relaxation < AT_ONCE:
            return _bends(chamber.between(time - OUT_LEVEL, time + OUT_AFTER), found)
    return None


def _falls(response: Response, times: Array, t_v: float | None) -> Array:
    """Sizes (n,) of sudden falls at ``times`` (n,) [s] in standard deviations; 0 where one is too small, unclear, or
    its windows too short."""
    start, end = times - WINDOW, times + WINDOW
    if t_v is not None:
        start = np.where(times > t_v, np.maximum(start, t_v + GAP), start)
        end = np.where(times < t_v, np.minimum(end, t_v - GAP), end)
    a, b, c, d = (np.searchsorted(response.time, at) for at in (start, times - GAP, times + GAP, end))
    sizes, seen = np.zeros(times.size), (b - a >= 6) & (d - c >= 4)
    a, b, c, d = a[seen], b[seen], c[seen], d[seen]
    left, right = _Moments.of(response, a, b), _Moments.of(response, c, d)
    slope = left.mixed / left.times
    predicted = left.value + np.minimum(slope, 0.0) * (right.time - left.time)
    fall = predicted - right.value
    about = np.maximum(left.values - slope * left.mixed, 0.0) / (b - a)
    scatter = np.sqrt(about + right.values / (d - c))
    error = np.maximum(scatter, response.noise) * np.sqrt(3.0 / (b - a) + 1.0 / (d - c))
    clear = fall > np.maximum.reduce([SUDDEN_FALL * predicted, np.full_like(fall, SMALLEST_FALL), CLEAR_FALL * error])
    sizes[seen] = np.where(clear, fall / np.where(error > 0.0, error, 1.0), 0.0)
    return sizes


@dataclass(frozen=True)
class _Moments:
    """Of the response in windows, (k,) each: mean ``time`` and ``value``, and the sums of squares of the times, of the
    values and of both mixed about them."""

    time: Array
    value: Array
    times: Array
    values: Array
    mixed: Array

    @classmethod
    def of(cls, response: Response, first: Integers, end: Integers) -> _Moments:
        """From the index of the ``first`` of a window to before its ``end``."""
        t, v = response.time - response.time.mean(), response.value - response.value.mean()
        count = end - first
        totals = (np.append(0.0, np.cumsum(one)) for one in (t, v, t * t, v * v, t * v))
        t1, v1, tt, vv, tv = (total[end] - total[first] for total in totals)
        spread = (tt - t1 * t1 / count, np.maximum(vv - v1 * v1 / count, 0.0), tv - t1 * v1 / count)
        return cls(t1 / count + response.time.mean(), v1 / count + response.value.mean(), *spread)


def _dated(signals: Mapping[str, Signal], rough: float, t_v: float | None) -> Sudden | None:
    """The instant of a fall near ``rough`` [s], from samples on its side of t_v; None where it is not sudden."""
    chamber = signals["p_chamber"]
    before, after, reach = WINDOW, WINDOW, max(0.1, 4.0 * chamber.step)
    if t_v is not None and rough > t_v:
        before = min(before, rough - t_v - 0.5 * GAP)
        reach = min(reach, before)
    elif t_v is not None:
        after = min(after, t_v - rough - 0.5 * CLOSE)
        reach = min(reach, after)
    least = 3.0 * chamber.step
    found = refine_step([chamber], rough, max(before, least), max(after, least), max(reach, least))
    if found is None:
        return Sudden(rough, GRID, rough, GRID)
    if 3.0 * found.relaxation > SUDDEN or found.std > max(SHARPLY_DATED, chamber.step):
        return None
    return _bends(chamber.between(rough - max(before, least), rough + max(after, least)), found)


def _bends(part: Signal, found: Break) -> Sudden:
    """Both bends of a sudden fall, as well as a chamber that has to flush shows them."""
    lasts = max(3.0 * found.relaxation, 2.0 * part.step)
    near = part.between(found.time - 2.0 * lasts - GAP, found.time + 3.0 * lasts + GAP)
    fall = date_fall(near.time, near.value, (found.time, found.std), found.relaxation, RESIDENCE)
    if fall is None or fall.gone is None:
        std = float(np.hypot(found.std, RESIDENCE))
        return Sudden(found.time, std, found.time, std)
    begin_std, gone_std = (float(np.hypot(std, RESIDENCE)) for std in (fall.begin_std, fall.gone_std))
    return Sudden(fall.begin, begin_std, max(fall.gone, fall.begin), gone_std)
