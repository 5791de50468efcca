"""Where a signal breaks: kinks and sudden relaxations, found by least squares over the instant of the break.

For every candidate instant the signal is fitted by a smooth curve on either side that meets at the break. The sum of
squares against the instant gives its likelihood; the noise is judged from the residuals, with their autocorrelation
counted, so that a wandering sensor does not pass for a precise one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal

Design = Callable[[Array, float | Array], Array]
"""The columns (n, parameters) of a shape at times (n,) [s] that breaks at an instant [s]; at instants (k, 1) [s]
(k, n, parameters)."""

RELAXATIONS = (0.0, 0.001, 0.002, 0.003, 0.005, 0.008, 0.013, 0.02, 0.03, 0.05, 0.08, 0.13, 0.2, 0.3, 0.6)
"""Time constants tried for what follows a break [s]; 0 is a step."""

SHAPE = 0.3
"""Part of the sample interval that the shape of an onset leaves open, whatever the noise. Evidence: without it onsets
of other shapes were dated too surely (test_breaks.py)."""

WANDER_POINTS = 120
"""Block means over a window that are enough to carry the wander into the instant."""

AT_ONCE = 1 << 18
"""Samples of all curves that are fitted at a time: they fit a processor's cache."""


@dataclass(frozen=True)
class Break:
    """An instant of a break [s, time of the signal] with its standard deviation.

    ``candidates`` and ``log_likelihood`` are the profile it comes from; ``relaxation`` is the best time constant [s] of
    what follows.
    """

    time: float
    std: float
    candidates: Array
    log_likelihood: Array
    relaxation: float
    channels: tuple[str, ...]


def kink(order: int = 2, before: int | None = None) -> Design:
    """Curves of the given polynomial order on both sides, equal at the break; ``before``: the left one's order."""
    left = order if before is None else before

    def columns(time: Array, instant: float | Array) -> Array:
        x = time - instant
        past, future = np.minimum(x, 0.0), np.maximum(x, 0.0)
        powers = [past**k for k in range(1, left + 1)] + [future**k for k in range(1, order + 1)]
        return np.stack([np.ones_like(x), *powers], axis=-1)

    return columns


def rounded_kink(width: float) -> Design:
    """One parabola on which the slope changes, not at once but evenly over ``width`` [s] about the break."""

    def columns(time: Array, instant: float | Array) -> Array:
        x = time - instant
        inside = np.clip(x + 0.5 * width, 0.0, width)
        turned = inside**2 / (2.0 * width) + np.maximum(x - 0.5 * width, 0.0)
        return np.stack([np.ones_like(x), x, x**2, turned], axis=-1)

    return columns


def relaxation(time_constant: float, before: int = 1, jumps: bool = False) -> Design:
    """A curve of order ``before``, then a change that relaxes with a time constant [s] onto another straight line;
    ``jumps``: a part of it comes at once."""

    def columns(time: Array, instant: float | Array) -> Array:
        x = time - instant
        past, future = np.minimum(x, 0.0), np.maximum(x, 0.0)
        after = (x >= 0.0).astype(np.float64)
        change = after if time_constant == 0.0 else 1.0 - np.exp(-future / time_constant)
        powers = [past**k for k in range(1, before + 1)]
        at_once = [after] if jumps else []
        return np.stack([np.ones_like(x), *powers, future, change, *at_once], axis=-1)

    return columns


def find_break(
    signal: Signal,
    candidates: Array,
    designs: Sequence[Design],
    constants: Sequence[float] = (0.0,),
    noise: Noise | None = None,
    richer: int = 0,
) -> Break:
    """The most likely instant [s] of a break in a signal (a window around it), over the candidate instants (k,) [s].

    ``designs`` are the shapes tried; each instant takes its best. ``constants`` are their time constants [s], for the
    record. ``noise`` is the sensor's, with its slow wander, which the residuals of so short a window do not show. The
    last ``richer`` designs have a parameter more, and must pay for it (Schwarz, Annals of Statistics 6, 1978, 461-464).
    """
    sums = np.array([_sums_of_squares(signal, design, candidates) for design in designs])
    if richer:
        shape, at = divmod(int(np.argmin(sums)), candidates.size)
        fitted = _noise_variance(signal, designs[shape], float(candidates[at]))
        sums[-richer:] += np.log(max(signal.time.size, 2)) * fitted
    best = int(np.argmin(sums.min(axis=1)))
    profile = sums.min(axis=0)
    instant = float(candidates[int(np.argmin(profile))])
    scale = _noise_variance(signal, designs[best], instant)
    log_likelihood = -0.5 * (profile - profile.min()) / scale
    constant = constants[best] if best < len(constants) else 0.0
    found = _summarise(candidates, log_likelihood, constant, (signal.name,), signal.step)
    if noise is None:
        return found
    return replace(
        found,
        std=max(
            found.std,
            float(np.hypot(_linear_std(signal, designs[best], found.time, noise), signal.step / np.sqrt(12.0))),
        ),
    )


def combine(breaks: Sequence[Break], step: float) -> Break:
    """One instant [s] from several signals that break together: their profiles multiply (same candidates).

    ``step`` [s] is the finest sampling among them.
    """
    if len(breaks) == 1:
        return breaks[0]
    total = np.sum([b.log_likelihood for b in breaks], axis=0)
    names = tuple(name for b in breaks for name in b.channels)
    return _summarise(breaks[0].candidates, total - total.max(), breaks[0].relaxation, names, step)


def _summarise(candidates: Array, log_likelihood: Array, constant: float, names: tuple[str, ...], step: float) -> Break:
    """Mean and spread over the profile.

    A change that is over within a sample interval is dated no better than that, and a slower one no better than SHAPE
    of it: real onsets are not exactly of the shapes that are tried.
    """
    unseen = step * min(1.0, max((step / max(constant, 1e-9)) ** 2, SHAPE))
    weight = np.exp(log_likelihood - log_likelihood.max()) * np.gradient(candidates)
    weight /= weight.sum()
    mean = float(weight @ candidates)
    spread = float(weight @ (candidates - mean) ** 2)
    return Break(mean, float(np.sqrt(spread + unseen**2 / 12.0)), candidates, log_likelihood, constant, names)


def _sums_of_squares(signal: Signal, design: Design, instants: Array) -> Array:
    """What a shape leaves of the signal with its break at each of the instants (k,) [s], (k,)."""
    parts = np.array_split(instants, 1 + instants.size * signal.time.size // AT_ONCE)
    return np.concatenate([np.einsum("ij,ij->i", r, r) for r in (_residuals(signal, design, p) for p in parts)])


def _residuals(signal: Signal, design: Design, instants: Array) -> Array:
    """The signal (n,) less the best curves of a shape that break at the instants (k,) [s], (k, n)."""
    x = design(signal.time, instants[:, np.newaxis])
    across = np.swapaxes(x, 1, 2)
    gram = across @ x
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(gram, axis1=1, axis2=2), 1e-30))
    scaled = gram * scale[:, :, np.newaxis] * scale[:, np.newaxis, :] + 1e-11 * np.eye(x.shape[2])
    beta = np.linalg.solve(scaled, ((across @ signal.value) * scale)[:, :, np.newaxis])[:, :, 0] * scale
    return np.asarray(signal.value - (x @ beta[:, :, np.newaxis])[:, :, 0])


def _linear_std(signal: Signal, design: Design, instant: float, noise: Noise) -> float:
    """Standard deviation of the instant from white noise and wander together, to first order in both."""
    part = signal.reduced(float(np.ptp(signal.time)) / WANDER_POINTS)
    small = max(1e-4, 0.05 * signal.step)
    x = design(part.time, instant)
    beta, *_ = np.linalg.lstsq(x, part.value, rcond=None)
    by_instant = (design(part.time, instant + small) - design(part.time, instant - small)) @ beta / (2.0 * small)
    weights = np.linalg.pinv(np.column_stack([x, by_instant]), rcond=1e-10)[-1]
    return noise.std_of(weights, part.time)


def _noise_variance(signal: Signal, design: Design, instant: float) -> float:
    """Variance per independent sample: that of the residuals times the length of their memory in samples."""
    residual: Array = _residuals(signal, design, np.array([instant]))[0]
    variance = float(residual @ residual) / max(residual.size - 6, 1)
    return max(variance * memory_length(residual), 1e-12 * float(np.ptp(signal.value)) ** 2, 1e-300)


def memory_length(residual: Array) -> float:
    """Integrated autocorrelation of a noise series (n,) [samples] (1 for white noise): initial positive sequence.

    Pairs of lags are added while their sum is positive, which keeps the far, noisy lags out (Geyer, Statistical Science
    7, 1992, 473-483).
    """
    n = residual.size
    if n < 8:
        return 1.0
    x = residual - residual.mean()
    spectrum = np.abs(np.fft.rfft(x, 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: n // 2]
    if correlation[0] <= 0.0:
        return 1.0
    correlation = correlation / correlation[0]
    pairs = correlation[1:-1:2] + correlation[2::2]
    stop = np.flatnonzero(pairs <= 0.0)
    used = pairs[: stop[0]] if stop.size else pairs
    return float(max(1.0, 1.0 + 2.0 * used.sum()))
