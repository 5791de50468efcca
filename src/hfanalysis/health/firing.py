"""What the firing says coarsely, channel by channel on one clock: means, loads, who is above whom.

Levels are counted from a channel's own rest where that is known: a zero that is off is another finding's matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.shape import Mask
from hfanalysis.record.quiet import Trace, in_blocks

STEP = 0.02
"""[s] between the instants at which channels are compared, at least."""
OPEN_TO_AIR = ("p_chamber", "p_run")
"""Pressures that rest at ambient where they are open to the air: their rise is believed before their zero."""
EMPTY_LINE = 4e5
"""[Pa] above which a run line at rest is not open to the air: it holds oxidizer behind its valve."""
HALF = 0.5
"""Part of its usual highest level above which chamber or thrust count as burning [-]. Source: definition."""


def usable(test: SeenTest, seen: Seen) -> Trace:
    """The good samples of a channel outside of what it showed to be unusable: time [s], values [SI] as said."""
    return without_unusable(test, seen, seen.trace)


def without_unusable(test: SeenTest, seen: Seen, trace: Trace) -> Trace:
    """A ``trace`` of a channel outside of what it showed to be unusable."""
    kept = np.ones(len(trace.time), dtype=bool)
    for finding in test.found:
        if finding.verdict == "unusable" and seen.name in finding.channels and not finding.whole:
            low, high = finding.span
            kept &= (trace.time < low) | (trace.time > high)
    return Trace(trace.time[kept], trace.values[kept])


def own_zero(seen: Seen) -> float:
    """What to take off a channel [SI]: rest of a cell, of an open pressure what it differs from ambient at rest."""
    rest = seen.coarse.rest
    if rest is None:
        return 0.0
    if seen.dimension == "force":
        return rest.value
    if seen.name in OPEN_TO_AIR and rest.value < EMPTY_LINE:
        return rest.value - seen.ambient
    return 0.0


@dataclass(frozen=True)
class Burn:
    """The firing on one clock: ``time`` (n,) [s, log time], channels (n,) [SI] from their own zero."""

    time: Array
    values: dict[str, Array]
    burning: Mask

    def mean(self, name: str) -> float:
        """Mean of a channel over what burns [SI]."""
        return float(np.mean(self.values[name][self.burning]))

    def integral(self, name: str) -> float:
        """Integral of a channel over the firing [SI s]."""
        return float(np.trapezoid(self.values[name], self.time))

    @property
    def seconds(self) -> float:
        """How long it burns [s]."""
        return float(np.sum(np.gradient(self.time)[self.burning])) if len(self.time) > 2 else 0.0


def burn_of(test: SeenTest, *names: str) -> Burn | None:
    """The channels named, which all have to be there, over the firing; None where one is not or nothing fires."""
    channels = [test.get(name) for name in names]
    if test.fire is None or any(c is None for c in channels):
        return None
    traces = [in_blocks(usable(test, c), STEP) for c in channels if c is not None]
    start = max(test.fire[0], *(t.time[0] if len(t.time) else np.inf for t in traces))
    end = min(test.fire[1], *(t.time[-1] if len(t.time) else -np.inf for t in traces))
    clock = max(traces, key=lambda t: float(np.median(np.diff(t.time))) if len(t.time) > 1 else np.inf).time
    time = clock[(clock >= start) & (clock <= end)]
    if len(time) < 8:
        return None
    values = {
        c.name: np.interp(time, t.time, t.values) - own_zero(c) for c, t in zip(channels, traces, strict=True) if c
    }
    lead = values[names[0]]
    floor = test.ambient if names[0].startswith("p_") else 0.0
    burning = lead - floor > HALF * (float(np.percentile(lead, 95.0)) - floor)
    return Burn(time, values, burning) if np.count_nonzero(burning) >= 4 else None
