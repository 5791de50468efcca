"""A channel whose steps are worth more than its accuracy: what falls smoothly shows as stairs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.health.seen import Seen
from hfanalysis.products.health import SUSPECT, Finding
from hfanalysis.record.signals import sample_noise
from hfanalysis.sentences import said, text

UNIFORM = float(np.sqrt(12.0))
"""Width of a uniform error over its standard deviation [-]. Source: definition."""

LARGE = 0.02
"""Share of what the channel moves by in the firing from which on a step matters [-]. Source: by choice: fifty steps of
a fall; half of one is 1 % of it, as good a gauge's accuracy."""

DITHERED = 0.5
"""Noise in steps of the resolution from which on the mean of many readings is finer than a step [-]. Source: the mean
of a value with normal noise s is off by q/pi exp(-2 pi^2 s^2/q^2) at most, 0.2 % of a step q at half a step."""


def find(seen: Seen) -> Iterator[Finding]:
    """Once for the whole log."""
    if seen.dimension not in ("pressure", "force", "mass") or seen.fire is None:
        return
    start, end = seen.fire
    inside = (seen.channel.time >= start) & (seen.channel.time <= end) & np.isfinite(seen.said)
    values, step = seen.said[inside], seen.coarse.quantum
    moved = float(np.ptp(values)) if values.size else 0.0
    if not step > LARGE * moved > 0.0 or step / UNIFORM <= seen.channel.accuracy:
        return
    if sample_noise(values) >= DITHERED * step:
        return
    evidence = text(
        "reads in steps of {step}, {share:.0f} % of the {moved} that it moves by in the firing, and its noise is "
        "less: {levels} levels in all",
        step=seen.amount(step), share=100.0 * step / moved, moved=seen.amount(moved), levels=len(np.unique(values)),
    )  # fmt: skip
    late = (end - start) * step / moved / UNIFORM
    means = text(
        "its range or its converter is too wide for this test: a level is off by up to half a step, and a change is "
        "seen {late} late or so",
        late=said(late, "s", ".2g"),
    )
    yield seen.finding(
        "coarse", SUSPECT, evidence=evidence, means=means, cure=None, bias=step / UNIFORM, delay=late
    )  # fmt: skip
