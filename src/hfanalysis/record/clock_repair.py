"""Clocks that do not run: counters that wrap, loggers that restart, rows out of order, clocks that are set back.

Only what the stamps themselves show is put right, and it is said. A lone stamp that is off is left for its flag.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array

TURNS = {
    2.0**16: "a counter of 16 bits",
    2.0**32: "a counter of 32 bits",
    2.0**32 / 1e3: "a counter of 32 bits in thousandths",
    60.0: "seconds of the minute",
    3600.0: "seconds of the hour",
    86400.0: "seconds of the day",
    60e3: "milliseconds of the minute",
    3600e3: "milliseconds of the hour",
    86400e3: "milliseconds of the day",
    60e6: "microseconds of the minute",
}
"""After how much [unit of the stamps] a clock begins anew, and what then does. Source: two's complement; the minute,
the hour and the day."""
SMOOTH = 20.0
"""Usual steps that the step over a wrap may last. Evidence: test_clock_repair.py: jitter of a logger; a restart lands
anywhere."""
LASTING = 4
"""Samples after a step back that run on from it for it to be more than a stamp gone astray. Evidence: as many as
flags.py calls no spike any more."""
BACKWARDS = "the rows run backwards; taken in reverse"
FARTHEST = 0.02
"""Share of the rows by which a row may be out of place. Evidence: as FAR_ROWS."""
FAR_ROWS = 50
"""Rows by which a row may be out of place in a short log, too. Evidence: test_clock_repair.py: datagrams and buffers
come a few places late; what is farther off is another part of the log."""


@dataclass(frozen=True)
class Repaired:
    """Stamps (n,) put right, in the unit of the log; ``order`` (n,): the rows in their order in time, None where they
    are in it; ``notes``: what was done.
    """

    time: Array
    order: NDArray[np.intp] | None = None
    notes: tuple[str, ...] = ()


def repaired(stamps: Array, turns: bool = True) -> Repaired:
    """Stamps (n,) that run, as far as they show how; in the unit of the log. ``turns``: they are numbers, no dates."""
    steps = np.diff(stamps)
    if len(stamps) < 2 * LASTING or not (steps < 0.0).any():
        return Repaired(stamps)
    if np.count_nonzero(steps < 0.0) > 0.9 * np.count_nonzero(steps):
        return Repaired(stamps[::-1].copy(), np.arange(len(stamps))[::-1], (BACKWARDS,))
    if turns and (unwrapped := _unwrapped(stamps, steps)) is not None:
        return unwrapped
    return _sorted(stamps, steps) or _joined(stamps)


def _usual(steps: Array) -> float:
    """The usual step forward."""
    forward = steps[steps > 0.0]
    return float(np.median(forward)) if len(forward) else 0.0


def _unwrapped(stamps: Array, steps: Array) -> Repaired | None:
    """The stamps where a clock that begins anew explains every large step back, None elsewhere."""
    usual, back = _usual(steps), np.flatnonzero(steps < 0.0)
    for turn, words in TURNS.items():
        wraps = back[steps[back] < -0.5 * turn]
        over = steps[wraps] + turn
        if len(wraps) and np.ptp(stamps) <= turn and _is_smooth(over, usual):
            turned = stamps.copy()
            turned[1:] += turn * np.cumsum(np.isin(np.arange(len(steps)), wraps))
            return Repaired(turned, None, (f"the clock begins anew after {turn:.10g} ({words}); counted on",))
    return None


def _is_smooth(over: Array, usual: float) -> bool:
    return bool(((over > 0.0) & (over <= SMOOTH * usual)).all())


def _sorted(stamps: Array, steps: Array) -> Repaired | None:
    """The rows in order where they only came in another: then each step is a usual one and no stamp is met twice."""
    order = np.argsort(stamps, kind="stable")
    far = np.abs(order - np.arange(len(order))).max()
    if far > max(FAR_ROWS, FARTHEST * len(stamps)) or not _fits_in(order, np.diff(stamps[order])):
        return None
    words = f"{int(np.count_nonzero(steps < 0.0))} steps back: rows out of order, sorted by their time"
    return Repaired(stamps[order], order, (words,))


def _fits_in(order: NDArray[np.intp], steps: Array) -> bool:
    """Whether rows that sorting has moved lie as evenly as the others: a stamp gone astray, or a clock set back, leaves
    a hole where it belongs and comes between others where it does not.
    """
    moved = order != np.arange(len(order))
    beside = moved[1:] | moved[:-1]
    usual = float(np.median(steps))
    uneven = np.abs(steps - usual) >= 0.5 * usual
    expected = float(np.mean(uneven[~beside])) * beside.sum() if not beside.all() else 0.0
    return bool(usual > 0.0 and uneven[beside].sum() <= expected + 2.0 * np.sqrt(expected))


def _joined(stamps: Array) -> Repaired:
    """The stamps with every lasting step back made a usual step: a restart, or a clock set back."""
    time, notes = stamps.copy(), []
    usual = _usual(np.diff(stamps))
    for at in map(int, np.flatnonzero(np.diff(stamps) < 0.0)):
        shown = stamps[at + 1 :]
        runs_on = len(shown) >= LASTING and bool((np.diff(shown[:LASTING]) >= 0.0).all())
        over = int(np.argmax(shown > stamps[at])) if (shown > stamps[at]).any() else len(shown)
        ahead = _run_above(stamps[: at + 1], shown[0])
        if not runs_on or min(over, ahead) < LASTING or _returns(shown[: over + 1], stamps[at], usual):
            continue
        shift = time[at] + usual - time[at + 1]
        time[at + 1 :] += shift
        notes.append(_restart(stamps[at], stamps[at + 1], at))
    return Repaired(time, None, tuple(notes))


def _run_above(stamps: Array, level: float) -> int:
    """How many of the last stamps are all above a level."""
    below = np.flatnonzero(stamps <= level)
    return len(stamps) - (int(below[-1]) + 1 if len(below) else 0)


def _returns(shown: Array, before: float, usual: float) -> bool:
    """Whether the clock jumps forward again to where it would be had it not stepped back."""
    if len(shown) < 2 or shown[-1] <= before:
        return False
    expected = before + usual * len(shown)
    jump = shown[-1] - shown[-2]
    return bool(jump > SMOOTH * usual and abs(shown[-1] - expected) < 0.5 * jump)


def _restart(before: float, after: float, row: int) -> str:
    return (
        f"after row {row + 1} the clock goes from {before:.10g} to {after:.10g}: it restarts or is set back; what "
        "follows is put one usual step later, so times across this row are right only if the logger did not pause"
    )
