"""What a column does over the log, as a word: rises with the firing, falls like a tank, steps, nothing but noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array

FINE, COARSE = 8, 3
"""[samples] in a stretch over which a median is taken, of long logs and of those with fewer than :data:`BINS` of them.
Evidence: medians of three normal deviates differ by less than four standard deviations among four hundred."""
BINS, MOST_BINS = 400, 2000
"""Such stretches in a log: of short ones, and at most. Evidence: a burn of 5 s in a log of an hour has two of 2000."""
ENDS = 0.05
"""Share of a log at either end that says where a column begins and ends. Evidence: test_survey.py, shapes."""
FEW = 8
"""Different readings up to which a column is a state, not a measurement. Evidence: relays and sequencers of published
logs have two to seven, the coarsest cell (whole pounds) thirty."""
FEW_AMONG = 50
"""[samples] from which on so few readings are a sign of a state; a short log has few of everything."""
IN_NOISE = 4.0
"""Standard deviations of a single sample that a column has to move to do anything. Source: 1 in 16,000 of a normal
distribution is beyond."""
RISING = 0.98
"""Share of steps that go up in a clock. Evidence: clocks of real loggers repeat or step back in up to 2 %."""
NEAR, FAR = 0.3, 0.6
"""Of the range of a column: within the first of an end it rests there, beyond the second it is away from it. Evidence:
chambers and cells of real stands come back to within a quarter of their range."""

WORDS = {
    "empty": "no numbers",
    "constant": "never changes",
    "clock": "rises all the way",
    "state": "steps between a few values",
    "noise": "nothing but noise",
    "pulse": "rises and comes back, as with a firing",
    "dip": "drops and comes back",
    "fills": "rises slowly, then falls faster: filled, then emptied",
    "falls": "falls, as a tank that empties",
    "rises": "rises and stays",
    "wanders": "changes without a plain shape",
}
"""The shapes, and what they are called."""


@dataclass(frozen=True)
class Shape:
    """What a column does: a word of :data:`WORDS`; the level it begins at and ends at, its ends without single wild
    samples, and what it holds while it is nearer to the upper one, all in the unit of the log.
    """

    word: str
    rest: float = np.nan
    end: float = np.nan
    low: float = np.nan
    high: float = np.nan
    plateau: float = np.nan

    @property
    def words(self) -> str:
        """The shape as people read it."""
        return WORDS[self.word]


def shape(values: Array) -> Shape:
    """The shape of a column's readings (n,), evenly in time or nearly so; NaN where there are none.

    >>> ramp = np.linspace(0.0, 1.0, 900)
    >>> fire = np.concatenate([0.0 * ramp, 1.0 - ramp**2 / 3.0, 0.0 * ramp, 0.0 * ramp])
    >>> wobble = 0.01 * np.sin(np.arange(3600.0) ** 1.5)
    >>> shape(fire + wobble).word, shape(ramp).word, shape(2.0 - ramp**2 + wobble[:900]).word
    ('pulse', 'clock', 'falls')
    """
    good = values[np.isfinite(values)]
    if good.size < 2:
        return Shape("empty")
    if good.min() == good.max():
        return Shape("constant", *[float(good[0])] * 4)
    if is_clock(good):
        return _bare("clock", good)
    if good.size >= FEW_AMONG and len(np.unique(good[:: max(1, good.size // 20_000)])) <= FEW:
        return _bare("state", good)
    return _moving(good)


def is_clock(good: Array) -> bool:
    """Whether readings (n,) rise nearly all the way, in steps that are much alike."""
    steps = np.diff(good)
    if good.size < 3 or np.count_nonzero(steps < 0.0) > (1.0 - RISING) * steps.size:
        return False
    up = steps[steps > 0.0]
    straight = np.ptp(good) > 0.0 and up.size * np.median(up) > 0.2 * np.ptp(good)
    return bool(straight and good[-1] > good[0] and up.size > 0.02 * steps.size)


def _bare(word: str, good: Array) -> Shape:
    return Shape(word, float(good[0]), float(good[-1]), float(good.min()), float(good.max()))


def _moving(good: Array) -> Shape:
    bins = min(MOST_BINS, max(min(BINS, good.size // COARSE), good.size // FINE, 2))
    levels = np.array([np.median(part) for part in np.array_split(good, bins)])
    low, high = (float(np.sort(levels)[at]) for at in ((1, -2) if bins > FEW else (0, -1)))
    ends = max(1, round(ENDS * levels.size))
    first, last = float(np.median(levels[:ends])), float(np.median(levels[-ends:]))
    noise = float(1.4826 * np.median(np.abs(np.diff(good, 2))) / np.sqrt(6.0)) if good.size > 2 else 0.0
    if high - low <= IN_NOISE * noise or high == low:
        return Shape("noise", first, last, low, high)
    share = np.clip((levels - low) / (high - low), 0.0, 1.0)
    plateau = float(np.median(levels[share > 0.5]))
    word = _word(share, (first - low) / (high - low), (last - low) / (high - low))
    return Shape(word, first, last, low, high, plateau)


def _word(share: Array, first: float, last: float) -> str:
    """``share`` (n,) of the range, and where it begins and ends, 0 low to 1 high."""
    if first <= NEAR and last <= FAR and max(first, last) <= 0.5:
        return "fills" if _fills(share) else "pulse"
    if first >= FAR and last <= NEAR + 0.1:
        return "falls"
    if first >= 1.0 - NEAR and last >= FAR - 0.1:
        return "dip"
    if first <= NEAR and last > FAR:
        return "rises"
    if first <= 0.5 and last <= 0.5:
        return "pulse"
    return "wanders"


def _fills(share: Array) -> bool:
    """Whether it takes longer to get from a tenth to nine tenths than back: a tank fills slower than it empties."""
    top = np.flatnonzero(share > 0.9)
    low = np.flatnonzero(share[: top[0]] < 0.1)
    back = np.flatnonzero(share[top[-1] :] < 0.1)
    up = top[0] - (low[-1] if low.size else 0)
    down = back[0] if back.size else share.size - top[-1]
    return bool(up > 2 * max(1, down) or (np.count_nonzero(share > 0.2) > 0.35 * share.size and up > down))
