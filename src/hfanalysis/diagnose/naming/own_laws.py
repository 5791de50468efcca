"""What is compared at last, by engines of the laws that each candidate has.

The search takes what laws add as linear. Where they depart far what is wrong with that is more than the noise of quiet
sensors, and an effect may be named for it.
"""

from __future__ import annotations

from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.threads import each


def by_their_laws(candidates: list[Candidate], near: float, bench: Bench) -> list[Candidate]:
    """The candidates, of which the base model is the first: it, and those that come to lie within ``near`` [natural
    log] of the most probable, by their laws; the rest as they were."""
    now, done, todo = list(candidates), set[int](), [0]
    while todo:
        for place, one in zip(todo, each(bench.by_its_laws, [now[place] for place in todo]), strict=True):
            now[place] = one
        done |= set(todo)
        best = max(c.log_evidence for c in now)
        todo = [place for place, c in enumerate(now) if c.log_evidence > best - near and place not in done]
    return now
