"""Measured channels on common cells of time, and the test functions that average over them.

The cells of a phase are equally long, so that a test function and its slope are exact for what is constant or grows
evenly over time. Test functions do not reach into gaps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csr_array

from hfanalysis.arrays import Array, Mask
from hfanalysis.diagnose.weak_form.linear import LinearHistory

SHORTEST_CELL, MOST_CELLS = 0.03, 200
"""Seconds, and how many cells there are at most."""

LEAST_BLOCKS = 8
"""Blocks of a channel below which it says nothing about a phase."""

NEAR = 0.3
"""Seconds of blocks through which a line is put to read a channel beyond its first or last block."""

GAP = 0.25
"""Seconds without a block from which on a channel has a gap."""

FEWEST = 3
"""Cells on either side of a test function's middle, at least."""


class Reading(Protocol):
    """Block means of a channel: instants [s after the opening], values [SI], and the covariance of their noise."""

    @property
    def name(self) -> str:
        """Canonical name."""
        ...

    @property
    def time(self) -> Array:
        """Instants (blocks,) [s after the opening]."""
        ...

    @property
    def value(self) -> Array:
        """Values (blocks,) [SI]."""
        ...

    @property
    def covariance(self) -> Array:
        """Of the values (blocks, blocks) [SI squared], without model-form error."""
        ...


class Readings(Protocol):
    """What a test says: :class:`hfanalysis.inference.observations.observed.Observed` is one."""

    @property
    def channels(self) -> Sequence[Reading]:
        """The channels."""
        ...

    @property
    def phases(self) -> Mapping[str, float]:
        """Where each phase begins [s after the opening]."""
        ...

    @property
    def end(self) -> float:
        """Where the comparison ends [s after the opening]."""
        ...


@dataclass(frozen=True)
class Cells:
    """Cells from the opening on: their middles and widths (cells,) [s], and how many lie before the end of the liquid.

    ``liquid_out`` [s after the opening]: None where no vapor phase is long enough.
    """

    time: Array
    width: Array
    wet: int
    liquid_out: float | None

    @property
    def end(self) -> float:
        """Of the last cell [s after the opening]."""
        return float(self.time[-1] + 0.5 * self.width[-1])

    @property
    def phases(self) -> tuple[slice, ...]:
        """The cells before and after the end of the liquid."""
        parts = slice(0, self.wet), slice(self.wet, self.time.size)
        return parts if self.wet < self.time.size else parts[:1]


def cells_of(readings: Readings, window: float) -> Cells:
    """Cells for test functions of a length ``window`` [s]; their middles and widths [s]."""
    end, gone = readings.end, readings.phases.get("vapor")
    if gone is not None and not 0.0 < gone < end - window:
        end, gone = min(end, gone) if gone > 0.0 else end, None
    blocks = [float(np.median(np.diff(c.time))) for c in readings.channels if c.time.size > LEAST_BLOCKS]
    spacing = min(max(SHORTEST_CELL, end / MOST_CELLS, *blocks), window / (2.0 * (FEWEST + 1)))
    bounds = [(0.0, end)] if gone is None else [(0.0, gone), (gone, end)]
    time, width, wet = [], [], 0
    for start, stop in bounds:
        count = max(round((stop - start) / spacing), 1)
        size = (stop - start) / count
        time.append(start + size * (np.arange(count) + 0.5))
        width.append(np.full(count, size))
        wet = wet or count
    return Cells(np.concatenate(time), np.concatenate(width), wet, gone)


@dataclass(frozen=True)
class Sampled:
    """A channel on cells: ``weights`` (cells and the end of the liquid, blocks) read it from its blocks; ``covered``:
    cells that lie between blocks without a gap."""

    weights: csr_array
    covered: Mask

    def covariance(self, reading: Reading, kept: Mask) -> Array:
        """Of the readings on cells and at the end of the liquid, (cells + 1, cells + 1) [SI squared]; ``kept``: the
        blocks that are read."""
        first = self.weights @ reading.covariance[np.ix_(kept, kept)]
        return np.asarray((self.weights @ first.T).T)


def within(reading: Reading, end: float) -> Mask:
    """The blocks (blocks,) of a channel that are compared: up to ``end`` [s after the opening]."""
    return np.asarray((reading.time >= 0.0) & (reading.time <= end))


def sample(time: Array, cells: Cells) -> Sampled | None:
    """How a channel with blocks at ``time`` (blocks,) [s after the opening] is read on cells; None where a phase has
    too few of them."""
    weights = np.zeros((cells.time.size + 1, time.size))
    covered = np.zeros(cells.time.size, dtype=bool)
    gone = np.inf if cells.liquid_out is None else cells.liquid_out
    for k, part in enumerate(cells.phases):
        split = int(np.searchsorted(time, gone))
        own = slice(0, split) if k == 0 else slice(split, time.size)
        if own.stop - own.start < LEAST_BLOCKS:
            return None
        for i in range(part.start, part.stop):
            covered[i] = _fill(weights[i, own], time[own], float(cells.time[i]), 0.5 * float(cells.width[i]))
        if k == 0 and cells.liquid_out is not None:
            weights[-1, own] = _line(time[own], gone)
    return Sampled(csr_array(weights), covered)


def _fill(row: Array, time: Array, at: float, half: float) -> bool:
    """Writes the weights of blocks that give a cell's mean; whether the cell lies among them.

    It is the mean of the straight lines between the blocks: what changes evenly over time is read without an error.
    """
    low, high = at - half, at + half
    if not time[0] <= at <= time[-1]:
        row[:] = _line(time, at)
        return False
    if low < time[0] or high > time[-1]:
        low = high = at
    first, last = np.searchsorted(time, low, side="right"), np.searchsorted(time, high)
    knots = np.concatenate([[low], time[first:last], [high]])
    share = np.full(knots.size, 1.0 / knots.size) if high == low else _trapezoid(knots)
    behind = np.clip(np.searchsorted(time, knots), 1, time.size - 1)
    apart = time[behind] - time[behind - 1]
    ahead = (knots - time[behind - 1]) / apart
    for j, before, after in zip(behind, share * (1.0 - ahead), share * ahead, strict=True):
        row[j - 1] += before
        row[j] += after
    return bool(apart.max() < GAP)


def _trapezoid(knots: Array) -> Array:
    """Weights of the mean over an interval of what is straight between knots."""
    steps = np.diff(knots) / (2.0 * (knots[-1] - knots[0]))
    return np.asarray(np.concatenate([steps, [0.0]]) + np.concatenate([[0.0], steps]))


def _line(time: Array, at: float) -> Array:
    """Weights of the blocks next to an instant beyond them that put a line through them."""
    edge = time[0] if at < time[0] else time[-1]
    near = np.abs(time - edge) <= NEAR
    if near.sum() < LEAST_BLOCKS:
        near = np.argsort(np.abs(time - edge), kind="stable")[:LEAST_BLOCKS]
    chosen = time[near] - time[near].mean()
    row = np.zeros(time.size)
    row[near] = 1.0 / chosen.size + chosen * (at - time[near].mean()) / float(chosen @ chosen)
    return row


def columns(covariances: Sequence[Array]) -> list[Array]:
    """Slopes (numbers of a group, all columns) [SI] of groups of numbers, each with its covariance (numbers, numbers)
    [SI squared], with independent N(0, 1) numbers of their own."""
    factors = []
    for covariance in covariances:
        # in units of the deviations: constants differ by twenty orders of magnitude
        unit = np.sqrt(covariance.diagonal())
        unit = np.where(unit > 0.0, unit, 1.0)
        values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
        seen = values > 1e-12
        factors.append(unit[:, None] * vectors[:, seen] * np.sqrt(values[seen]))
    whole = block_diag(*factors) if factors else np.zeros((0, 0))
    ends = np.cumsum([f.shape[0] for f in factors])
    return np.split(whole, ends[:-1]) if factors else []


@dataclass(frozen=True)
class Windows:
    """Test functions: middles (functions,) [s after the opening], weights (functions, cells) of cell means (``mean``
    [-]) and of what is stored, whose slope it gives (``slope`` [1/s])."""

    time: Array
    mean: Array
    slope: Array

    def of(self, rate: LinearHistory | None, stored: LinearHistory | None) -> LinearHistory:
        """Mean (functions,) of a rate [unit/s] and of the slope of what is stored [unit], the derivative moved onto the
        test function."""
        parts = [h.weighted(w) for h, w in ((rate, self.mean), (stored, self.slope)) if h is not None]
        return parts[0] if len(parts) == 1 else parts[0] + parts[1]


def windows(cells: Cells, part: slice, covered: Mask, length: float) -> Windows:
    """Test functions (1 - s^2)^3 of a ``length`` [s], half of it apart, that stay inside a phase and out of gaps.
    Integrating by parts against them takes no derivative of noisy data."""
    width, count = float(cells.width[part][0]), part.stop - part.start
    reach = max(round(0.5 * length / width) - 1, FEWEST)
    s = np.arange(-reach, reach + 1) / (reach + 1.0)
    bump, steep = (1.0 - s**2) ** 3, s * (1.0 - s**2) ** 2
    offset = s * (reach + 1.0) * width
    bump, steep = bump / bump.sum(), steep / float(steep @ offset)
    middles, i, clear = [], reach, covered[part]
    while i < count - reach:
        free = bool(clear[i - reach : i + reach + 1].all())
        if free:
            middles.append(i)
        i += reach + 1 if free else 1
    mean, slope = np.zeros((len(middles), count)), np.zeros((len(middles), count))
    for k, middle in enumerate(middles):
        mean[k, middle - reach : middle + reach + 1] = bump
        slope[k, middle - reach : middle + reach + 1] = steep
    return Windows(cells.time[part][middles], mean, slope)


@dataclass(frozen=True)
class Piece:
    """An equation in one phase: its cells, the mean of a rate, what is stored, and a factor that gives the unit."""

    part: slice
    rate: LinearHistory | None
    stored: LinearHistory | None = None
    scale: Array | None = None


def by_phase(cells: Cells, rate: LinearHistory, stored: LinearHistory | None = None) -> list[Piece]:
    """An equation over all cells, phase by phase: ``rate`` (cells,) [unit/s] and what is ``stored`` (cells,) [unit]."""
    return [Piece(part, rate[part], None if stored is None else stored[part]) for part in cells.phases]
