"""A fade of the fire before the liquid is gone: where it begins, and where it has ended.

The chamber's response to the feed settles to a line while the grain burns whole. From the bend on it falls by a power
of the time since, until the fuel is gone, and from there on it is a line again. How a grain runs out is not known:
every power and every length that the samples allow counts by its likelihood, so that a rounded bend is dated as poorly
as it is seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.segment.breaks import memory_length

POWERS = (0.7, 1.0, 1.4, 2.0)
"""Powers of the time with which a fade may set in: at once, or with a rounded bend."""

SHAPES = tuple((p, q) for p in (0.8, 1.1, 1.5, 2.0) for q in (1.0, 1.4, 2.0))
"""Shapes 1 - (1 - u^p)^q of a fall over its time u with which it is dated: either bend may be sharp or rounded. Source:
Kumaraswamy's distribution (Journal of Hydrology 46, 1980, 79-88): p and q bend its two ends one by one."""

SETTLES = (0.2, 0.6)
"""Time constants [s] with which a fire settles after its start. Evidence: on public records it takes one to two seconds
after the line is full; taken for a part of the line it hid a fade of a third."""

BEND = 0.02
"""Part of a fade's length within which its bends are dated, whatever the samples: its shape lies between those that are
tried. Evidence: docs/phases.md."""

COARSE, FINE = 40, 25
"""Beginnings, and ends, that are tried over the phase, and then where the first trials are likely."""

LIKELY = 9.0
"""Rise of chi^2 up to which an instant is looked at again: three standard deviations."""

POINTS = 160
"""Block means of the response that carry its bend."""

LEAST_FALL = 0.2
"""Least part of the response that a fade takes, also beyond what the line before it falls."""

LEAST_FALL_TO_END = 0.4
"""The same where the fade has ended: without fuel the response is two to five times smaller. Source: c* of cold nitrous
oxide, 250 to 600 m/s, against 1000 to 1600 of a fire."""

CLEAR = 5.0
"""Least size of that fall in its standard deviations."""

SHORTEST = 0.25
"""Seconds: a shorter fade is a sudden fall, which has a search of its own."""

BRIEFEST = 0.02
"""Least length [s] that a fade is dated with, once it is found."""

LASTS = 3.0
"""Time constants after which an exponential fall is over."""

FLUSHES = np.geomspace(0.6, 1.7, 11)
"""Factors on a fall's time constant that are tried for the flush of a chamber."""

BEYOND = (0.0, 0.5, 1.5)
"""Parts of what is seen of a fade that goes on for which it may do so beyond the phase."""

LONGEST = 0.6
"""Largest part of the phase that a fade may take. Evidence: test_fuel_bounds.py: what takes most of the burn is how the
fire goes throughout."""

LEVEL = 0.3
"""Part of the fade's rate of fall above which the response has not levelled off after it."""

STEADY = 0.15
"""Part of the phase that has to be seen before a fade."""

REST = 0.15
"""Part of a fade's length for which the line after it has to be seen, else its end is not."""


@dataclass(frozen=True)
class Fade:
    """When it begins [s] and how well the bend is dated, when it has ended (None: not before the phase does)."""

    begin: float
    begin_std: float
    gone: float | None
    gone_std: float


@dataclass(frozen=True)
class _Trials:
    """Beginnings and ends [s] of all fades that are tried, (k,), their shapes (k, 2); what each leaves of the response;
    its fall, and that fall's deviation for residuals of 1."""

    begin: Array
    end: Array
    shape: Array
    left: Array
    fall: Array
    error: Array

    def of(self, some: NDArray[np.bool_]) -> _Trials:
        return _Trials(*(getattr(self, f.name)[some] for f in fields(self)))

    @property
    def best(self) -> int:
        return int(np.argmin(self.left))

    @property
    def first(self) -> _Trials:
        """The best by itself."""
        return self.of(np.arange(self.left.size) == self.best)


def find_fade(time: Array, response: Array) -> Fade | None:
    """The fade in a phase whose response (n,), in any unit, is given over times (n,) [s]; None where there is none."""
    t, y = _reduced(time, response / max(float(np.median(response)), 1e-9))
    if t.size < 24 or t[-1] - t[0] < 4.0 * SHORTEST:
        return None
    phase = _Samples(t, y, _whole(t))
    found = _coarse(phase)
    return None if found is None else _fine(phase, *found)


def date_fall(time: Array, value: Array, onset: tuple[float, float], relaxes: float, flush: float) -> Fade | None:
    """The bends of a fall of a signal (n,), in any unit, that begins at an ``onset`` (instant and deviation [s]) and
    ``relaxes`` with a time constant [s]; None where there are too few samples.

    What stops at once and what fades count by their likelihood. After either the chamber flushes: of what fades the end
    shows ``flush`` [s] late.
    """
    t, y = _reduced(time, value / max(float(np.ptp(value)), 1e-9))
    if t.size < 8:
        return None
    rough, step = onset[0], float(np.median(np.diff(t)))
    lasts = max(LASTS * relaxes, 2.0 * step)
    samples = _Samples(t, y, np.stack([np.ones_like(t), t - t[0]], axis=1))
    begins, ends = rough + lasts * np.linspace(-0.7, 0.7, FINE), rough + lasts * np.linspace(0.1, 2.5, FINE)
    coarse = samples.fitted(*_grid(begins, ends, SHAPES, 0.1 * step))
    begins, ends = (_looked_at(x, coarse, samples.variance(coarse), 0.1 * lasts) for x in (coarse.begin, coarse.end))
    fades = samples.fitted(*_grid(begins, ends, SHAPES, 0.1 * step))
    stops = rough + max(4.0 * onset[1], 0.5 * step) * np.linspace(-1.0, 1.0, FINE)
    at_once, left = samples.flushed(stops, max(relaxes, 0.2 * step) * FLUSHES)
    least = min(float(fades.left.min()), float(left.min()))
    weights = [np.exp(-0.5 * (x - least) / samples.variance(fades)) / x.size for x in (fades.left, left)]
    weight, begin = np.concatenate(weights), np.concatenate([fades.begin, at_once])
    return Fade(*_mean(weight, begin), *_mean(weight, np.concatenate([fades.end - flush, at_once])))


def _coarse(phase: _Samples) -> tuple[_Trials, bool, float] | None:
    """All fades of the better kind, whether it is over before the phase is, and the variance of a value; None where the
    grain burns whole as likely, or the fall is too small."""
    first, last = float(phase.t[0]), float(phase.t[-1])
    early = first + STEADY * (last - first)
    begins, ends = np.linspace(early, last - SHORTEST, COARSE), np.linspace(early + SHORTEST, last, COARSE)
    trials = phase.fitted(*_grid(begins, ends, tuple((power, 1.0) for power in POWERS), SHORTEST))
    variance = phase.variance(trials)
    price = float(np.log(phase.t.size)) * variance
    running, over = trials.of(trials.end == last), trials.of(trials.end < last - REST * (trials.end - trials.begin))
    gone = bool(over.left.size) and over.left.min() + 2.0 * price < running.left.min() and phase.levels_off(over)
    used = over if gone else running
    least = max(LEAST_FALL_TO_END if gone else LEAST_FALL, CLEAR * float(used.error[used.best]) * np.sqrt(variance))
    level = float(np.interp(used.begin[used.best], phase.t, phase.y))
    fall = min(float(used.fall[used.best]), phase.seen_fall(used))
    believed = phase.left_by_whole - used.left.min() >= 4.0 * price and fall >= least * level
    return (used, gone, variance) if believed else None


def _fine(phase: _Samples, used: _Trials, gone: bool, variance: float) -> Fade | None:
    """The bends of a fade that is there, by all shapes."""
    last = float(phase.t[-1])
    length = last - float(phase.t[0])
    begin, end = (_looked_at(x, used, variance, 1.5 * length / COARSE) for x in (used.begin, used.end))
    if not gone:
        end = last + (last - float(used.begin[used.best])) * np.array(BEYOND)
    fine = phase.fitted(*_grid(begin, end, SHAPES, BRIEFEST))
    weight = np.exp(-0.5 * (fine.left - fine.left.min()) / variance)
    found, found_std = _mean(weight, fine.begin)
    ends, ends_std = _mean(weight, fine.end)
    if not BRIEFEST < (ends if gone else last) - found < LONGEST * length:
        return None
    shape = BEND * (ends - found)
    return Fade(found, float(np.hypot(found_std, shape)), ends if gone else None, float(np.hypot(ends_std, shape)))


def _looked_at(values: Array, used: _Trials, variance: float, least: float) -> Array:
    """Instants [s] to look at again: where the trials are likely, and ``least`` [s] about it."""
    likely = values[used.left - used.left.min() < LIKELY * variance]
    return np.linspace(float(likely.min()) - least, float(likely.max()) + least, FINE)


def _whole(t: Array) -> Array:
    """What the response of a grain that burns whole is made of: a line, and the settling of the start."""
    since = t - t[0]
    return np.stack([np.ones_like(t), since, *(np.exp(-since / settles) for settles in SETTLES)], axis=1)


def _reduced(time: Array, value: Array) -> tuple[Array, Array]:
    per = max(time.size // POINTS, 1)
    whole = time.size // per * per
    return time[:whole].reshape(-1, per).mean(axis=1), value[:whole].reshape(-1, per).mean(axis=1)


def _mean(weight: Array, value: Array) -> tuple[float, float]:
    """Mean and deviation over the trials, which are no closer than their grid."""
    mean = float(np.average(value, weights=weight))
    grid = float(np.ptp(value)) / FINE
    return mean, float(np.sqrt(np.average((value - mean) ** 2, weights=weight) + grid**2 / 12.0))


def _grid(
    begins: Array, ends: Array, shapes: Sequence[tuple[float, float]], least: float
) -> tuple[Array, Array, Array]:
    """Beginnings, ends and shapes of the trials: every pair that lies apart, with every shape."""
    begin, end, which = (x.ravel() for x in np.meshgrid(begins, ends, np.arange(len(shapes)), indexing="ij"))
    apart = end - begin >= least
    chosen: Array = np.array(shapes)[which[apart].astype(np.int64)]
    return np.asarray(begin[apart], dtype=np.float64), np.asarray(end[apart], dtype=np.float64), chosen


def _faded(t: Array, begin: Array, end: Array, shape: Array) -> Array:
    """How far (k, n) each fade is over at the times (n,) [s]."""
    part = np.clip((t - begin[:, None]) / (end - begin)[:, None], 0.0, 1.0)
    return np.asarray(1.0 - (1.0 - part ** shape[:, :1]) ** shape[:, 1:])


@dataclass(frozen=True)
class _Samples:
    """Values (n,) of the response over times (n,) [s], and the columns (n, m) of a grain that burns whole."""

    t: Array
    y: Array
    columns: Array

    def fitted(self, begin: Array, end: Array, shape: Array) -> _Trials:
        """All trials by least squares: the columns, the fade, and a slope after one that ends before the phase."""
        basis = np.linalg.qr(self.columns)[0]
        rest = self.y - basis @ (basis.T @ self.y)
        after = np.maximum(self.t - end[:, None], 0.0)
        faded, after = (x - (x @ basis) @ basis.T for x in (-_faded(self.t, begin, end, shape), after))
        across, of_after = np.einsum("kn,kn->k", faded, after), np.einsum("kn,kn->k", after, after)
        has = of_after > 1e-9
        own = faded - np.where(has, across / np.where(has, of_after, 1.0), 0.0)[:, None] * after
        size = np.maximum(np.einsum("kn,kn->k", own, own), 1e-12)
        fall = own @ rest / size
        by_after = np.where(has, (after @ rest) ** 2 / np.where(has, of_after, 1.0), 0.0)
        left = rest @ rest - fall**2 * size - by_after
        return _Trials(begin, end, shape, np.where(fall > 0.0, left, rest @ rest), fall, 1.0 / np.sqrt(size))

    def flushed(self, stops: Array, constants: Array) -> tuple[Array, Array]:
        """When a fire stops at once (k,) [s] and its chamber flushes with a time constant [s], and what that leaves."""
        stop, constant = (x.ravel() for x in np.meshgrid(stops, constants))
        basis = np.linalg.qr(self.columns)[0]
        rest = self.y - basis @ (basis.T @ self.y)
        fallen = np.exp(-np.maximum(self.t - stop[:, None], 0.0) / constant[:, None])
        own = fallen - (fallen @ basis) @ basis.T
        size = np.maximum(np.einsum("kn,kn->k", own, own), 1e-12)
        return np.asarray(stop), np.asarray(rest @ rest - np.maximum(own @ rest, 0.0) ** 2 / size)

    @property
    def left_by_whole(self) -> float:
        """Sum of squares that a grain that burns whole leaves."""
        left = self.y - self.columns @ np.linalg.lstsq(self.columns, self.y, rcond=None)[0]
        return float(left @ left)

    def curve(self, one: _Trials) -> Array:
        """The fitted response (n,) of a single trial."""
        faded = _faded(self.t, one.begin, one.end, one.shape)[0]
        x = np.column_stack([self.columns, faded, np.maximum(self.t - one.end, 0.0)])
        return np.asarray(x @ np.linalg.lstsq(x, self.y, rcond=None)[0])

    def variance(self, trials: _Trials) -> float:
        """Of an independent value: what the best of all trials leaves, and how long its memory is."""
        residual = self.y - self.curve(trials.first)
        return max(float(residual @ residual) / max(self.t.size - 6, 1) * memory_length(residual), 1e-12)

    def seen_fall(self, trials: _Trials) -> float:
        """How far the response really falls over the best fade, whatever the line before."""
        one = trials.first
        ends = np.interp([float(one.begin[0]), float(one.end[0])], self.t, self.curve(one))
        return float(ends[0] - ends[1])

    def levels_off(self, trials: _Trials) -> bool:
        """Whether the response hardly falls any more after the best fade: else the fade goes on, ever slower."""
        one, last = trials.first, float(self.t[-1])
        ends = np.interp([float(one.end[0]), last], self.t, self.curve(one))
        fading = max(self.seen_fall(trials), 1e-9) / float(one.end[0] - one.begin[0])
        return bool(ends[0] - ends[1] < LEVEL * fading * (last - float(one.end[0])))
