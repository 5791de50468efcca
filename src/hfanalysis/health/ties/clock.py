"""The log's clock against what was seen without it: a burn that is stated to last longer than the log."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.health.seen import SeenTest
from hfanalysis.products.health import Finding
from hfanalysis.sentences import said, text

DEVIATIONS = 2.0
"""Deviations of the stated time by which the log has to end too early [-]."""
WATCH = 0.1
"""Relative deviation of a burn time by eye or video, where none is stated [-]. Source: what counts as the end of a burn
(flame, sound, pressure) differs by about that."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Of all channels: the log ends before the burn does that somebody has timed."""
    observed = test.definition.observed
    if test.fire is None or observed is None or observed.burn_time is None:
        return
    stated = observed.burn_time
    left = max(seen.coarse.end for seen in test.channels.values()) - test.fire[0]
    error = stated.std if stated.std is not None else WATCH * stated.value
    if left > stated.value - DEVIATIONS * error:
        return
    evidence = text(
        "the log ends {left} after the opening, and the burn is stated to have lasted {stated}",
        left=said(left, "s", ".1f"), stated=said(stated.value, "s", ".1f"),
    )  # fmt: skip
    means = (
        "the clock runs at another pace than the stated unit or rate, or the log was cut off, or the stated burn time "
        "is another test's; at a wrong pace every flow and every time is wrong by that factor"
    )
    yield Finding(
        kind="clock", verdict="suspect", channels=tuple(test.channels), evidence=evidence, means=means, cure=None,
        pace=stated.value / left - 1.0 if left > 0.0 else None,
    )  # fmt: skip
