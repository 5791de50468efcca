"""What the blocks of a test may be off by, as factors that make it white, at every model-form error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import block_diag, cholesky, lapack

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.channel import ObservedChannel, form_covariance
from hfanalysis.inference.observations.recorded import ALIKE, TOGETHER

LEAST_SHARE, MOST_SHARE = 0.05, 0.95
"""Of the noise in a pattern that is slow, from which on it counts, and at most: a covariance of the oscillation that is
only estimated may leave less than nothing to the rest."""

LEAST_VARIANCE = 1e-3
"""Of any combination of blocks, relative to a single block's."""


@dataclass(frozen=True)
class SlowNoise:
    """Orthonormal ``patterns`` (blocks, patterns) of whitened noise, and the ``shares`` (channels, patterns) of the
    variance in each that are the slow noise of a channel.

    ``unsure`` (channels,): standard deviations of the log of its amplitude.
    """

    patterns: Array
    shares: Array
    unsure: Array


@dataclass(frozen=True, eq=False)
class Group:
    """Channels whose noise goes together, with ``common``, the covariance of the first and second if there are two.

    What is made for a model-form error is kept: a search asks for it again and again. ``place``: their blocks among
    those of all channels; ``first``: the number of the first channel among all. ``alike``: what the model gets wrong is
    one error in both.
    """

    channels: tuple[ObservedChannel, ...]
    common: Array | None
    place: slice
    first: int
    alike: bool = False
    _whitening: dict[float, Array] = field(default_factory=dict)
    _slow: dict[float, tuple[Array, Array]] = field(default_factory=dict)

    def _error(self, errors: tuple[float, float]) -> float:
        """The model-form error that counts for these channels."""
        return errors[self.channels[0].name in TOGETHER]

    def whitening(self, errors: tuple[float, float]) -> Array:
        """The inverse Cholesky factor (blocks, blocks) [1/SI] of their covariance at a model-form error (parts of a
        range)."""
        key = self._error(errors)
        if key not in self._whitening:
            own = [c.covariance for c in self.channels]
            noise = own[0] if self.common is None else np.block([[own[0], self.common], [self.common.T, own[1]]])
            self._whitening[key] = _whitening(noise + self._form_covariance(errors))
        return self._whitening[key]

    def _form_covariance(self, errors: tuple[float, float]) -> Array:
        """Covariance of what the model gets wrong."""
        if not self.alike:
            return np.asarray(block_diag(*(c.form_covariance(errors) for c in self.channels)))
        time = np.concatenate([c.time for c in self.channels])
        return form_covariance(time, np.concatenate([c.form_size(errors) for c in self.channels]))

    def slow(self, errors: tuple[float, float]) -> tuple[Array, Array]:
        """Orthonormal patterns (blocks, patterns) of the whitened noise, and the share (channels, patterns) of the
        variance in each that is the slow noise of each channel. ``errors``: model-form error (parts of a range)."""
        key = self._error(errors)
        if key not in self._slow:
            self._slow[key] = self._slow_patterns(self.whitening(errors))
        return self._slow[key]

    def _slow_patterns(self, factor: Array) -> tuple[Array, Array]:
        of_channel, at = np.zeros((len(self.channels), factor.shape[0], factor.shape[0])), 0
        for i, channel in enumerate(self.channels):
            if channel.slow is not None:
                columns = factor[:, at : at + channel.time.size]
                of_channel[i] = columns @ channel.slow @ columns.T
            at += channel.time.size
        values, vectors = np.linalg.eigh(of_channel.sum(axis=0))
        clear = vectors[:, values > LEAST_SHARE]
        share = np.stack([np.sum(clear * (slow @ clear), axis=0) for slow in of_channel])
        return clear, share * np.minimum(MOST_SHARE / share.sum(axis=0), 1.0)


def groups_of(channels: Sequence[ObservedChannel], common: Array | None, alike: Array | None) -> Iterator[Group]:
    """The channels, one by one or, where two of them have a ``common`` covariance or are ``alike``, together.
    Covariances (blocks of the first, blocks of the second) [SI]."""
    shared, at, i = {TOGETHER[0]: common, ALIKE[0]: alike}, 0, 0
    while i < len(channels):
        name = channels[i].name
        between = shared.get(name)
        inside = tuple(channels[i : i + (1 if between is None else 2)])
        size = sum(c.time.size for c in inside)
        yield Group(inside, between, slice(at, at + size), i, name == ALIKE[0] and between is not None)
        at, i = at + size, i + len(inside)


def slow_noise(groups: Sequence[Group], errors: tuple[float, float]) -> SlowNoise:
    """What of the whitened noise of all groups is slow. ``errors``: model-form error (parts of a range)."""
    found = [group.slow(errors) for group in groups]
    number = sum(clear.shape[1] for clear, _ in found)
    patterns = np.zeros((groups[-1].place.stop, number))
    shares = np.zeros((sum(len(group.channels) for group in groups), number))
    at = 0
    for group, (clear, share) in zip(groups, found, strict=True):
        columns = slice(at, at + clear.shape[1])
        patterns[group.place, columns] = clear
        shares[group.first : group.first + len(group.channels), columns] = share
        at = columns.stop
    return SlowNoise(patterns, shares, np.array([c.unsure for group in groups for c in group.channels]))


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
    return np.asarray(lapack.dtrtri(root, lower=1)[0])
