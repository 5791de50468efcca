"""A sensor's noise: white noise of single samples and a slow wander with a 1/f spectrum.

Averaging beats white noise but hardly the wander, so that intervals from white noise alone are far too narrow. The
wander is measured where nothing happens, by the Allan variance: between neighboring block means it is the same at
every block length.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal, sample_noise

REFERENCE_TIME = 20.0
"""Wander slower than this [s] counts as the sensor's bias, which the stated accuracy covers."""

LONG_STRETCH = 1500
"""Samples of a stretch from which on a cubic may be taken out without taking the wander with it [samples]. Evidence: at
200 Hz a liquid phase of fewer samples let the fall of the pressure itself pass for wander, and m got fifty times its
deviation."""

SHORTEST_BLOCK, LEAST_BLOCK = 16, 4
"""Samples per block from which on the wander is looked for; below, white noise hides it [samples]. A stretch too
short for those has smaller ones: the sensors of slow loggers wander as well."""


@dataclass(frozen=True)
class Noise:
    """``white``: standard deviation of a sample; ``flicker``: A of the wander's spectrum A/f [unit^2]; ``step`` [s]."""

    white: float
    flicker: float
    step: float

    @classmethod
    def of(cls, signal: Signal, *quiet: Signal) -> Noise:
        """From stretches of the signal in which nothing happens; slow trends (cubics) in them are no noise."""
        stretches = [_detrended(q) for q in quiet if q.value.size > 20]
        if not stretches:
            return cls(signal.noise, 0.0, signal.step)
        longest = max(stretches, key=len)
        white = sample_noise(longest)
        sizes = [s.size for s in stretches]
        flicker = float(np.average([_flicker(s, white) for s in stretches], weights=sizes))
        return cls(white, flicker, signal.step)

    def covariance(self, time: Array) -> Array:
        """Covariance (n, n) [unit^2] of samples (or of means over their spacing) at the given times [s], shape (n,)."""
        spacing = float(np.median(np.diff(time))) if time.size > 1 else self.step
        lag = np.abs(time[:, None] - time[None, :])
        apart = np.log(REFERENCE_TIME / np.clip(lag, 0.5 * spacing, REFERENCE_TIME))
        np.fill_diagonal(apart, np.log(REFERENCE_TIME / spacing) + 1.5)
        white = self.white**2 * self.step / max(spacing, self.step)
        return np.asarray(self.flicker * apart + white * np.eye(time.size))

    def std_of(self, weights: Array, time: Array) -> float:
        """Standard deviation [unit] of a weighted sum of samples: ``weights`` (n,) at the times (n,) [s]."""
        return float(np.sqrt(max(float(weights @ self.covariance(time) @ weights), 0.0)))

    def common(self, weights: Array, time: Array, other_weights: Array, other_time: Array) -> float:
        """Covariance [unit^2] of two weighted sums of samples that lie apart: only the wander is common to them.

        ``weights`` (n,) at ``time`` (n,) [s], ``other_weights`` (k,) at ``other_time`` (k,) [s].
        """
        lag = np.abs(time[:, None] - other_time[None, :])
        apart = np.log(REFERENCE_TIME / np.clip(lag, 5.0 * self.step, REFERENCE_TIME))
        return float(self.flicker * (weights @ apart @ other_weights))

    def difference_std(self, first: tuple[float, float], second: tuple[float, float]) -> float:
        """Standard deviation [unit] of the difference between the means over two intervals [s], each (start, end)."""
        wander = 2.0 * _mean_log(first, second) - _mean_log(first, first) - _mean_log(second, second)
        white = sum(self.white**2 * self.step / max(b - a, self.step) for a, b in (first, second))
        return float(np.sqrt(max(self.flicker * wander, 0.0) + white))


def _detrended(signal: Signal) -> Array:
    x = (signal.time - signal.time.mean()) / max(float(np.ptp(signal.time)), 1e-9)
    order = 3 if signal.value.size > LONG_STRETCH else 0
    return np.asarray(signal.value - np.polyval(np.polyfit(x, signal.value, order), x))


def pool(noises: Mapping[str, Noise]) -> dict[str, Noise]:
    """Noises of like sensors, each wander drawn half-way to their mean: a short quiet time alone gives it poorly."""
    mean = float(np.mean([n.flicker for n in noises.values()])) if noises else 0.0
    return {name: replace(n, flicker=0.5 * (n.flicker + mean)) for name, n in noises.items()}


def _flicker(quiet: Array, white: float) -> float:
    """A from Allan variances at blocks of SHORTEST_BLOCK samples and more, less what white noise leaves at each."""
    estimates, weights = [], []
    length = SHORTEST_BLOCK
    while length > LEAST_BLOCK and quiet.size < 5 * length:
        length //= 2
    while quiet.size >= 5 * length:
        blocks = quiet[: quiet.size // length * length].reshape(-1, length).mean(axis=1)
        allan = 0.5 * float(np.mean(np.diff(blocks) ** 2))
        estimates.append((allan - white**2 / length) / (2.0 * np.log(2.0)))
        weights.append(blocks.size)
        length *= 2
    if not estimates:
        return 0.0
    # a variance from few blocks is as likely too small as too large, but only the former misleads
    few = 1.0 + 4.0 / weights[0]
    return float(max(float(np.average(estimates, weights=np.sqrt(weights))), 0.0) * few)


def _mean_log(first: tuple[float, float], second: tuple[float, float]) -> float:
    """Mean of ln|x - y| for x in the first interval and y in the second."""
    (a, b), (c, d) = first, second
    total = _twice_integrated_log(d - a) - _twice_integrated_log(c - a) - _twice_integrated_log(d - b)
    return float((total + _twice_integrated_log(c - b)) / ((b - a) * (d - c)))


def _twice_integrated_log(u: float) -> float:
    return float(0.5 * u * u * np.log(abs(u)) - 0.75 * u * u) if u != 0.0 else 0.0
