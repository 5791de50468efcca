"""Whether a verdict's probability is so near a limit that the last digits of a run decide what is said."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.diagnose.answer.posterior import SET
from hfanalysis.diagnose.answer.verdict import CLAIM, NAMED_FROM, Verdict

NEAR = 0.01
"""Probability within which a verdict is at a limit: what probabilities may move by between processors."""


def at_limit(verdict: Verdict) -> str | None:
    """What would be said on the other side of the limit that the verdict is at; None where it is at none."""
    return next(_sides(verdict), None)


def _sides(verdict: Verdict) -> Iterator[str]:
    none = verdict.posterior.get("none", 0.0)
    if abs(none - CLAIM) < NEAR:
        side = "something would be claimed" if verdict.label == "none" else "nothing would be claimed"
        yield f"none has {none:.3f}; on the other side of {CLAIM:g} {side}"
    if verdict.label == "none":
        return
    top = verdict.posterior[verdict.top]
    for limit, words in ((SET, "is stated alone from {:g} on"), (NAMED_FROM, "is the verdict from {:g} on")):
        if abs(top - limit) < NEAR:
            yield f"{verdict.top} has {top:.3f}, and {words.format(limit)}"
    for name in verdict.added[1:]:
        p = verdict.partners.get(name, 0.0) / max(top, 1e-9)
        if abs(p - SET) < NEAR:
            yield f"{name} beside {verdict.top} has {p:.3f}, and is sure from {SET:g} on"
