"""What of a channel fluctuates: its samples less their smooth course."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal

SMOOTH = 0.15
"""[s], standard deviation of the Gaussian whose mean is the smooth course. Evidence: at LOWEST it leaves 98 % of an
oscillation (test_fluctuation.py); a longer one would leave more of the ignition's rise."""

LOWEST = 3.0
"""[Hz] below which an oscillation is taken for a part of the smooth course. Source: exp(-(2 pi LOWEST SMOOTH)^2 / 2) is
2 %."""

LEAST = 32
"""Samples in which there is a spectrum to speak of."""

WINDOW = 1.0
"""[s] of which the range of the fluctuation is taken."""

RANGE = (0.5, 99.5)
"""Per cent of the samples between which the range is: single wild samples do not count."""


@dataclass(frozen=True)
class Fluctuation:
    """``value`` (n,) [SI] of the samples at ``time`` (n,) [s after the opening], about a ``mean`` [SI].

    ``step`` [s] is between samples as the logger takes them; a logger whose clock is uneven takes them near that.
    """

    time: Array
    value: Array
    step: float
    mean: float

    @property
    def nyquist(self) -> float:
        """Half the sampling rate [Hz]: nothing above it can be told from something below."""
        return 0.5 / self.step

    @property
    def variance(self) -> float:
        """Of the fluctuation [SI squared]."""
        return float(np.mean(self.value**2))

    @property
    def even(self) -> Array:
        """Values [SI] every ``step`` [s] from the first sample on."""
        clock = np.arange(self.time[0], self.time[-1] + 0.5 * self.step, self.step)
        return np.interp(clock, self.time, self.value)

    @property
    def peak_to_peak(self) -> float:
        """[SI]: the range of nearly all samples in a window, its mean over the windows."""
        count = min(max(round(WINDOW / self.step), LEAST), self.value.size)
        windows = self.value[: self.value.size // count * count].reshape(-1, count)
        low, high = np.percentile(windows, RANGE, axis=1)
        return float(np.mean(high - low))


def fluctuation(signal: Signal, start: float, end: float) -> Fluctuation | None:
    """Of a signal between two instants [s]; None where it has too few samples there.

    The smooth course is taken from what lies on either side, too, as far as it reaches.
    """
    near = signal.between(start - 4.0 * SMOOTH, end + 4.0 * SMOOTH)
    kept = (near.time >= start) & (near.time < end)
    time = near.time[kept]
    if time.size < LEAST or np.ptp(time) < 0.5 * (end - start):
        return None
    step = float(np.ptp(time)) / (time.size - 1)
    step = float(np.median(np.diff(time))) if step > 1.5 * signal.step else step  # holes are no samples
    clock = np.arange(near.time[0], near.time[-1] + step, step)
    smooth = np.interp(near.time, clock, gaussian_filter1d(near.at(clock), SMOOTH / step, mode="nearest"))
    return Fluctuation(time, (near.value - smooth)[kept], step, float(near.value[kept].mean()))
