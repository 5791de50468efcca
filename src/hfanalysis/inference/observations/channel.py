"""Block means of one channel with the covariance of what they may be off by."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array, Integers
from hfanalysis.inference.observations.recorded import TOGETHER
from hfanalysis.record.accuracy import SPAN_SHARE

FORM_ERROR, FORM_TIME = 7e-5, 1.0
"""The finest model-form error: part of a channel's range [-], and the time over which it is coherent [s]."""

CHAMBER_FORM = 4.0
"""How much larger the model-form error of chamber and thrust is: chemistry and nozzle are idealized further."""


@dataclass(frozen=True)
class ObservedChannel:
    """Block means of one channel: ``time`` [s after the opening], ``value`` and stated ``accuracy`` [SI].

    ``first`` and ``count`` say which points of the common grid are averaged into each block. ``covariance`` is that of
    sensor noise, oscillation, bias and gain. ``resting`` blocks lie before the opening or after the end of the flow.
    ``coherence``: blocks whose noise is worth one independent value. ``slow``: the part of the covariance that is slow
    noise, whose size a quiet time of seconds does not tell exactly, but to the standard deviation ``unsure`` of the log
    of its amplitude; None where there is none. ``span``: the range that the model-form error is a part of, where it is
    not the channel's own. ``courses`` (blocks, courses): what a model would read more if the course of an
    effect were another one by a standard deviation; None where that was not asked. ``moved`` (blocks, errors) [SI]:
    what it differs by if an instant on which the model is laid was seen a standard deviation late, or more flows
    without fire; it is part of the covariance.

    Arrays are (blocks,), the covariances (blocks, blocks) [SI squared].
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
    span: float | None = None
    unsure: float = 1.0
    courses: Array | None = None
    moved: Array | None = None

    def only(self, rows: Integers) -> ObservedChannel:
        """The same with some of its blocks; ``rows`` (kept,): their numbers."""
        picked = {n: getattr(self, n)[rows] for n in ("time", "value", "first", "count", "resting", "noise_std")}
        slow = None if self.slow is None else self.slow[np.ix_(rows, rows)]
        courses, moved = (None if x is None else x[rows] for x in (self.courses, self.moved))
        covariance = self.covariance[np.ix_(rows, rows)]
        return replace(self, **picked, covariance=covariance, slow=slow, courses=courses, moved=moved)

    def with_white_noise(self) -> ObservedChannel:
        """The same with independent noise of the same size, beside offset and gain."""
        burning = np.where(self.resting, 0.0, 1.0)
        gain = self.value * burning / float(np.abs(self.value).max())
        shared = (SPAN_SHARE * self.accuracy) ** 2 * (np.outer(burning, burning) + np.outer(gain, gain))
        return replace(self, covariance=shared + np.diag(self.noise_std**2), coherence=1.0, slow=None)

    def form_covariance(self, errors: tuple[float, float]) -> Array:
        """Covariance (blocks, blocks) [SI squared] of a model-form error.

        ``errors``: its standard deviations as parts of the range of tank channels, and of chamber and thrust.
        """
        return form_covariance(self.time, self.form_size(errors))

    def form_size(self, errors: tuple[float, float]) -> Array:
        """Standard deviation (blocks,) [SI] of a model-form error; ``errors`` as in :meth:`form_covariance`."""
        span = range_of(self.time, self.value) if self.span is None else self.span
        return np.where(self.resting, 0.0, errors[self.name in TOGETHER] * span)

    def averaged(self, rows: Array) -> Array:
        """Block means (blocks, ...) of rows (grid, ...) on the common grid [the rows' unit]."""
        return averaged(rows, self.first, self.count)


def form_covariance(time: Array, size: Array) -> Array:
    """Covariance (blocks, blocks) of a model-form error of this ``size`` (blocks,) [SI] in blocks at ``time`` (blocks,)
    [s].

    It is smooth: the Matern covariance of order 3/2 (Rasmussen and Williams, Gaussian Processes, eq. 4.17) over
    FORM_TIME.

    >>> form_covariance(np.array([0.0, 1.0]), np.array([2.0, 2.0])).round(2).tolist()
    [[4.0, 1.93], [1.93, 4.0]]
    """
    smooth = np.sqrt(3.0) * np.abs(time[:, None] - time[None, :]) / FORM_TIME
    return np.asarray((1.0 + smooth) * np.exp(-smooth) * np.outer(size, size))


def range_of(time: Array, value: Array) -> float:
    """The range of a channel [SI], from its largest ``value`` (n,) to the least since the opening: the open air is no
    part of it. ``time`` (n,) [s after the opening]."""
    return float(value.max() - value[time >= 0.0].min())


def averaged(rows: Array, first: Integers, count: Integers) -> Array:
    """Means (blocks, ...) over ``count`` (blocks,) rows (grid, ...) from ``first`` (blocks,) on [the rows' unit].

    >>> averaged(np.array([1.0, 3.0, 5.0]), np.array([0, 2]), np.array([2, 1])).tolist()
    [2.0, 5.0]
    """
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    shape = (-1, *([1] * (rows.ndim - 1)))
    return np.asarray((total[first + count] - total[first]) / count.reshape(shape))
