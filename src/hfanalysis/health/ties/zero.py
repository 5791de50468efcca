"""Zeros that are off: at rest before the firing, or shifted by it."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np

from hfanalysis.health.firing import EMPTY_LINE, OPEN_TO_AIR, burn_of, usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import FiringSpan, Level, Trace, after, in_blocks
from hfanalysis.record.quiet import level as level_of
from hfanalysis.sentences import text

SHIFT_SHARE = {"force": 0.015, "pressure": 0.01}
"""Part of the rise in the firing from which on a shift of the zero is called so [-]: below, heat and hysteresis of a
sound sensor do it. Source: data sheets' temperature effects on zero, a few tenths of a percent per 10 K; a stand warms
by 30 K, and a cell has hysteresis besides."""
NOISES = 5.0
"""Deviations of both levels' means that a shift has to exceed [-]."""
ACCURACIES = {"force": 3.0, "pressure": 2.0}
"""Deviations of the stated accuracy that a shift has to exceed [-]; a single one of that of its class, where none is
stated: that is wide."""
TAKEN_OFF, LEFT_IN = 12.0**-0.5, 3.0**-0.5
"""Deviation of a mean over the firing for a shift of one [-], where a linear drift was taken off and where it was not.
Source: of a shift at any instant a uniform share is in the mean; its deviation from one half, and from nothing."""
AT_AMBIENT = 0.04
"""Chamber pressure above its rest over ambient below which the thrust is nothing [-]. Source: a nozzle that is not
choked gives 0.1 p_a A_t or less."""
LATE = 2.0
"""[s] at the end of the time in which a channel is flat again whose mean is its level after the firing."""
PUSHES = 2.0
"""Deviations of what still pushes that a shift has to be above it [-]."""
LOWEST = 0.5
"""[s] for which a pressure is below its rest at least."""
MOST = 0.5
"""Part of the rise above which what is left is no zero any more [-]: a channel that does not come back at all."""
AT_REST = 4.0
"""Deviations of its accuracy by which the rest itself may be off [-]."""
BACK = 0.3e5
"""[Pa] from its rest within which a line feeds nothing that keeps a chamber above ambient. Source: a chamber that is
not choked takes a small part of it."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Of the thrust cell, the chamber and the run line."""
    for name in ("thrust", *OPEN_TO_AIR):
        seen = test.get(name)
        if seen is None or test.fire is None or seen.coarse.rest is None:
            continue
        if seen.dimension == "pressure" and seen.coarse.rest.value > EMPTY_LINE:
            continue
        found = _at_rest(test, seen) or _shifted(test, seen)
        if found is not None:
            yield found


def _at_rest(test: SeenTest, seen: Seen) -> Finding | None:
    """A rest that is not zero (not ambient) and that nobody has asked to take off."""
    assert seen.coarse.rest is not None
    if seen.spec.tare != "none" or seen.channel.zero_std is not None or _told(test, seen):
        return None
    should = 0.0 if seen.dimension == "force" else seen.ambient
    off, rise = seen.coarse.rest.value - should, abs(seen.coarse.rise or 0.0)
    if abs(off) < max(AT_REST * seen.channel.accuracy, 0.01 * rise) or (should and off > should):
        return None
    cure = 'tare = "auto"' if seen.dimension == "force" else 'zero = "ambient"'
    words = "reads {rest} at rest before the firing, where it should read {should}"
    evidence = text(
        words, rest=level(seen.coarse.rest.value, seen.dimension), should=level(should, seen.dimension)
    )  # fmt: skip
    means = "its zero is off by that, and so is every reading"
    return seen.finding("zero", "suspect", evidence=evidence, means=means, cure=cure, bias=abs(off))


def _told(test: SeenTest, seen: Seen) -> bool:
    """Whether the rest is another kind's already."""
    from_gauge = [f for f in test.found if f.kind in ("gauge_or_absolute", "sign") and seen.name in f.channels]
    rest = seen.coarse.rest.value if seen.coarse.rest else 0.0
    other = seen.ambient * (2.0 if seen.spec.gauge else 0.0)
    near = seen.dimension == "pressure" and abs(rest - other) < 0.5 * abs(rest - seen.ambient)
    return bool(from_gauge) or near


def _shifted(test: SeenTest, seen: Seen) -> Finding | None:
    """The level after the firing against the one before, less what still pushes."""
    trace = usable(test, seen)
    last = _settled(test, seen, trace) or _unpushed(test, seen, trace) or _lowest(test, seen, trace)
    if last is None or seen.coarse.rest is None:
        return None
    rise = float(np.percentile(np.abs(trace.values - seen.coarse.rest.value), 99.0))
    left = _still(test, seen, last)
    if left is None:
        return None
    before = seen.coarse.rest
    error = float(np.hypot(before.noise / np.sqrt(20.0), NOISES * last.std))
    shift = last.value - before.value
    stated = (ACCURACIES[seen.dimension] if seen.channel.accuracy_stated else 1.0) * seen.channel.accuracy
    # what still pushes, pushes up: a cell below its rest is off by that and more
    own, unsure = (-shift, 0.0) if shift < 0.0 else (shift - left[0], PUSHES * left[1])
    if not max(SHIFT_SHARE[seen.dimension] * rise, error, stated, unsure) < own < MOST * rise:
        return None
    words = "reads {after} after the firing and {before} before it: {shift} of {rise} of its largest rise"
    evidence = text(
        words, after=level(last.value, seen.dimension), before=level(before.value, seen.dimension),
        shift=f"{100.0 * shift / rise:+.1f} %", rise=level(rise, seen.dimension),
    )  # fmt: skip
    means = "its zero moved while it fired, nobody knows when: readings in the firing may be off by as much"
    return seen.finding("zero", "suspect", evidence=evidence, means=means, cure=None, bias=_bias(seen, shift))


def _bias(seen: Seen, shift: float) -> float:
    """What a mean over the firing may be off by [SI] for a zero that moved at an instant that nobody knows."""
    return float(abs(shift) * (TAKEN_OFF if seen.channel.drift else LEFT_IN))


def _settled(test: SeenTest, seen: Seen, trace: Trace) -> Level | None:
    """The level at the end of the time in which the channel is flat again, as late as can be: what flows on fades."""
    assert test.fire is not None
    live = seen.coarse.live
    end = min(test.fire[1], live[1]) if live is not None and seen.dimension == "force" else test.fire[1]
    window = after(trace, FiringSpan(test.fire[0], end, "")) if len(trace.time) else None
    return level_of(window.between(window.time[-1] - LATE, np.inf)) if window is not None else None


def _unpushed(test: SeenTest, seen: Seen, trace: Trace) -> Level | None:
    """The level of a cell that has not settled, from when on the chamber stays at ambient: nothing pushes it then."""
    chamber = test.get("p_chamber")
    if seen.dimension != "force" or chamber is None or chamber.coarse.rest is None or test.fire is None:
        return None
    blocks = in_blocks(usable(test, chamber).between(test.fire[0], np.inf), LOWEST)
    under = np.flatnonzero(blocks.values - chamber.coarse.rest.value > AT_AMBIENT * test.ambient)
    if not under.size or under[-1] + 1 >= len(blocks.time):
        return None
    since = float(blocks.time[under[-1] + 1])
    return level_of(trace.between(since, since + LATE))


def _lowest(test: SeenTest, seen: Seen, trace: Trace) -> Level | None:
    """The lowest level after the firing of a pressure that falls below its rest: nothing sucks it there."""
    assert test.fire is not None
    if seen.dimension != "pressure":
        return None
    blocks = in_blocks(trace.between(test.fire[1], np.inf), LOWEST)
    if len(blocks.time) < 3:
        return None
    low = int(np.argmin(blocks.values))
    noise = seen.coarse.rest.noise if seen.coarse.rest else 0.0
    found = Level(float(blocks.values[low]), noise / sqrt(max(LOWEST * seen.coarse.rate, 1.0)), float(blocks.time[low]))
    return found if seen.coarse.rest is not None and found.value < seen.coarse.rest.value else None


def _still(test: SeenTest, seen: Seen, last: Level) -> tuple[float, float] | None:
    """What is still there after the firing for other reasons than the zero, and its error [SI]; None: unknown."""
    if seen.dimension == "pressure":
        # oxidizer or purge gas that still flows keeps a chamber above ambient, nothing keeps it below
        assert seen.coarse.rest is not None
        low = last.value < seen.coarse.rest.value
        return (0.0, 0.0) if low or _line_is_empty(test, seen, last.time) else None
    chamber, burn = test.get("p_chamber"), burn_of(test, "p_chamber", "thrust")
    if chamber is None or burn is None or chamber.coarse.rest is None:
        return 0.0, 0.0
    now = usable(test, chamber).between(last.time - 0.5, last.time + 0.5).values
    excess = float(np.mean(now)) - chamber.coarse.rest.value if len(now) else 0.0
    per = burn.mean("thrust") / max(burn.mean("p_chamber") - test.ambient, 1.0)
    pushes = per * max(excess, 0.0)
    return pushes, 0.5 * pushes + 0.003 * abs(burn.mean("thrust"))


def _line_is_empty(test: SeenTest, seen: Seen, time: float) -> bool:
    """Whether the line before the chamber is back at ambient, so that nothing flows; of the line itself nobody knows
    while its tank empties."""
    if seen.name != "p_chamber":
        return False
    line = test.get("p_run")
    if line is None or line.coarse.rest is None:
        return True
    now = usable(test, line).between(time - 0.5, time + 0.5).values
    sure = BACK + 3.0 * line.channel.accuracy
    return bool(len(now)) and abs(float(np.mean(now)) - line.coarse.rest.value) < sure
