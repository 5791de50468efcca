"""What a test says, in the form that inference takes it: block means with the covariance of their noise.

A constant offset of a sensor and an error of its gain, as large as its stated accuracy allows, are part of the
covariance: they are nuisances with a Gaussian prior. Blocks that contain a change of phase are left out; the instants
of the changes are observations of their own. After the flow has ended the chamber's pressure is the ambient one and
the thrust is none: what the sensors read then is compared as well, for it tells a drift.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from hfanalysis.diagnose.observations.clocks import Delay
from hfanalysis.diagnose.observations.failing import FailingFlow
from hfanalysis.diagnose.observations.opening import SlowOpening
from hfanalysis.diagnose.observations.recorded import TOGETHER
from hfanalysis.diagnose.observations.swinging import Swing

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FORM_ERROR, FORM_TIME = 7e-5, 1.0
"""The finest model-form error: part of a channel's range, and the time [s] over which it is coherent."""

CHAMBER_FORM = 4.0
"""How much larger the model-form error of chamber and thrust is: chemistry and nozzle are idealised further."""

SHARE = 0.7071
"""Part of a stated accuracy that is the zero's error; as much is the span's: squares add up to the whole."""

FADE = "fuel_fade"
"""Among what was stated: the seconds in which the fire went out, with the deviation of their log."""

LEAST_SHARE, MOST_SHARE = 0.05, 0.95
"""Of the noise in a pattern that is slow, from which on it counts, and at most: a covariance of the oscillation that is
only estimated may leave less than nothing to the rest."""

LEAST_VARIANCE = 1e-3
"""Of any combination of blocks, relative to a single block's."""


@dataclass(frozen=True)
class Channel:
    """Block means of one channel: ``time`` [s after the opening], ``value`` and stated ``accuracy`` [SI].

    ``first`` and ``count`` say which points of the common grid are averaged into each block. ``covariance`` is that of
    sensor noise, oscillation, bias and gain. ``resting`` blocks lie before the opening or after the end of the flow.
    ``coherence``: blocks whose noise is worth one independent value. ``slow``: the part of the covariance that is slow
    noise, whose size a quiet time of seconds does not tell exactly; None where there is none.
    """

    name: str
    time: Array
    value: Array
    first: Integers
    count: Integers
    resting: NDArray[np.bool_]
    noise_std: Array
    accuracy: float
    covariance: Array
    coherence: float = 1.0
    slow: Array | None = None

    def only(self, rows: Integers) -> Channel:
        """The same with some of its blocks."""
        picked = {n: getattr(self, n)[rows] for n in ("time", "value", "first", "count", "resting", "noise_std")}
        slow = None if self.slow is None else self.slow[np.ix_(rows, rows)]
        return replace(self, **picked, covariance=self.covariance[np.ix_(rows, rows)], slow=slow)

    def with_white_noise(self) -> Channel:
        """The same with independent noise of the same size, beside offset and gain."""
        burning = np.where(self.resting, 0.0, 1.0)
        gain = self.value * burning / float(np.abs(self.value).max())
        shared = (SHARE * self.accuracy) ** 2 * (np.outer(burning, burning) + np.outer(gain, gain))
        return replace(self, covariance=shared + np.diag(self.noise_std**2), coherence=1.0, slow=None)

    def form_covariance(self, errors: tuple[float, float]) -> Array:
        """Covariance of a model-form error, given as part of the range of tank channels, and of chamber and thrust.

        It is smooth (Matern, 3/2).
        """
        lag = self.time[:, None] - self.time[None, :]
        burning = np.where(self.resting, 0.0, errors[self.name in TOGETHER] * range_of(self.time, self.value))
        smooth = np.sqrt(3.0) * np.abs(lag) / FORM_TIME
        return np.asarray((1.0 + smooth) * np.exp(-smooth) * np.outer(burning, burning))

    def averaged(self, rows: Array) -> Array:
        """Block means of rows (grid, ...) on the common grid."""
        return averaged(rows, self.first, self.count)


def range_of(time: Array, value: Array) -> float:
    """The range of a channel, from its largest value to the least since the opening: the open air is no part of it."""
    return float(value.max() - value[time >= 0.0].min())


def averaged(rows: Array, first: Integers, count: Integers) -> Array:
    """Means over ``count`` rows (grid, ...) from ``first`` on."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    shape = (-1, *([1] * (rows.ndim - 1)))
    return np.asarray((total[first + count] - total[first]) / count.reshape(shape))


@dataclass(frozen=True)
class SlowNoise:
    """Orthonormal ``patterns`` (blocks, patterns) of whitened noise, and the ``shares`` (channels, patterns) of the
    variance in each that are the slow noise of a channel."""

    patterns: Array
    shares: Array


Plain = Delay | FailingFlow | SlowOpening | Swing
"""What is plain in the samples without any model."""


@dataclass(frozen=True)
class Observed:
    """The channels of a test, the instants of its phase changes with their deviations [s], and when it ends [s].

    ``grid`` [s]: points at which a model is asked: through the flow, and ``resting`` ones before it, at the opening and
    after it. ``fuel_out``: where the comparison of the tank goes on beyond the fuel, its measured end, at which that of
    every model ends. ``stated``: what was measured outside the log (SI), or in it beside the blocks (FADE), with
    standard deviations, by name. ``common``: covariance of the first and second of TOGETHER, if both are there.
    ``errors``: model-form error, as part of the range of the tank's channels, and of chamber and thrust. ``plain``:
    what is plain in the samples without a model, and is in no model. ``abrupt``: the seconds that FADE would be if the
    fire were out at once, where a model was asked.
    """

    channels: tuple[Channel, ...]
    grid: Array
    resting: NDArray[np.bool_]
    events: Mapping[str, tuple[float, float]]
    stated: Mapping[str, tuple[float, float]]
    phases: Mapping[str, float]
    end: float
    flow_end: float
    ambient: float
    common: Array | None = None
    errors: tuple[float, float] = (FORM_ERROR, CHAMBER_FORM * FORM_ERROR)
    fuel_out: float | None = None
    plain: tuple[Plain, ...] = ()
    abrupt: float | None = None

    def with_errors(self, tank: float, chamber: float) -> Observed:
        """The same with another model-form error."""
        return replace(self, errors=(tank, chamber))

    def with_white_noise(self) -> Observed:
        """The same as if the noise of blocks were independent: what it costs to think so can be studied."""
        return replace(self, channels=tuple(c.with_white_noise() for c in self.channels), common=None)

    def only(self, names: tuple[str, ...]) -> Observed:
        """The same with these channels alone."""
        kept = tuple(c for c in self.channels if c.name in names)
        both = set(TOGETHER) <= {c.name for c in kept}
        return replace(self, channels=kept, common=self.common if both else None)

    def without(self, left_out: Mapping[str, NDArray[np.bool_]]) -> Observed:
        """The same without some blocks of each channel."""
        keep = {c.name: np.flatnonzero(~left_out[c.name]) for c in self.channels}
        common = self.common
        if common is not None:
            common = common[np.ix_(*(keep[name] for name in TOGETHER))]
        return replace(self, channels=tuple(c.only(keep[c.name]) for c in self.channels), common=common)

    @cached_property
    def log_size(self) -> float:
        """Log of the determinant of the covariance's root."""
        return -float(sum(np.linalg.slogdet(factor)[1] for _, factor in self._factors))

    @cached_property
    def _factors(self) -> tuple[tuple[slice, Array], ...]:
        """Inverse Cholesky factors of groups of channels whose noise goes together, and their rows."""
        out, at, i = [], 0, 0
        while i < len(self.channels):
            c = self.channels[i]
            covariance = c.covariance + c.form_covariance(self.errors)
            i += 1
            if c.name == TOGETHER[0] and self.common is not None:
                other = self.channels[i]
                second = other.covariance + other.form_covariance(self.errors)
                covariance = np.block([[covariance, self.common], [self.common.T, second]])
                i += 1
            factor = _whitening(covariance)
            out.append((slice(at, at + factor.shape[0]), factor))
            at += factor.shape[0]
        return tuple(out)

    @cached_property
    def slow_noise(self) -> SlowNoise:
        """What of the whitened noise is slow."""
        starts = np.cumsum([0, *(c.time.size for c in self.channels)])
        patterns, shares = [], []
        for place, factor in self._factors:
            inside = [i for i in range(len(self.channels)) if place.start <= starts[i] < place.stop]
            of_channel = np.zeros((len(self.channels), factor.shape[0], factor.shape[0]))
            for i in inside:
                if (slow := self.channels[i].slow) is not None:
                    columns = factor[:, starts[i] - place.start : starts[i + 1] - place.start]
                    of_channel[i] = columns @ slow @ columns.T
            values, vectors = np.linalg.eigh(of_channel.sum(axis=0))
            clear = vectors[:, values > LEAST_SHARE]
            rows = np.zeros((int(starts[-1]), clear.shape[1]))
            rows[place] = clear
            share = np.einsum("jk,ijl,lk->ik", clear, of_channel, clear, optimize=True)
            patterns.append(rows)
            shares.append(share * np.minimum(MOST_SHARE / share.sum(axis=0), 1.0))
        return SlowNoise(np.hstack(patterns), np.hstack(shares))

    def whiten(self, rows: Array) -> Array:
        """Rows (blocks of all channels one after the other, ...) in units in which the noise is white and of size
        one."""
        return np.concatenate([factor @ rows[place] for place, factor in self._factors])

    def rewhitened(self, rows: Array, other: Observed) -> Array:
        """Rows that ``other`` has whitened, which differs in its model-form error only, as this one does.

        Rows beyond the blocks, of events and of what was stated, stay as they are.
        """
        out = rows.copy()
        for (place, factor), (_, before) in zip(self._factors, other._factors, strict=True):
            out[place] = factor @ solve_triangular(before, rows[place], lower=True)
        return out

    def left_open(self, residual: Array) -> tuple[float, float]:
        """Mean square of a whitened residual over the tank's channels, and over chamber and thrust; 0 without any."""
        together = np.concatenate([np.full(c.time.size, c.name in TOGETHER) for c in self.channels])
        square = residual[: together.size] ** 2
        tank, chamber = (float(square[side].mean()) if side.any() else 0.0 for side in (~together, together))
        return tank, chamber

    @property
    def longest(self) -> float:
        """The last instant that anything is known of [s]."""
        weighed = self.flow_end if "fuel_mass_after" in self.stated else self.end
        burning = self.grid[~self.resting]
        return max([weighed, float(burning[-1]), *(at for at, _ in self.events.values())])

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(c.name for c in self.channels)


def _whitening(covariance: Array) -> Array:
    """W, lower triangular, with W C W^T = 1.

    An estimated covariance need not be positive: what is smaller than LEAST_VARIANCE is raised.
    """
    try:
        root = cholesky(covariance, lower=True, check_finite=False)
    except np.linalg.LinAlgError:
        size = np.sqrt(covariance.diagonal())
        values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
        raised = (vectors * np.maximum(values, LEAST_VARIANCE)) @ vectors.T
        root = cholesky(raised * np.outer(size, size), lower=True)
    return np.tril(np.linalg.inv(root))
