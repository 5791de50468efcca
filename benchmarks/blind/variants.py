"""A variant beside the full method on the same cases: both values, and the paired difference with its limits."""

from __future__ import annotations

from collections.abc import Mapping

from simulated.blind.figures import Figure, mean, middle, paired_share, share
from simulated.blind.judged import Case, Groups
from simulated.blind.outcomes import NUMBERS, SHARES

from .words import FIGURES

MEANS = ("set90_size", "log_score")
"""Numbers of which the mean is given; of the others the median, beside the mean of their differences."""


def comparison(
    full: Mapping[str, Case],
    other: Mapping[str, Case],
    groups: Groups,
    called: tuple[str, str] = ("full", "variant"),
) -> list[str]:
    """A row per figure over the cases in which both methods contribute to it; what each is ``called``.

    None of the time: the full method's cases may have been diagnosed on another machine, or a busier one.
    """
    both = sorted(full.keys() & other.keys())
    one, two = called
    lines = [f"| figure | {one} | {two} | {one} less {two} | 95 % limits | cases |", "|---|---|---|---|---|---|"]
    for name, judge in {**SHARES, **NUMBERS}.items():
        if name == "runtime":
            continue
        pairs = [(judge(full[i], groups), judge(other[i], groups)) for i in both]
        asked = [(a, b) for a, b in pairs if a is not None and b is not None]
        if asked:
            lines.append(_row(name, asked))
    return lines


def _row(name: str, pairs: list[tuple[float, float]]) -> str:
    one, other = ([p[i] for p in pairs] for i in (0, 1))
    values: tuple[Figure, Figure]
    if name in SHARES:
        values = share(map(bool, one)), share(map(bool, other))
        difference = paired_share([bool(x) for x in one], [bool(x) for x in other])
    else:
        values = (mean(one), mean(other)) if name in MEANS else (middle(one), middle(other))
        difference = mean(a - b for a, b in pairs)
    limits = "-" if difference.low != difference.low else f"{difference.low:+.3f} to {difference.high:+.3f}"
    kind = "" if name in SHARES or name in MEANS else " (mean of differences)"
    return (
        f"| {FIGURES.get(name, name)}{kind} | {values[0].value:.3f} | {values[1].value:.3f} "
        f"| {difference.value:+.3f} | {limits} | {len(pairs)} |"
    )
