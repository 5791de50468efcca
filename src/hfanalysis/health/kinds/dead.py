"""A channel that never changes: nothing is connected, or it stands at a rail."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.health.coarse import FEW
from hfanalysis.health.seen import Seen
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text

NOISY = ("pressure", "force", "mass")
"""Dimensions of sensors that are never without noise in their last digit through a whole log. Source: strain gauges
behind amplifiers; a valve's position or a slow thermometer may well stand still."""


def find(seen: Seen) -> Iterator[Finding]:
    """Constant readings, or none at all; a thermocouple without readings is ``open`` and left to that kind."""
    if seen.dimension not in NOISY:
        return
    values = seen.said[np.isfinite(seen.said)]
    if not len(values) and len(seen.said):
        yield _dead(seen, text("not one of its {n} readings is a number", n=len(seen.said)))
    elif len(values) >= FEW and np.ptp(values) == 0.0:
        words = "each of its {n} readings is {value} to the last digit"
        yield _dead(seen, text(words, n=len(values), value=level(float(values[0]), seen.dimension)))


def _dead(seen: Seen, evidence: str) -> Finding:
    return seen.finding(
        "dead", "unusable", evidence=evidence, cure=None,
        means="not connected, not powered or at the end of its range: it measures nothing in this test",
    )  # fmt: skip
