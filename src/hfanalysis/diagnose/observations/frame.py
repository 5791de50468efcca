"""When a test is compared: the grid of its blocks, the changes of phase, and where each channel's comparison ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.observations.flow_end import AROUND_END, flow_end_without_fuel, noted_flow_end
from hfanalysis.diagnose.observations.recorded import LONGEST, log_end
from hfanalysis.segment.noise import Noise
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog

Array = NDArray[np.float64]

BLOCK = 0.02
"""Seconds over which samples are averaged near the opening and the changes of phase."""

AROUND_CHANGE = 0.04
"""Seconds on either side of a phase change (beside its own deviation) without blocks: knees are rounded."""

FIRST = 0.03
"""Seconds after the opening before which nothing is compared: the chamber fills, the igniter is not modelled."""

TANK_SIDE = ("p_tank", "p_run", "m_tank")
"""Channels that go on telling when the nozzle has unchoked."""

EVENT_STD = 0.005
"""Least standard deviation [s] of the instant of a phase change."""

FUEL_STD = 0.05
"""Least standard deviation [s] of the end of the fuel, which fades rather than stops."""

SETTLING, SHORTEST_REST, LONGEST_REST = 0.5, 0.4, 10.0
"""Seconds after the end of the flow before the chamber is at rest, and how long a rest that is looked at may be."""

REST_BLOCKS = 4
"""Blocks that such a rest is cut into."""


@dataclass(frozen=True)
class Frame:
    """The common grid, the changes of phase (instant, deviation), and from when to when is compared [s].

    ``filled``: the feed line is; ``ends`` of "chamber" (and thrust) and "tank"; ``fuel_out``: the end of the fuel where
    the tank is compared beyond it; ``failing``: seconds before the end of the liquid in which the flow fails.
    """

    grid: Array
    resting: NDArray[np.bool_]
    changes: Mapping[str, tuple[float, float]]
    start: float
    filled: float
    ends: Mapping[str, float]
    fuel_out: float | None = None
    failing: float = 0.0

    def end(self, channel: str) -> float:
        """Where the comparison of a channel ends [s]."""
        return self.ends["tank" if channel in TANK_SIDE else "chamber"]


def frame_of(
    log: TestLog, segments: Segments, definition: TestDefinition, origin: float, failing: float = 0.0
) -> Frame:
    """The frame of a test that opens at ``origin`` [s of the log], whose flow fails so many seconds before its end."""
    last = log_end(log, origin)
    end = min(_end(segments), last)
    ends = {"chamber": end, "tank": min(_tank_end(segments, definition, end), last)}
    fuel_out = segments.time("t_fuel_out")
    flow_end = flow_end_without_fuel(log, segments, definition, origin)
    if flow_end is None:
        fuel_out = None
    else:
        ends["tank"] = min(flow_end - AROUND_END, LONGEST)
    changes = {
        name: (value, segments.std(name))
        for name in ("t_v", "t_fuel_out")
        if (value := segments.time(name)) is not None
    }
    over = noted_flow_end(definition, max(segments.time("t_end") or end, end))
    rest = _rest(log, origin, over if flow_end is None else max(over, flow_end))
    burning = np.arange(0.5 * BLOCK, ends["tank"], BLOCK)
    after: Array = np.zeros(0)
    if rest is not None:
        width = (rest[1] - rest[0]) / REST_BLOCKS
        after = np.asarray(rest[0] + width * (np.arange(REST_BLOCKS) + 0.5), dtype=np.float64)
    grid = np.concatenate([[0.0], burning, after])
    resting = np.ones(grid.size, dtype=bool)
    resting[1 : 1 + burning.size] = False
    filled = segments.time("t_feed") or 0.0
    return Frame(grid, resting, changes, FIRST, filled, ends, fuel_out, failing)


def _rest(log: TestLog, origin: float, over: float) -> tuple[float, float] | None:
    """A stretch after the flow [s] in which the chamber is at rest; None where the log does not show one.

    The nozzle unchokes long before the last gas has left, so that the chamber's pressure has to stand still as well.
    """
    if "p_chamber" not in log:
        return None
    signal = Signal.of(log["p_chamber"]).shifted(origin)
    if signal.dead:
        return None
    last = float(signal.time[-1])
    first = max(over + SETTLING, last - LONGEST_REST)
    if last - first < SHORTEST_REST:
        return None
    half = 0.5 * (first + last)
    noise = Noise.of(signal, signal.between(-LONGEST, -0.1))
    fall = signal.mean(first, half) - signal.mean(half, last)
    if not abs(fall) <= 3.0 * noise.difference_std((first, half), (half, last)):
        return None
    return first, last


def _tank_end(segments: Segments, definition: TestDefinition, end: float) -> float:
    """The tank goes on emptying after the nozzle has unchoked, until the end of the flow that was seen at the stand."""
    if segments.time("t_fuel_out") is not None:
        return end
    return min(max(noted_flow_end(definition, end) - AROUND_END, end), LONGEST)


def _end(segments: Segments) -> float:
    """Where the comparison ends [s]: with the fuel, for what follows is another story, or where the flow ends."""
    known = [(segments.time(name), segments.std(name)) for name in ("t_fuel_out", "t_end")]
    # where the fuel fades, its fading is to be seen: no wide berth for a wide deviation
    given = [t - AROUND_CHANGE - min(2.0 * deviation, AROUND_CHANGE) for t, deviation in known if t is not None]
    return min([*given, LONGEST])


def events_of(segments: Segments, end: float) -> dict[str, tuple[float, float]]:
    """The instants [s] of the changes of phase that are observations, with their standard deviations.

    ``end``: where the comparison of the tank ends.
    """
    t_v = segments.time("t_v")
    events = {}
    if t_v is not None and t_v < end - AROUND_CHANGE:
        events["t_v"] = (t_v, max(segments.std("t_v"), EVENT_STD))
    gone = segments.time("t_fuel_out")
    if gone is not None and gone < LONGEST:
        events["t_fuel_out"] = (gone, max(segments.std("t_fuel_out"), FUEL_STD))
    return events


def phases_of(segments: Segments, end: float) -> dict[str, float]:
    """Where each phase begins [s]."""
    found = {"filling": 0.0, "liquid": segments.time("t_feed") or 0.0}
    t_v, t_purge = segments.time("t_v"), segments.time("t_purge")
    if t_v is not None:
        found["vapor"] = t_v
    if t_purge is not None:
        found["nitrogen"] = t_purge
    return {**found, "end": end}
