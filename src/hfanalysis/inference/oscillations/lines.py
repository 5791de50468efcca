"""The lines of a stretch: oscillations at a frequency that may move, from when to when, how strong and how sure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.oscillations.fluctuation import Fluctuation
from hfanalysis.inference.oscillations.paths import Path, clearest
from hfanalysis.inference.oscillations.spectrum import Spectrum, spectra

REACH = 2
"""Frequencies on either side that the power of a line reaches. Source: the main lobe of a Hann window."""

MOST = 6
"""Lines that are looked for in a stretch."""

STEPS = 4
"""Of the fit of frequency and its slope in a window. Evidence: from a spectrum's frequency it converges in three."""

BEYOND = 1e-6
"""Weight of a window's wave outside of it: any that is less than those inside."""

TWICE = float(np.log(2.0))
"""Change of the logarithm of an amplitude over its time from which it grows or fades: by a factor of two."""

SURE = 2.0
"""Standard deviations by which it has to be more than that."""


@dataclass(frozen=True)
class Track:
    """A line in a stretch of one channel.

    ``frequency`` [Hz], with the half-width ``reach`` of its 95 % interval, which has what it moves over, and the
    standard deviation ``width`` of what it moves by; ``rms`` [SI] with its standard deviation; from ``start`` to
    ``end`` [s after the opening]; ``trend`` [-]: change of the logarithm of its amplitude over that time, with its
    standard deviation.
    """

    frequency: float
    reach: float
    width: float
    rms: float
    rms_std: float
    start: float
    end: float
    trend: float
    trend_std: float

    @property
    def course(self) -> str:
        """Grows, fades or is steady."""
        if abs(self.trend) - SURE * self.trend_std < TWICE:
            return "steady"
        return "grows" if self.trend > 0.0 else "fades"


@dataclass(frozen=True)
class Waves:
    """A sine with a frequency that moves evenly, in each window of a path.

    All (windows,): ``time`` of the middle [s], ``frequency`` there [Hz] and its standard deviation, power [SI squared]
    and what noise alone has of it.
    """

    time: Array
    frequency: Array
    frequency_std: Array
    power: Array
    noise: Array


def lines(found: Fluctuation) -> list[Track]:
    """The lines of a fluctuation, the clearest first. Each is taken off before the next is looked for."""
    out: list[tuple[Track, Path]] = []
    left = found
    while len(out) < MOST:
        looked = spectra(left)
        best = clearest(looked, [_allowed(s, out) for s in looked])
        if best is None:
            break
        waves, taken = _fitted(left, best)
        out.append((_track(best, waves), best))
        left = replace(left, value=left.value - taken)
    return [track for track, _ in out]


def _allowed(s: Spectrum, known: list[tuple[Track, Path]]) -> NDArray[np.bool_]:
    """The cells (windows, frequencies) that none of the known lines reaches."""
    mask = np.ones(s.power.shape, dtype=bool)
    for track, path in known:
        frequency = np.interp(s.time, path.time, path.frequency)
        reach = (REACH + 1) * max(s.spacing, path.spectrum.spacing) + 2.0 * track.width
        margin = max(s.length, path.spectrum.length)
        during = (s.time > track.start - margin) & (s.time < track.end + margin)
        mask[during[:, None] & (np.abs(s.frequency - frequency[:, None]) < reach)] = False
    return mask


def _fitted(found: Fluctuation, path: Path) -> tuple[Waves, Array]:
    """The line in each window of its path, by least squares on the samples as they are; and its values (n,) [SI]."""
    half, slopes = (
        0.5 * path.spectrum.length,
        np.gradient(path.frequency, path.time) if path.columns.size > 1 else [0.0],
    )
    total, weight = np.zeros(found.time.size), np.zeros(found.time.size)
    rows = []
    for middle, frequency, slope in zip(path.time, path.frequency, slopes, strict=True):
        # beyond its window a wave goes on to where no window reaches: the ends of the stretch
        a, b = np.searchsorted(found.time, (middle - 2.0 * half, middle + 2.0 * half))
        time = found.time[a:b] - middle
        taper = np.where(np.abs(time) < half, np.cos(0.5 * pi * time / half) ** 2, 0.0)
        row, wave = _wave(time, found.value[a:b], taper, frequency, slope, 0.5 / half)
        rows.append((middle, *row))
        total[a:b] += (taper + BEYOND) * wave
        weight[a:b] += taper + BEYOND
    return Waves(*np.array(rows).T), np.where(weight > 0.0, total / np.where(weight > 0.0, weight, 1.0), 0.0)


def _wave(
    time: Array, value: Array, taper: Array, frequency: float, slope: float, spacing: float
) -> tuple[tuple[float, float, float, float], Array]:
    """Frequency [Hz], its standard deviation, power and its noise of one window, and the wave (n,) [SI]."""
    start = frequency
    wave: Array = np.zeros(time.size)
    left: Array = value
    size: Array = np.zeros(2)
    covariance: Array = np.eye(4)
    for _ in range(STEPS):
        angle = 2.0 * pi * (frequency * time + 0.5 * slope * time**2)
        basis = np.column_stack([np.cos(angle), np.sin(angle)])
        size = np.asarray(np.linalg.lstsq(basis * taper[:, None], value * taper, rcond=None)[0], dtype=np.float64)
        wave = np.asarray(basis @ size, dtype=np.float64)
        left = value - wave
        turned = 2.0 * pi * (basis @ np.array([size[1], -size[0]]))
        slopes = np.column_stack([basis, turned * time, 0.5 * turned * time**2])
        weighed = slopes * taper[:, None]
        inverse = np.linalg.pinv(weighed.T @ weighed)
        step = inverse @ (weighed.T @ (left * taper))
        sandwich = inverse @ (weighed.T * taper**2) @ weighed @ inverse
        covariance = sandwich * float(np.average(left**2, weights=taper))
        frequency = float(np.clip(frequency + step[2], start - 1.5 * spacing, start + 1.5 * spacing))
        slope = float(np.clip(slope + step[3], -2.0 * spacing**2, 2.0 * spacing**2))
    power, noise = 0.5 * float(size @ size), 0.5 * float(covariance[0, 0] + covariance[1, 1])
    return (frequency, float(np.sqrt(max(covariance[2, 2], 0.0))), power, noise), wave


def _track(path: Path, waves: Waves) -> Track:
    """What the windows of a path say of the line."""
    weight = 1.0 / np.maximum(waves.frequency_std, 1e-9) ** 2
    mean = float(np.average(waves.frequency, weights=weight))
    count = waves.time.size
    slope = float(np.polyfit(waves.time, waves.frequency, 1, w=np.sqrt(weight))[0]) if count > 3 else 0.0
    swept = 0.5 * abs(slope) * float(np.ptp(waves.time))
    moved = float(np.average((waves.frequency - mean) ** 2, weights=weight)) - count / float(weight.sum())
    width = float(np.sqrt(max(moved, 0.0)))
    # neighboring windows share half of their samples
    error = float(np.hypot(np.sqrt(2.0 / weight.sum()), width * np.sqrt(2.0 / count)))
    power = np.maximum(waves.power - waves.noise, 0.0)
    rms = float(np.sqrt(max(power.mean(), _band(path))))
    spread = np.sqrt(2.0 * np.sum(waves.noise * (2.0 * power + waves.noise))) / count
    trend, trend_std = _trend(waves.time, power, waves.noise)
    start, end = _from_to(path)
    return Track(
        mean, 2.0 * error + swept, width, rms, float(0.5 * spread / max(rms, 1e-300)), start, end, trend, trend_std
    )


def _from_to(path: Path) -> tuple[float, float]:
    """From when to when [s] its windows stand for; those at an end of the stretch reach to it."""
    s, rows = path.spectrum, path.rows
    before = 0.5 if rows[0] == 0 else 0.25
    after = 0.5 if rows[-1] == s.time.size - 1 else 0.25
    return float(path.time[0] - before * s.length), float(path.time[-1] + after * s.length)


def _band(path: Path) -> float:
    """Power [SI squared] above the floor about a path: all of a line that is wider than a sine."""
    s = path.spectrum
    near = np.clip(path.columns[:, None] + np.arange(-REACH, REACH + 1), 0, s.frequency.size - 1)
    return float((s.power[path.rows[:, None], near] - s.floor[near]).sum(axis=1).mean() * s.spacing)


def _trend(time: Array, power: Array, noise: Array) -> tuple[float, float]:
    """Change of the logarithm of the amplitude over the line's time, and its standard deviation."""
    there = power > noise
    if there.sum() < 5:
        return 0.0, np.inf
    t, size = time[there], 0.5 * np.log(power[there])
    line, covariance = np.polyfit(t, size, 1, cov=True)
    left = size - np.polyval(line, t)
    # windows overlap, and what swings in a band of its own grows and fades by itself
    alike = float(np.clip(left[:-1] @ left[1:] / max(float(left @ left), 1e-300), 0.0, 0.95))
    wider = np.sqrt((1.0 + alike) / (1.0 - alike))
    return float(line[0] * np.ptp(t)), float(wider * np.sqrt(covariance[0, 0]) * np.ptp(t))
