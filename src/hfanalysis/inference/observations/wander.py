"""The slow noise of a sensor, as its quiet time before the opening shows it: a sum of correlated processes.

Whether a sensor wanders over seconds (1/f) or forgets within tenths of a second decides how small a slow departure of
the model can be seen. The variances of the processes, each correlated exponentially, come from the periodogram of the
quiet time (Whittle's likelihood); between neighboring time constants they change smoothly, so that what is slower than
the quiet time is carried on from what it shows. Their level is the mean of all that the quiet time leaves possible.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal

TIMES = np.array([0.02, 0.06, 0.18, 0.54, 1.6, 4.9, 15.0])
"""Time constants [s] of the processes."""

ROUGH = 1.0
"""Standard deviation of the log of the ratio of neighboring variances."""

USUAL = -3.0, 2.0
"""Log of the variance of a process over that of a block's white noise, and how far sensors differ in it.
An assumption: at about 1 Hz the wander of a usual sensor is as strong as its white noise. It keeps a quiet time that
happens to show none from meaning that there is none."""

CAREFUL = 0.3
"""Log of the variances by which all are raised at last, in their posterior standard deviations: a quiet time that is
too short misleads only where it shows too little."""

LEVELS = np.linspace(-6.0, 6.0, 49)
"""Logs of factors of all variances over which their level is averaged."""

SLOW = 0.15
"""Time constant [s] from which on a process is slow: a quiet time of seconds holds few of its swings."""

FARTHEST_VARIANCE = 40.0
"""By how much the log of a variance [natural log] may differ from that of the whole reading's."""

NARROW = 1e-3
"""Of a process's time constant: a narrower mean is its value."""

FEWEST_BLOCKS = 60
"""Blocks of quiet time from which on it is analysed."""

UNSEEN = float(np.exp(USUAL[0] + 0.5 * USUAL[1] ** 2))
"""Variance of a process over that of a block's white noise [-] where the quiet time is too short to show it: the mean
over what sensors usually have (USUAL). Evidence: while it was nothing, half a second of quiet that showed no wander
meant that there is none (test_noise.py)."""

MOST_BLOCKS = 6000
"""Blocks of it that are analysed at most, the last ones."""

UNSURE, LEAST_UNSURE = 0.65, 0.15
"""Standard deviation of the log of the slow noise's amplitude after a second of quiet, which falls with the root of its
length, and what no length takes away: a spectrum is not quite of any form that is thought of. Evidence: simulated
sensors hold it (tests/inference/observations/test_noise.py)."""

SHORTEST_QUIET = 0.4
"""Seconds of quiet below which it is known no worse than beforehand: half the deviation of USUAL, of an amplitude."""

STILL = 1e-9
"""Part of a reading by which it has to move to have a spectrum: a coarse converter may stand on one count."""


@dataclass(frozen=True)
class Wander:
    """``variances`` (processes,) [SI squared] of processes with TIMES, and ``white`` [SI]: the standard deviation of a
    block's white noise.

    ``unsure``: standard deviation of the log of the slow processes' amplitude [-].
    """

    variances: Array
    white: float
    unsure: float = UNSURE

    def covariance(self, time: Array, width: Array | float = 0.0) -> Array:
        """Covariance (n, n) [SI squared] of means about given times (n,) [s]: the wander's alone, without white noise.

        ``width`` [s], one or (n,): of the means, which do not overlap; 0 where they are those that it was fitted to.

        >>> one = Wander(np.where(TIMES == 0.54, 4.0, 0.0), 0.0)
        >>> one.covariance(np.array([0.0, 0.54])).round(2).tolist()
        [[4.0, 1.47], [1.47, 4.0]]
        """
        return self._of(time, width, TIMES > 0.0)

    def slow(self, time: Array, width: Array | float = 0.0) -> Array:
        """The part (n, n) [SI squared] of :meth:`covariance` that is of slow processes; arguments as there."""
        return self._of(time, width, TIMES >= SLOW)

    def _of(self, time: Array, width: Array | float, which: NDArray[np.bool_]) -> Array:
        widths = np.broadcast_to(np.asarray(width, dtype=np.float64), time.shape)
        pairs = zip(self.variances[which], TIMES[which], strict=True)
        return np.asarray(sum(v * _correlation(time, widths / tau, float(tau)) for v, tau in pairs))


def _correlation(time: Array, width: Array, tau: float) -> Array:
    """Covariance of means of a process of unit variance, over parts ``width`` of its time constant: the integral of
    exp(-lag) over both stretches."""
    lag = np.abs(time[:, None] - time[None, :]) / tau - 0.5 * (width[:, None] + width[None, :])
    wide = width > NARROW
    safe = np.where(wide, width, 1.0)
    share = np.where(wide, -np.expm1(-safe) / safe, 1.0)
    out = np.exp(-np.maximum(lag, 0.0)) * np.outer(share, share)
    np.fill_diagonal(out, np.where(wide, 2.0 * (safe + np.expm1(-safe)) / safe**2, 1.0))
    return np.asarray(out)


def roughness(wander: Wander, block: float) -> float:
    """What the wander adds to the squared noise [SI squared] of blocks of a length [s] that second differences show."""
    one, two = np.exp(-block / TIMES), np.exp(-2.0 * block / TIMES)
    return float(wander.variances @ (6.0 - 8.0 * one + 2.0 * two) / 6.0)


def wander_of(signal: Signal, block: float) -> Wander:
    """From the quiet time before the opening (negative times [s]), in blocks of so many seconds; in the signal's SI
    unit."""
    quiet = signal.between(-np.inf, -0.1)
    noise = Noise.of(signal, quiet)
    blocks = quiet.reduced(block)
    white = float(noise.white * np.sqrt(min(noise.step / block, 1.0)))
    still = float(np.ptp(blocks.value)) <= STILL * float(np.abs(blocks.value).max()) if blocks.time.size else True
    if blocks.time.size < FEWEST_BLOCKS or still:
        wander = max(noise.flicker * np.log(3.0), UNSEEN * white**2)
        return Wander(np.full(TIMES.size, wander), white, unsure_after(blocks.time.size * block))
    values = blocks.value[-MOST_BLOCKS:]
    return _fitted(values - values.mean(), float(np.median(np.diff(blocks.time))), white, noise.flicker)


def unsure_after(seconds: float) -> float:
    """Standard deviation of the log of the slow noise's amplitude where the quiet time lasts so long [s].

    >>> [round(unsure_after(s), 2) for s in (0.5, 4.0, 60.0)]
    [0.93, 0.36, 0.17]
    """
    return float(np.hypot(LEAST_UNSURE, UNSURE / np.sqrt(max(seconds, SHORTEST_QUIET))))


def _fitted(values: Array, step: float, white: float, flicker: float) -> Wander:
    """Maximum of Whittle's likelihood with a smooth prior, at the mean level that it leaves possible."""
    n = values.size
    frequency = np.fft.rfftfreq(n, step)[1 : (n - 1) // 2]
    power = 2.0 * step / n * np.abs(np.fft.rfft(values * _taper(n)))[1 : (n - 1) // 2] ** 2
    shapes = np.stack([_spectrum(frequency, float(tau), step) for tau in TIMES])
    floor = 2.0 * step * np.ones(frequency.size)
    level = max(float(np.var(values)), 1e-300)

    def cost(x: Array) -> float:
        model = np.exp(x[:-1]) @ shapes + np.exp(x[-1]) * floor
        prior = float(np.sum((np.diff(x[:-1]) / ROUGH) ** 2) + ((x[-1] - np.log(level)) / 10.0) ** 2)
        prior += float(((x[:-1].mean() - x[-1] - USUAL[0]) / USUAL[1]) ** 2)
        return float(np.sum(np.log(model) + power / model)) + 0.5 * prior

    start = np.log(np.r_[np.full(TIMES.size, max(flicker, 1e-3 * level)), max(white**2, 1e-3 * level)])
    bounds = [(np.log(level) - FARTHEST_VARIANCE, np.log(level) + FARTHEST_VARIANCE)] * start.size
    best = minimize(cost, start, method="L-BFGS-B", bounds=bounds, options={"maxiter": 60}).x
    costs = np.array([cost(np.r_[best[:-1] + shift, best[-1]]) for shift in LEVELS])
    weights = np.exp(costs.min() - costs)
    mean = float(weights @ np.exp(LEVELS) / weights.sum())
    mean *= float(np.exp(CAREFUL / np.sqrt(1.0 + frequency.size / 40.0)))
    return Wander(mean * np.exp(best[:-1]), float(np.exp(0.5 * best[-1])), unsure_after(n * step))


def _taper(n: int) -> Array:
    """Hann's window of unit power: a slow trend must not leak into all frequencies."""
    window = np.hanning(n + 2)[1:-1]
    return np.asarray(window / np.sqrt(np.mean(window**2)))


def _spectrum(frequency: NDArray[np.floating[Any]], tau: float, step: float) -> Array:
    """One-sided spectrum of a process of unit variance that is sampled every ``step`` seconds."""
    kept = np.exp(-step / tau)
    return np.asarray(
        2.0 * step * (1.0 - kept**2) / (1.0 - 2.0 * kept * np.cos(2.0 * np.pi * frequency * step) + kept**2)
    )
