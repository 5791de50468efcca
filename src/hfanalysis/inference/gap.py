"""The gap between model and measurement, by channel and phase, and which part of it an explanation closes.

Where a sensor's offset and gain are uncertain, what they explain is no gap of the model: it is taken off first. So is
what the instants may be off by on which the model is laid over the measurement: a valve opens over tens of
milliseconds, and in that time a chamber's pressure is missed by more than in all that follows. The gap is what is left
beyond the noise: sqrt(max(0, rms^2 - noise^2)). The mean square of noise varies by chance, the more the slower it is,
and how large slow noise is a quiet time tells to a factor only: where fractions are taken, an excess that either makes
of no gap counts as none, before and after.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.candidate import SHORT, attempted
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import added, predict, readings
from hfanalysis.inference.fitting.threads import each
from hfanalysis.inference.observations.channel import ObservedChannel
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import has_name

FOLDS, FOLD_TIME = 2, 0.5
"""Interleaved parts of the data that are held out in turn, and the time that each stretch of them lasts [s]."""

CHANCE = 2.0
"""Standard deviations of the mean square of noise beyond which an excess is no chance. Source: were it normal, one in
nine tests of five channels would have one by chance alone. Evidence: rms^2 less noise^2, cut at zero, left 0.6 of the
noise in five channels as a gap that the right model could not close."""

LIKELY = 2.0
"""Standard deviations that an instant may be off by: more is no error of an instant. Source: 95 %. Evidence: a line
that fills looks like an opening seen eight of them late."""

LEAST_GAP = 0.5
"""Gap, in units of the noise, below which there is no fraction of it to close."""


class Ran(Protocol):
    """A model that was run: a fit, or one with constants as they are."""

    @property
    def hypothesis(self) -> Hypothesis: ...
    @property
    def x(self) -> Array: ...
    @property
    def burnt(self) -> Burn: ...


@dataclass(frozen=True)
class AsStated:
    """A hypothesis at the centers of its priors ``x``, and its burn."""

    hypothesis: Hypothesis
    x: Array
    burnt: Burn


def as_calibrated(hypothesis: Hypothesis, observed: Observed) -> AsStated:
    """A hypothesis run with the constants that it starts from. Raises ValueError or ArithmeticError where it cannot
    be."""
    x = np.zeros(hypothesis.size)
    return AsStated(hypothesis, x, predict(hypothesis, observed, x, tangents=False).burnt)


def residuals_of(found: Ran, observed: Observed) -> dict[str, Array]:
    """Measured less model of every channel over its blocks (blocks,) [SI], less what offset and gain of the sensor and
    errors of the instants explain."""
    read = readings(observed, found.burnt)
    raw = [
        c.value - c.averaged(read[c.name]) - added(found.hypothesis, observed, found.x, c) for c in observed.channels
    ]
    return {c.name: r - b for c, r, b in zip(observed.channels, raw, _biases(observed, raw), strict=True)}


def _biases(observed: Observed, raw: Sequence[Array]) -> list[Array]:
    """The most probable offset and gain of every sensor, as its stated accuracy allows, and errors of the instants: the
    same in all channels, and no larger than LIKELY. By the blocks that count: what the model gets wrong while the line
    fills is no sensor's offset."""
    channels = observed.channels
    instants = max((c.moved.shape[1] for c in channels if c.moved is not None), default=0)
    shapes, rows, left = [], [], []
    for i, (c, r) in enumerate(zip(channels, raw, strict=True)):
        own = np.zeros((c.time.size, 2 * len(channels) + instants))
        own[:, 2 * i] = c.accuracy * ~c.resting
        own[:, 2 * i + 1] = own[:, 2 * i] * c.value / float(np.abs(c.value).max())
        if c.moved is not None:
            own[:, 2 * len(channels) : 2 * len(channels) + c.moved.shape[1]] = c.moved
        shapes.append(own)
        if not (counts := np.flatnonzero(flowing(c, observed))).size:
            continue
        noise = np.diag(c.noise_std**2) + c.form_covariance(observed.errors)
        factor = np.linalg.cholesky(noise[np.ix_(counts, counts)])
        rows.append(solve_triangular(factor, own[counts], lower=True))
        left.append(solve_triangular(factor, r[counts], lower=True))
    count = shapes[0].shape[1]
    most = np.where(np.arange(count) < 2 * len(channels), np.inf, LIKELY)
    system = np.vstack([*rows, np.eye(count)])
    sizes = lsq_linear(system, np.concatenate([*left, np.zeros(count)]), (-most, most), method="bvls").x
    return [np.asarray(own @ sizes) for own in shapes]


def root_mean_square(found: Ran, observed: Observed) -> dict[str, float]:
    """Of :func:`residuals_of` from the full line on, by channel [SI]."""
    left = residuals_of(found, observed)
    return {c.name: float(np.sqrt(np.mean(left[c.name][flowing(c, observed)] ** 2))) for c in observed.channels}


def flowing(channel: ObservedChannel, observed: Observed) -> NDArray[np.bool_]:
    """Which blocks (blocks,) lie between the filling of the line, which the base model does not have, and the end of
    the flow."""
    return ~channel.resting & (channel.time >= observed.phases["liquid"]) & (channel.time > 0.0)


def noise_of(observed: Observed) -> dict[str, float]:
    """Root mean square of the noise of blocks, by channel [SI]."""
    return {c.name: float(np.sqrt(np.mean(c.noise_std[flowing(c, observed)] ** 2))) for c in observed.channels}


def by_phase(found: Fit, observed: Observed) -> dict[str, dict[str, float]]:
    """The gap by channel and phase [SI]."""
    left = residuals_of(found, observed)
    names = [n for n in observed.phases if n != "end"]
    starts = [observed.phases[n] for n in names]
    out: dict[str, dict[str, float]] = {}
    for c in observed.channels:
        number = np.searchsorted(starts, c.time, side="right") - 1
        for i, phase in enumerate(names):
            inside = (number == i) & ~c.resting
            if inside.sum() > 3:
                excess = float(np.mean(left[c.name][inside] ** 2) - np.mean(c.noise_std[inside] ** 2))
                out.setdefault(c.name, {})[phase] = float(np.sqrt(max(excess, 0.0)))
    return out


def total_gap(found: Ran, observed: Observed, where: dict[str, NDArray[np.bool_]] | None = None) -> float:
    """The gap of all channels together [-], each in units of its noise, as far as it is no chance.

    ``where``: by channel, the blocks (blocks,) that count; all by default.
    """
    left = residuals_of(found, observed)
    total = 0.0
    for c in observed.channels:
        mask = flowing(c, observed) if where is None else where[c.name] & flowing(c, observed)
        if mask.any():
            noise = float(np.mean(c.noise_std[mask] ** 2))
            excess = float(np.mean(left[c.name][mask] ** 2)) / noise - 1.0
            total += excess if excess > CHANCE * _chance(c, mask, noise) else 0.0
    return float(np.sqrt(total))


def _chance(channel: ObservedChannel, mask: NDArray[np.bool_], noise: float) -> float:
    """Standard deviation of the mean square of noise over ``noise``: by chance, and for its slow part is known to a
    factor only, as the evidence has it."""
    slow = 0.0 if channel.slow is None else float(np.mean(channel.slow.diagonal()[mask])) / noise
    return float(np.hypot(np.sqrt(2.0 * channel.coherence / mask.sum()), 2.0 * channel.unsure * min(slow, 1.0)))


def closed(before: float, after: float) -> float | None:
    """The part [-] of a gap that is closed; None where there was none. Both gaps in units of the noise.

    >>> closed(4.0, 1.0), closed(0.3, 0.1)
    (0.75, None)
    """
    return None if before < LEAST_GAP else 1.0 - after / before


def held_out(before: Fit, after: Fit, fitted: Observed, observed: Observed) -> float | None:
    """The part of the gap closed in stretches that neither model was fitted to.

    ``fitted``: the observations at the model-form error of the fits; ``observed``: those that the gap is measured by. A
    part [-]; None where a fit cannot be run.
    """
    folds = [_fold(observed, fold) for fold in range(FOLDS)]
    rest = [fitted.without(stretches(fitted, observed, fold)) for fold in range(FOLDS)]
    tried = [(fold, model) for fold in range(FOLDS) for model in (before, after)]
    fits = each(lambda t: attempted(t[1].hypothesis, rest[t[0]], t[1].x, SHORT), tried)
    found = [f for f in fits if f is not None]
    if len(found) < len(tried):
        return None
    gaps = [total_gap(f, observed, folds[fold]) for f, (fold, _) in zip(found, tried, strict=True)]
    return closed(*np.sqrt(np.mean(np.reshape(gaps, (FOLDS, 2)) ** 2, axis=0)).tolist())


def stretches(fitted: Observed, observed: Observed, fold: int) -> dict[str, NDArray[np.bool_]]:
    """The blocks (blocks,) of each channel that a fit leaves out in turn: those of :data:`FOLDS` while it burns."""
    return {name: mask & _burning(fitted, name) for name, mask in _fold(observed, fold).items()}


def _fold(observed: Observed, fold: int) -> dict[str, NDArray[np.bool_]]:
    """The blocks of each channel that are held out in turn."""
    return {c.name: np.floor(c.time / FOLD_TIME).astype(int) % FOLDS == fold for c in observed.channels}


def _burning(observed: Observed, name: str) -> NDArray[np.bool_]:
    return ~next(c for c in observed.channels if c.name == name).resting


def frozen(hypothesis: Hypothesis, found: Fit) -> Hypothesis:
    """A hypothesis of another test with the effects of a fit, their constants as found there."""
    effects = tuple(a for a in found.hypothesis.at(found.x).effects if has_name(a.effect))
    return replace(hypothesis, engine=replace(hypothesis.engine, effects=effects))
