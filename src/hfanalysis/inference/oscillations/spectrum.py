"""The spectrum of a fluctuation over time, and the floor that lines stand out of.

The floor is broadband: the sensor's noise and the rumble of the combustion. It may fall or rise with frequency; a line
is narrower than the range over which the floor is taken.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import median_filter
from scipy.signal.windows import hann

from hfanalysis.arrays import Array
from hfanalysis.inference.oscillations.fluctuation import LEAST, LOWEST, Fluctuation

LENGTHS = (0.25, 0.5, 1.0, 2.0)
"""[s] of the windows: short ones follow an oscillation whose frequency moves, long ones see fainter ones."""

TURNS = 3.0
"""Periods of the slowest oscillation that a window holds at least. Source: a line in a Hann window is four bins wide,
and would reach into the mean."""

FEWEST = 3
"""Windows that a stretch has at least."""

NEIGHBORS = 12
"""Frequencies on either side of one from which its floor is the median. Evidence: a line takes up to seven of them."""

BENDS = 3
"""Degree of the polynomial in the logarithm of the frequency that the floor follows at large. Evidence: noise through
a filter is flat, then falls: a straight line came out too low at its ends (test_spectrum.py)."""

PASSES = 8
"""In which large distances from the polynomial lose their weight."""

NEAR = 0.05
"""Distance of a logarithm of power from the polynomial below which all count alike."""

MEDIAN = float(np.log(2.0))
"""Median of a power over its mean [-]. Source: the power of noise in a spectrum is exponentially distributed."""


@dataclass(frozen=True)
class Spectrum:
    """One-sided power densities (windows, frequencies) [SI squared / Hz] of overlapping windows of ``length`` [s].

    ``time`` (windows,) [s]: their middles. ``frequency`` (frequencies,) [Hz].
    """

    time: Array
    frequency: Array
    power: Array
    length: float

    @property
    def spacing(self) -> float:
        """Between frequencies [Hz]."""
        return float(self.frequency[1] - self.frequency[0])

    @cached_property
    def floor(self) -> Array:
        """Of the power density (frequencies,) [SI squared / Hz], lines left out."""
        usual = np.median(self.power, axis=0) / MEDIAN if self.time.size > FEWEST else self.power.mean(axis=0)
        size = np.log(np.maximum(usual, np.finfo(float).tiny))
        course = _course(np.log(self.frequency), size)
        return np.asarray(np.exp(course + median_filter(size - course, 2 * NEIGHBORS + 1, mode="mirror")))

    @cached_property
    def ratio(self) -> Array:
        """Power over floor (windows, frequencies) [-]: exponentially distributed with mean 1 where there is no line.

        A window that is rougher than the others throughout is no line: its own level is divided out.
        """
        above = self.power / self.floor
        level = np.median(above, axis=1, keepdims=True) / MEDIAN
        return np.asarray(above / np.maximum(level, 1.0))


def _course(x: Array, y: Array) -> Array:
    """A polynomial through most of the points (n,), by least absolute distances; ``x`` logarithms of frequencies, each
    range of which counts alike.
    """
    dense = np.exp(x[0] - x)
    weight, found = dense, np.asarray(y)
    for _ in range(PASSES):
        found = np.asarray(np.polyval(np.polyfit(x, y, BENDS, w=np.sqrt(weight)), x), dtype=np.float64)
        weight = dense / np.maximum(np.abs(y - found), NEAR)
    return np.asarray(found)


def spectra(found: Fluctuation) -> list[Spectrum]:
    """Of a fluctuation, in windows of each of LENGTHS that it has room for."""
    even = found.even
    return [s for s in (_spectrum(found, even, length) for length in LENGTHS) if s is not None]


def _spectrum(found: Fluctuation, even: Array, length: float) -> Spectrum | None:
    count = 2 * round(0.5 * length / found.step)
    if count < LEAST or even.size < count // 2 * (FEWEST + 1):
        return None
    window = hann(count, sym=False)
    pieces = sliding_window_view(even, count)[:: count // 2]
    power: Array = np.abs(np.fft.rfft(pieces * window, axis=1)) ** 2 * (2.0 * found.step / np.sum(window**2))
    frequency = np.asarray(np.fft.rfftfreq(count, found.step), dtype=np.float64)
    kept = (frequency >= max(LOWEST, TURNS / length)) & (frequency < found.nyquist - 1.0 / length)
    if kept.sum() < NEIGHBORS:
        return None
    time = found.time[0] + found.step * (0.5 * count + np.arange(pieces.shape[0]) * (count // 2))
    return Spectrum(time, frequency[kept], power[:, kept], count * found.step)
