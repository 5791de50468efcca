"""Clocks of several files brought onto one: by the dates that they state, or by what their channels show together."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.clocks import Clock

FINEST, MOST = 1e-3, 1 << 18
"""Step [s] and number of samples of the finest common grid. Evidence: valves take 10 ms and more; the transform of as
many samples takes 0.1 s."""
LIKE = 0.5
"""Correlation that the best offset has at least. Evidence: test_alignment.py: noise alone reaches a third of it."""
NEXT = 0.8
"""Share of it that the best offset elsewhere may have. Evidence: test_alignment.py: two openings of one valve tie."""
APART = 2.0
"""[s] by which another offset is elsewhere. Evidence: test_alignment.py: an opening's own ringing is nearer."""
NEARLY_BEST = 0.9
"""Share of the best correlation down to which an offset may be meant: half the width there is the deviation.
Evidence: test_alignment.py: true offsets lie within two of these."""
ELSEWHERE = 5.0
"""Standard deviations from which a clock is not where the channels put it. Evidence: test_alignment.py: files of one
clock stay within them."""
SPIKE = 5
"""Samples over which a median takes out lone wild values [samples]. Evidence: flags.py: a spike has up to three."""


@dataclass(frozen=True)
class Offset:
    """What is to be added to a clock [s], its standard deviation [s], the correlation there, and the best elsewhere."""

    value: float
    std: float
    likeness: float
    elsewhere: float

    @property
    def words(self) -> str:
        """What the channels show."""
        elsewhere = f", {self.elsewhere:.2f} elsewhere" if self.elsewhere > NEXT * self.likeness else ""
        fit = f"correlation {self.likeness:.2f}{elsewhere}"
        return f"its channels fit those of the other files best {self.value:.3f} +/- {self.std:.3f} s later ({fit})"

    @property
    def told(self) -> bool:
        """Whether the channels tell it."""
        return self.likeness >= LIKE and self.elsewhere <= NEXT * self.likeness


def on_one_zero(
    clocks: Mapping[Hashable, Clock], files: Mapping[Hashable, str]
) -> tuple[dict[Hashable, Clock], list[str]]:
    """Clocks whose zeros have dates counted from the earliest of these; and what there is to say."""
    epochs = [clock.epoch for clock in clocks.values() if clock.epoch is not None]
    first = min(epochs, default=0.0)
    moved, notes = dict(clocks), dict[str, None]()
    for key, clock in clocks.items():
        later = (clock.epoch or first) - first
        if later:
            moved[key] = replace(clock, time=clock.time + later)
            notes[f"{files[key]}: its zero is {later:.10g} s after that of the others, by the dates in the log"] = None
    return moved, list(notes)


def find_offset(reference: Sequence[tuple[Array, Array]], other: Sequence[tuple[Array, Array]]) -> Offset | None:
    """The offset [s] that brings ``other`` onto ``reference``; each channels of time [s] and reading, both (n,).

    None where a side has no channel that changes. How fast the readings change is compared, not what they read: the
    opening of a valve shows in all of them.
    """
    from scipy.signal import correlate, correlation_lags  # here for start-up: few logs ask for it

    every = [*reference, *other]
    steps = [float(np.median(np.diff(time))) for time, _ in every if len(time) > 1]
    span = max((float(np.ptp(time)) for time, _ in every if len(time)), default=0.0)
    step = max(FINEST, span / MOST, min(steps, default=FINEST))
    one, two = _activity(reference, step), _activity(other, step)
    if one is None or two is None:
        return None
    together = correlate(one[1], two[1], method="fft")
    lags = correlation_lags(len(one[1]), len(two[1]))
    best = int(np.argmax(together))
    far = np.abs(lags - lags[best]) * step > APART
    near = np.flatnonzero(~far & (together > NEARLY_BEST * together[best]))
    return Offset(
        one[0] - two[0] + float(lags[best]) * step,
        max(0.5 * float(np.ptp(lags[near])) * step, step),
        float(together[best]),
        float(together[far].max(initial=0.0)),
    )


def _activity(channels: Sequence[tuple[Array, Array]], step: float) -> tuple[float, Array] | None:
    """When the channels begin [s], and how fast they change together on a grid of ``step`` [s]: of unit energy."""
    from scipy.ndimage import median_filter, uniform_filter1d  # as above

    times = [time[np.isfinite(values)] for time, values in channels]
    times = [time for time in times if len(time) > SPIKE]
    if not times:
        return None
    grid = np.arange(min(time[0] for time in times), max(time[-1] for time in times) + step, step)
    total = np.zeros(len(grid))
    for time, values in channels:
        good = np.isfinite(values)
        if good.sum() <= SPIKE:
            continue
        smooth = uniform_filter1d(np.interp(grid, time[good], median_filter(values[good], SPIKE)), SPIKE)
        change = np.abs(np.gradient(smooth))
        change = np.maximum(change - 4.0 * np.median(change), 0.0)
        energy = float(np.sqrt((change**2).sum()))
        total += change / energy if energy > 0.0 else 0.0
    energy = float(np.sqrt((total**2).sum()))
    return (float(grid[0]), total / energy) if energy > 0.0 else None
