"""Wild readings at either end of the log: a converter's first word, a thermometer's power-on value, a cut last line."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.health.cures import exclude
from hfanalysis.health.seen import Seen
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import text

AT_MOST = 5
"""Samples at an end that are looked at: more are a stretch, not an edge."""
FAR = 20.0
"""Times the noise that a reading at the end has to lie outside of all others [-]."""
OUTSIDE = 0.5
"""Part of the range of all others by which it has to lie outside of it [-]. Evidence: a log that begins or ends in a
firing stays within the range of its own readings."""


def find(seen: Seen) -> Iterator[Finding]:
    """At the beginning and at the end."""
    if seen.dimension == "dimensionless":
        return
    time, values = seen.trace.time, seen.trace.values
    if len(values) < 4 * AT_MOST:
        return
    inner = values[AT_MOST:-AT_MOST]
    low, high = float(inner.min()), float(inner.max())
    margin = max(OUTSIDE * (high - low), FAR * sample_noise(inner), 3.0 * seen.channel.accuracy, 1e-12)
    wild = (values < low - margin) | (values > high + margin)
    for begin, where in ((True, wild[:AT_MOST]), (False, wild[-AT_MOST:])):
        if where.any():
            yield _finding(seen, time, values, np.flatnonzero(where) + (0 if begin else len(values) - AT_MOST), begin)


def _finding(seen: Seen, time: Array, values: Array, at: NDArray[np.intp], begin: bool) -> Finding:
    step = 0.25 / seen.coarse.rate if seen.coarse.rate else 0.0
    first, last = (0, int(at[-1])) if begin else (int(at[0]), len(values) - 1)
    start, end = float(time[first]) - step, float(time[last]) + step
    worst = values[at[np.argmax(np.abs(values[at] - np.median(values)))]]
    evidence = text(
        "the {which} of its readings {verb} {value}, outside of all that it reads otherwise ({low} to {high})",
        which="first" if begin else "last", verb="is" if len(at) == 1 else "reach",
        value=level(float(worst), seen.dimension), low=level(float(np.percentile(values, 1)), seen.dimension),
        high=level(float(np.percentile(values, 99)), seen.dimension),
    )  # fmt: skip
    means = "no reading: what a converter says before its first or after its last measurement, or a line cut short"
    cure = exclude([seen.name], start, end)
    return seen.finding("edge", "unusable", start=start, end=end, evidence=evidence, means=means, cure=cure)
