"""Channels that fluctuate in a known way."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal, sample_noise

MEAN = 2e6
"""[Pa] that everything is a share of."""


def clock(rate: float, end: float, jitter: float = 0.0, seed: int = 0) -> Array:
    """Samples from a second before the opening to one after the ``end`` [s], uneven by ``jitter`` periods."""
    time = np.arange(-1.0, end + 1.0, 1.0 / rate)
    return np.asarray(time + jitter / rate * np.random.default_rng(seed).uniform(-0.5, 0.5, time.size))


def noise(time: Array, share: float, color: float = 0.0, seed: int = 1) -> Array:
    """Noise of a standard deviation that is a ``share`` of the mean; ``color``: what each sample has of the last."""
    white = np.random.default_rng(seed).standard_normal(time.size)
    found = lfilter([1.0], [1.0, -color], white)
    return np.asarray(share * MEAN * found / found.std())


def wave(time: Array, share: float, frequency: float, slope: float = 0.0) -> Array:
    """A line whose rms is a ``share`` of the mean, at a ``frequency`` [Hz] that moves by ``slope`` [Hz/s]."""
    turns = frequency * time + 0.5 * slope * time**2
    return np.asarray(np.sqrt(2.0) * share * MEAN * np.cos(2.0 * np.pi * turns))


def signal(time: Array, *parts: Array, name: str = "p_chamber") -> Signal:
    """A falling pressure with these fluctuations."""
    value = MEAN * np.exp(-0.05 * time) + np.sum(parts, axis=0)
    return Signal(name, time, value, sample_noise(value), float(np.median(np.diff(time))))
