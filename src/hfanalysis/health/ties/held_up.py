"""A channel that cannot read low: it stands at one level to the last digit while another still shows a push.

At rest a quiet sensor may well read one level for long; in a tail, in which the chamber still pushes, it may not.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.health.firing import usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text

PUSHES = 0.1
"""Part of its rise at which a channel shows a push [-]: below, a nozzle's flow separates and hardly pushes."""
LEAST = 0.4
"""Part of what its proportion would give that the other reads then at least [-]. Source: thrust coefficient at a
chamber pressure of twice the ambient one, 0.7, over that of a full nozzle, 1.5."""
OFTEN = 8
"""Readings in such a tail that have to be looked at [samples]. Source: as of other rails (kinds/railed.py)."""
MOSTLY = 0.9
"""Share of them that are at the level [-]: some are spikes."""
ACCURACIES, STEPS = 3.0, 10.0
"""Deviations of its accuracy, and steps of its resolution, that it ought to stand above its rest [-]."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Thrust and chamber pressure, by each other."""
    if test.fire is None:
        return
    for name, other in (("thrust", "p_chamber"), ("p_chamber", "thrust")):
        held, pushes = test.get(name), test.get(other)
        if held is not None and pushes is not None:
            yield from _held(test, held, pushes)


def _held(test: SeenTest, held: Seen, pushes: Seen) -> list[Finding]:
    assert test.fire is not None
    if held.coarse.rest is None or not (held.coarse.rise and pushes.coarse.rise and pushes.coarse.rest):
        return []
    tail = usable(test, held).between(0.5 * sum(test.fire), held.coarse.end)
    shown = usable(test, pushes)
    if len(tail.time) < OFTEN or len(shown.time) < OFTEN:
        return []
    share = (np.interp(tail.time, shown.time, shown.values) - pushes.coarse.rest.value) / pushes.coarse.rise
    least = max(ACCURACIES * held.channel.accuracy, STEPS * held.coarse.quantum)
    looked = (share > PUSHES) & (LEAST * share * abs(held.coarse.rise) > least)
    time, at = tail.time[looked], (tail.values == held.coarse.rest.value)[looked]
    # from every reading on, how many of the rest of them are at the level
    onward = np.cumsum(at[::-1])[::-1] / np.arange(len(at), 0, -1)
    stands = np.flatnonzero(at & (onward >= MOSTLY))
    if not len(stands) or len(at) - stands[0] < OFTEN:
        return []
    return _findings(test, held, pushes, float(time[stands[0]]), float(share[looked][stands[0]]))


def _findings(test: SeenTest, held: Seen, pushes: Seen, since: float, share: float) -> list[Finding]:
    """The tail and the rest before, of which neither is a reading."""
    assert held.coarse.rest is not None
    assert test.fire is not None
    evidence = text(
        "reads {value}, as at rest, to the last digit from {start:.2f} s on, while {other} still shows {share:.0f} % "
        "of its rise",
        value=level(held.coarse.rest.value, held.dimension), start=since, other=pushes.name,
        share=100.0 * share,
    )  # fmt: skip
    means = "at the lower end of its range: the truth was lower, and what it reads at rest is no zero"
    spans = ((held.coarse.start, test.fire[0]), (since, held.coarse.end))
    return [held.finding("railed", "unusable", start=start, end=end, evidence=evidence, means=means, cure=None)
            for start, end in spans]  # fmt: skip
