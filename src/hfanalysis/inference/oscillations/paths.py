"""Where a line is in a spectrum over time: a path of cells that stand out of the floor by more than chance has.

Each cell has a power that is exponentially distributed about the floor where there is no line. A line is a path of
cells, window after window, whose powers are larger by one factor: its likelihood ratio against the floor is a product
over the cells. Summed over all paths and factors that are tried, each with its share of a prior, the ratio has mean one
where there is no line; so it exceeds 1 / CHANCE in less than CHANCE of all smooth stretches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.oscillations.spectrum import Spectrum

CHANCE = 3e-4
"""Probability [-] of a line in a stretch of a channel that has none. Source: with four channels and two stretches, one
smooth test in four hundred."""

FACTORS = (2.0, 4.0, 8.0, 16.0, 64.0, 256.0)
"""Power over the floor that are tried [-]."""

MOVES = ((-1, 0.05), (0, 0.9), (1, 0.05))
"""Frequencies by which a line moves from a window to the next, and with which probability."""

EDGE = 2
"""Frequencies at the lower end of a spectrum where no line begins: one below it leaks there. Source: the main lobe of
a Hann window."""

OFF_BIN = 0.72
"""Part of a line's power that its cell has where it lies between two frequencies. Source: the Hann window's loss at
half a bin, 1.42 dB."""

NOISE_BANDWIDTH = 1.5
"""Of a Hann window, in frequencies. Source: its definition."""


@dataclass(frozen=True)
class Path:
    """Cells of a spectrum: one of ``columns`` in each window from the row ``first`` on.

    ``score``: logarithm of its likelihood ratio [-], less what chance has.
    """

    spectrum: Spectrum
    first: int
    columns: NDArray[np.int64]
    score: float

    @property
    def rows(self) -> NDArray[np.int64]:
        """Its windows."""
        return np.arange(self.first, self.first + self.columns.size)

    @property
    def time(self) -> Array:
        """Middles of its windows [s]."""
        return self.spectrum.time[self.rows]

    @property
    def frequency(self) -> Array:
        """Of its cells [Hz]."""
        return self.spectrum.frequency[self.columns]


def clearest(found: Sequence[Spectrum], masks: Sequence[NDArray[np.bool_]]) -> Path | None:
    """The path that stands out most of all spectra of a stretch, where ``masks`` allow it; None where none does."""
    paths = (_best(s, mask, len(found)) for s, mask in zip(found, masks, strict=True))
    return max((path for path in paths if path.score > 0.0), key=lambda path: path.score, default=None)


def detectable(found: Sequence[Spectrum], frequency: float) -> float:
    """Rms [SI] from which a line at a frequency [Hz] is found in one of the spectra, where it lasts as long as they do;
    infinite where none of them reaches it.
    """
    inside = (s for s in found if s.frequency[EDGE] <= frequency <= s.frequency[-1])
    return min((_detectable(s, len(found), frequency) for s in inside), default=np.inf)


def _detectable(s: Spectrum, spectra: int, frequency: float) -> float:
    rows, needed = s.time.size, _threshold(s, spectra)
    factor = np.geomspace(1.01, 1e6, 2000)
    least = float(factor[np.argmax(rows * (factor - 1.0 - np.log(factor)) > needed)])
    floor = float(np.interp(frequency, s.frequency, s.floor))
    return float(np.sqrt(least / OFF_BIN * NOISE_BANDWIDTH * s.spacing * floor))


def _threshold(s: Spectrum, spectra: int) -> float:
    """Logarithm of the likelihood ratio [-] that a path has to reach, of all that are tried in so many spectra."""
    rows, columns = s.power.shape
    return float(np.log(rows * columns * rows * len(FACTORS) * spectra / CHANCE))


def _best(s: Spectrum, mask: NDArray[np.bool_], spectra: int) -> Path:
    mask = mask.copy()
    mask[:, :EDGE] = False
    paths = (_along(s, mask, factor, _threshold(s, spectra)) for factor in FACTORS)
    return max(paths, key=lambda path: path.score)


def _along(s: Spectrum, mask: NDArray[np.bool_], factor: float, needed: float) -> Path:
    """The path of the largest likelihood ratio for one factor, from and to any window."""
    gain = np.where(mask, s.ratio * (1.0 - 1.0 / factor) - np.log(factor), -np.inf)
    score, came = gain.copy(), np.full(gain.shape, len(MOVES))
    for row in range(1, gain.shape[0]):
        earlier = _moved(score[row - 1])
        best = np.argmax(earlier, axis=0)
        largest = np.take_along_axis(earlier, best[None], axis=0)[0]
        goes_on = largest > 0.0
        score[row] += np.where(goes_on, largest, 0.0)
        came[row] = np.where(goes_on, best, len(MOVES))
    row, column = (int(i) for i in np.unravel_index(int(np.argmax(score)), score.shape))
    total, columns = float(score[row, column]), [column]
    while came[row, column] < len(MOVES):
        column -= MOVES[came[row, column]][0]
        row -= 1
        columns.append(column)
    return Path(s, row, np.array(columns[::-1], dtype=np.int64), total - needed)


def _moved(score: Array) -> Array:
    """By each of MOVES to every frequency (moves, frequencies): the score of the window before, and of the move."""
    out = np.full((len(MOVES), score.size), -np.inf)
    for i, (move, chance) in enumerate(MOVES):
        to = slice(max(move, 0), score.size + min(move, 0))
        of = slice(max(-move, 0), score.size - max(move, 0))
        out[i, to] = score[of] + np.log(chance)
    return out
