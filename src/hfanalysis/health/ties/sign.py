"""Channels whose sign is reversed: a cell that is pulled where it should be pushed, two wires swapped."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.health.firing import usable, without_unusable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text

ACCURACIES = 5.0
"""Deviations of its accuracy that a channel has to go the wrong way [-]."""
RIGHT_WAY = 0.3
"""Part of the wrong way that it may go the right way all the same [-]: a push of ignition or of a shifted zero."""
PART_OF_FALL = 0.3
"""Part of its pressure that a tank has to lose for its mass to have become less [-]. Source: a saturated tank that is
half empty has lost a tenth, one that is empty of liquid a third to a half."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Thrust, chamber pressure and line by the firing; the tank's mass by its pressure."""
    if test.fire is None:
        return
    for name in ("thrust", "p_chamber", "p_run"):
        seen = test.get(name)
        if seen is not None and (ways := _ways(test, seen)) is not None:
            wrong, right = ways
            if wrong > ACCURACIES * seen.channel.accuracy and right < RIGHT_WAY * wrong:
                yield _finding(seen, wrong)
    tank, mass = test.get("p_tank"), test.get("m_tank")
    if tank is not None and mass is not None and (gain := _gain(test, tank, mass)) is not None:
        yield _finding(mass, gain, "becomes heavier by {size} while its tank loses pressure")


def _ways(test: SeenTest, seen: Seen) -> tuple[float, float] | None:
    """How far below its rest and how far above it a channel is held in the firing [SI]."""
    assert test.fire is not None
    rest, part = seen.coarse.rest, usable(test, seen).between(*test.fire).values
    heard = without_unusable(test, seen, seen.heard).between(*test.fire).values
    if len(part) < 0.5 * len(heard):  # most of the firing is no reading: of a reversed gauge, which goes below vacuum
        part = heard
    if rest is None or len(part) < 8 or (seen.dimension == "pressure" and rest.value > 4e5):
        return None
    low, high = np.percentile(part, (10.0, 90.0))
    return float(rest.value - low), float(high - rest.value)


def _gain(test: SeenTest, tank: Seen, mass: Seen) -> float | None:
    """By how much a cell says that its tank became heavier in the firing [kg]; None where it does not."""
    assert test.fire is not None
    before, after = (usable(test, mass).between(*span).values for span in _ends(test.fire))
    p = [usable(test, tank).between(*span).values for span in _ends(test.fire)]
    if min(len(x) for x in (before, after, *p)) < 2:
        return None
    gain = float(np.median(after) - np.median(before))
    falls = float(np.median(p[1])) < (1.0 - PART_OF_FALL) * float(np.median(p[0]))
    return gain if falls and gain > ACCURACIES * mass.channel.accuracy + _noise(before) else None


def _ends(fire: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    start, end = fire
    return (start - 3.0, start - 0.1), (end - 0.1 * (end - start), end + 1.0)


def _noise(values: np.ndarray) -> float:
    return 3.0 * float(np.std(values))


def _finding(seen: Seen, size: float, words: str = "goes {size} below its rest while the engine fires") -> Finding:
    evidence = text(words, size=level(size, seen.dimension))
    means = "its sign is reversed: wired or mounted the other way round"
    scale = -seen.spec.scale
    cure = f"scale = {scale:g}" + (f"\noffset = {-seen.spec.offset:g}" if seen.spec.offset else "")
    return seen.finding("sign", "unusable", evidence=evidence, means=means, cure=cure, gain=2.0)
