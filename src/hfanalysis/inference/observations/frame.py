"""When a test is compared: the grid of its blocks, the changes of phase, and where each channel's comparison ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.flow_end import AROUND_END, flow_end_without_fuel, noted_flow_end
from hfanalysis.inference.observations.recorded import LONGEST_RECORD, log_end, log_start
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal

BLOCK = 0.02
"""Seconds over which samples are averaged near the opening and the changes of phase."""

AROUND_CHANGE = 0.04
"""Seconds on either side of a phase change (beside its own deviation) without blocks: knees are rounded."""

FIRST = 0.03
"""Seconds after the opening before which nothing is compared: the chamber fills, the igniter is not modeled."""

TANK_SIDE = ("p_tank", "p_run", "m_tank", "p_purge")
"""Channels that go on telling when the chamber's pressure is gone."""

EVENT_STD = 0.005
"""Least standard deviation of the instant of a phase change [s]. It is found better than that, but that a model's
liquid ends as sharply is not known. Evidence: with 2 ms a practice case without an effect, from another generator,
asked for heat in the tank."""

FUEL_STD = 0.05
"""Least standard deviation [s] of the end of the fuel, which fades rather than stops."""

SETTLING, SHORTEST_REST, LONGEST_REST = 0.5, 0.4, 10.0
"""Seconds after the end of the flow before the chamber is at rest, and how long a rest that is looked at may be."""

REST_BLOCKS = 4
"""Blocks that such a rest is cut into."""

SETTLED, LATER = 2.0, 0.1
"""Standard deviations by which the first of these blocks may differ from the rest, and by how much later [s] it is
begun where it does. Source: by chance one rest in twenty begins later than it might, and loses little by it."""

BEFORE_BLOCKS, BEFORE_BLOCK, BEFORE_END = 8, 0.5, 0.1
"""The rest before the opening: at most so many blocks of such a length [s], the last of which ends so long before it
[s]."""

LEAST_BEFORE = 0.1
"""Seconds of a shorter block where a log begins shortly before the opening; a still shorter rest tells nothing."""


@dataclass(frozen=True)
class Frame:
    """The common grid, the changes of phase (instant, deviation), and from when to when is compared [s].

    The grid has ``before`` wide blocks of the rest before the opening, the opening itself, points while something
    flows, and wide blocks of the rest after it; ``width`` [s] of the wide ones, 0 of points. ``filled``: the feed line
    is; ``ends`` of "chamber" (and thrust) and "tank", and of "p_run" where it is another one: its pressure goes by
    that of a chamber that no model knows without a flame; ``fuel_out``: the end of the fuel where the tank is compared
    beyond it; ``hidden``: seconds before the end of the liquid without blocks; ``opening``: the deviation of
    the opening's instant.
    """

    grid: Array
    resting: NDArray[np.bool_]
    width: Array
    before: int
    changes: Mapping[str, tuple[float, float]]
    start: float
    filled: float
    ends: Mapping[str, float]
    fuel_out: float | None = None
    hidden: float = 0.0
    opening: float = 0.0

    def end(self, channel: str) -> float:
        """Where the comparison of a channel ends [s]."""
        return self.ends[channel if channel in self.ends else "tank" if channel in TANK_SIDE else "chamber"]

    @property
    def steady(self) -> float:
        """How long from the opening on no phase changes [s]."""
        return min([self.ends["chamber"], *(instant for instant, _ in self.changes.values())]) - AROUND_CHANGE

    @property
    def flowing(self) -> slice:
        """The points of the grid while something flows."""
        return slice(self.before + 1, self.before + 1 + int((~self.resting).sum()))

    @property
    def after(self) -> slice:
        """The blocks of the rest after the flow."""
        return slice(self.flowing.stop, self.grid.size)


def frame_of(
    log: TestLog, segments: Segments, definition: TestDefinition, origin: float, shown: float | None = None
) -> Frame:
    """The frame of a test that opens at ``origin`` [s of the log].

    ``shown`` [s after the opening]: until when a flame is shown, where nothing tells whether it burns on. No model
    knows the chamber's pressure from then on, nor what flows into it; as where a fire is seen to fade.
    """
    last = log_end(log, origin) if shown is None else min(log_end(log, origin), shown - AROUND_CHANGE)
    end = min(_end(segments), last)
    ends = {"chamber": end, "tank": min(_tank_end(segments, definition, end), last)}
    fuel_out = segments.time("t_fuel_gone")
    flow_end = flow_end_without_fuel(log, segments, definition, origin)
    if flow_end is None:
        fuel_out = None
    else:
        ends["tank"] = min(flow_end - AROUND_END, LONGEST_RECORD)
        ends["p_run"] = end
    changes = {
        name: (value, segments.std(name))
        for name in ("t_v", "t_fuel_gone")
        if (value := segments.time(name)) is not None
    }
    over = noted_flow_end(definition, max(segments.time("t_end") or end, end))
    rest = _rest(log, origin, over if flow_end is None else max(over, flow_end))
    before, burning = _before(log, origin), np.arange(0.5 * BLOCK, ends["tank"], BLOCK)
    after = _blocks(*rest, REST_BLOCKS) if rest is not None else np.zeros((2, 0))
    opening, points = np.zeros((2, 1)), np.stack([burning, np.zeros(burning.size)])
    grid, width = np.concatenate([before, opening, points, after], axis=1)
    resting = np.ones(grid.size, dtype=bool)
    resting[before.shape[1] + 1 : grid.size - after.shape[1]] = False
    filled, opened = segments.time("t_feed") or 0.0, segments.t_open.std or 0.0
    return Frame(grid, resting, width, before.shape[1], changes, FIRST, filled, ends, fuel_out, opening=opened)


def _blocks(first: float, last: float, count: int) -> Array:
    """Middles and widths (2, count) of the blocks that a stretch [s] is cut into."""
    width = (last - first) / count
    return np.stack([first + width * (np.arange(count) + 0.5), np.full(count, width)])


def _before(log: TestLog, origin: float) -> Array:
    """Middles and widths (2, blocks) of the blocks of the rest before the opening."""
    rest = -log_start(log, origin) - BEFORE_END
    if rest < LEAST_BEFORE:
        return np.zeros((2, 0))
    count = min(max(int(rest / BEFORE_BLOCK), 1), BEFORE_BLOCKS)
    return _blocks(-BEFORE_END - min(rest, count * BEFORE_BLOCK), -BEFORE_END, count)


def _rest(log: TestLog, origin: float, over: float) -> tuple[float, float] | None:
    """A stretch after the flow [s] in which the chamber is at rest; None where the log does not show one.

    The pressure is below 1.8 times ambient long before the last gas has left, so that it has to stand still as well.
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
    noise = Noise.of(signal, signal.between(-LONGEST_RECORD, -0.1))

    def alike(one: tuple[float, float], two: tuple[float, float], most: float) -> bool:
        return abs(signal.mean(*one) - signal.mean(*two)) <= most * noise.difference_std(one, two)

    half = 0.5 * (first + last)
    if not alike((first, half), (half, last), 3.0):
        return None
    # halves of seconds hide what still falls in the first tenths of one
    while last - first >= SHORTEST_REST:
        second = first + (last - first) / REST_BLOCKS
        if alike((first, second), (second, last), SETTLED):
            return first, last
        first += LATER
    return None


def _tank_end(segments: Segments, definition: TestDefinition, end: float) -> float:
    """The tank goes on emptying after the chamber's pressure is gone, until the end of the flow that was seen."""
    if segments.time("t_fuel_gone") is not None:
        return end
    return min(max(noted_flow_end(definition, end) - AROUND_END, end), LONGEST_RECORD)


def _end(segments: Segments) -> float:
    """Where the comparison ends [s]: with the fuel, for what follows is another story, or where the flow ends."""
    fuel = "t_fuel_out" if segments.time("t_fuel_gone") is None else "t_fuel_gone"
    known = [(segments.time(name), segments.std(name)) for name in (fuel, "t_end")]
    # where the fuel fades, its fading is to be seen: no wide berth for a wide deviation
    given = [t - AROUND_CHANGE - min(2.0 * deviation, AROUND_CHANGE) for t, deviation in known if t is not None]
    return min([*given, LONGEST_RECORD])


def events_of(segments: Segments, end: float) -> dict[str, tuple[float, float]]:
    """The instants of the changes of phase that are observations [s after the opening], with their standard deviations
    [s].

    ``end`` [s]: where the comparison of the tank ends.
    """
    t_v = segments.time("t_v")
    events = {}
    if t_v is not None and t_v < end - AROUND_CHANGE:
        events["t_v"] = (t_v, max(segments.std("t_v"), EVENT_STD))
    gone = segments.time("t_fuel_gone")
    if gone is not None and gone < LONGEST_RECORD:
        events["t_fuel_out"] = (gone, max(segments.std("t_fuel_gone"), FUEL_STD))
    return events


def phases_of(segments: Segments, end: float) -> dict[str, float]:
    """Where each phase begins [s after the opening], one after the other, up to ``end`` [s].

    Nitrogen that could enter before the liquid is gone makes no phase of its own up to there.
    """
    found = {"filling": 0.0, "liquid": segments.time("t_feed") or 0.0}
    t_v, t_purge = segments.time("t_v"), segments.time("t_purge")
    if t_v is not None:
        found["vapor"] = t_v
    if t_purge is not None:
        found["nitrogen"] = max(t_purge, t_v if t_v is not None else t_purge)
    return {**found, "end": end}
